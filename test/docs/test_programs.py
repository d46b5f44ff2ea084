"""The programs of the pages start and know the options that the pages give them; what takes seconds is run as the
tutorials say, the rest shortened."""

import os
import subprocess
import sys

import pytest
from pages import REPOSITORY, commands, pages

ENTER = ("mr_launch", "enter")  # has no options of its own but runs another command


def script(package, program):
    """Path of a program of Python; None for others."""
    places = (REPOSITORY / "src" / package / place / program for place in ("nodes", "scripts"))
    return next((path for path in places if path.is_file()), None)


def used():
    """{(package, program): options} of the programs that the pages run with options."""
    found = {}
    for page in pages():
        for command in commands(page):
            words = command.words
            if words[0] == "rosrun" and len(words) > 2 and words[1:3] != ENTER and script(*words[1:3]):
                options = {word.partition("=")[0] for word in words[3:] if word.startswith("--")}
                found.setdefault(words[1:3], set()).update(options)
    return sorted((*key, tuple(sorted(options))) for key, options in found.items() if options)


def run(*command, folder=REPOSITORY, **environment):
    return subprocess.run(
        [sys.executable, *map(str, command)], cwd=folder, env={**os.environ, **environment}, stdin=subprocess.DEVNULL,
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip


@pytest.mark.parametrize("package, program, options", used())
def test_programs_know_the_options_of_the_pages(package, program, options):
    told = run(script(package, program), "--help")
    assert told.returncode == 0, told.stderr
    assert [option for option in options if option not in told.stdout] == []


def test_the_tutorial_of_strategies_with_a_short_mission(tmp_path):
    """Own strategy, world and records as in the tutorials, in fast mode."""
    place = f"{REPOSITORY}/docs/examples/spread_strategy.py:Spread"
    mission = (
        "--scenario",
        "fast",
        "--world",
        "small8x8",
        "--robots",
        2,
        "--strategy",
        100,
        "--trials",
        1,
        "--jobs",
        1,
    )
    done = run(script("mr_experiments", "run"), *mission, "--out", tmp_path / "spread", EXPLORER_STRATEGIES=place)
    assert done.returncode == 0, done.stdout + done.stderr
    record = tmp_path / "spread" / "small8x8-r2-fast-100-s1.json"
    assert record.is_file()
    shown = run(script("mr_experiments", "show"), record)
    assert shown.returncode == 0 and record.with_suffix(".html").is_file(), shown.stderr


def test_the_tutorial_of_worlds(tmp_path):
    picture = tmp_path / "hall.png"
    done = run(script("mr_experiments", "plans"), "generated:hall:3:40x25", "--out", picture, folder=tmp_path)
    assert done.returncode == 0 and picture.is_file(), done.stderr


def test_the_tutorial_of_robots(tmp_path):
    key = tmp_path / "team.key"
    for words in (("create", key), ("show", key)):
        done = run(script("adhoc_communication", "team_key"), *words)
        assert done.returncode == 0, done.stderr
    assert key.stat().st_mode & 0o077 == 0
    preset = REPOSITORY / "docs" / "examples" / "my_robot.yaml"
    told = run(script("mr_robot", "robot_parameters"), "--robot", preset)
    assert told.returncode == 0 and "scan_topic: scan" in told.stdout, told.stderr
    wrong = run(script("mr_robot", "robot_parameters"), "--robot", "turtle")
    assert wrong.returncode == 2 and wrong.stderr.startswith("robot_parameters: no robot 'turtle'")
