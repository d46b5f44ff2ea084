"""The commands as people call them: one message, exit code 2, nothing started, no traceback."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

NODES = Path(__file__).resolve().parents[1] / "nodes"
WORLD = """
define pioneer position ( size [ 0.44 0.38 0.3 ] drive "diff" )
model ( name "wall" size [ 0.1 4 1 ] pose [ 5 0 0 0 ] )
pioneer ( name "%s" pose [ 1 1 0 0 ] )
pioneer ( name "%s" pose [ 1 3 0 0 ] )
"""


def call(tmp_path, name, *arguments):
    result = subprocess.run(
        [sys.executable, str(NODES / name), *arguments],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert result.returncode == 2, result.stdout + result.stderr
    assert "Traceback" not in result.stderr
    lines = result.stderr.strip().splitlines()
    assert len(lines) == 1 and lines[0].startswith(f"{name}: "), result.stderr
    assert not (tmp_path / "out").exists()
    return lines[0]


@pytest.mark.parametrize(
    ("arguments", "culprits"),
    [
        (["--world", "atlantis"], ["atlantis", "office26x15", "small8x8"]),
        (["--world", "small8x8", "--robots", "0"], ["--robots 0"]),
        (["--world", "small8x8", "--robots", "40"], ["--robots 40", "robot_0"]),
        (["--range", "-3"], ["--range -3"]),
        (["--loss", "2"], ["--loss 2"]),
        (["--rtf", "-1"], ["--rtf -1"]),
        (["--duration", "0"], ["--duration 0"]),
        (["--nonsense"], ["--nonsense"]),
    ],
)
def test_team(tmp_path, arguments, culprits):
    message = call(tmp_path, "team", *arguments)
    assert all(culprit in message for culprit in culprits), message


def test_name_used_twice(tmp_path):
    (tmp_path / "w.world").write_text(WORLD % ("anna", "anna"))
    assert "anna" in call(tmp_path, "team", "--world", "w.world", "--robots", "1")


def test_robot_in_a_wall(tmp_path):
    (tmp_path / "w.world").write_text((WORLD % ("anna", "ben")).replace("1 3 0 0", "5 1 0 0"))
    assert "ben" in call(tmp_path, "team", "--world", "w.world")


def test_unknown_word_in_the_world(tmp_path):
    (tmp_path / "w.world").write_text((WORLD % ("anna", "ben")).replace("size", "sizzle", 1))
    message = call(tmp_path, "team", "--world", "w.world")
    assert "sizzle" in message and "w.world:2" in message


def test_missing_bitmap(tmp_path):
    (tmp_path / "w.world").write_text((WORLD % ("anna", "ben")).replace('name "wall"', 'bitmap "plan.png"'))
    assert "plan.png" in call(tmp_path, "team", "--world", "w.world")


def test_full_output_folder(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes").write_text("")
    assert "not an empty folder" in call(tmp_path, "team", "--world", "small8x8", "--out", "mine")


def test_nothing_is_built(tmp_path, monkeypatch):
    """With the package path of another workspace the message says what to build."""
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    monkeypatch.setenv("CMAKE_PREFIX_PATH", "")
    message = call(tmp_path, "team", "--world", "small8x8")
    assert "not built" in message and "mr_sim/world" in message and "make build" in message


@pytest.mark.parametrize("arguments", [[], ["--nonsense"], ["robot_0", "ls"], ["--team", "nowhere", "robot_0", "ls"]])
def test_enter(tmp_path, arguments):
    message = call(tmp_path, "enter", *arguments)
    assert "usage" in message or "no running team" in message


@pytest.mark.parametrize("word", ["--help", "-h"])
def test_help_of_enter_says_what_it_does(word):
    told = subprocess.run([sys.executable, str(NODES / "enter"), word], capture_output=True, text=True, check=True)
    assert "Runs a command where a robot" in told.stdout and "--team FOLDER" in told.stdout and not told.stderr


def test_enter_after_the_end(tmp_path):
    """A state file that a killed team left behind."""
    folder = tmp_path / "old"
    folder.mkdir()
    (folder / "team.json").write_text(json.dumps({"isolation": "hub", "init": os.getpid(), "robots": {}}))
    assert "is over" in call(tmp_path, "enter", "--team", "old", "robot_0", "ls")


def test_a_generated_world_that_cannot_be(tmp_path):
    assert "castle" in call(tmp_path, "team", "--world", "generated:castle:1")
