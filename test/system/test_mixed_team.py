"""A Pioneer and a Turtlebot explore the small world together, each configured as what it is, with SLAM and navigation
started by the launch files of the documentation's examples."""

import subprocess
from pathlib import Path
from typing import Tuple

import pytest

from mr_measures.record.files import read_record

LIMIT_S = 300
WRONG_WALLS = 0.08  # what a Turtlebot sees of walls is less exact, and in both maps
REPOSITORY = Path(__file__).parents[2]
WORLDS = REPOSITORY / "worlds"
EXAMPLES = REPOSITORY / "docs" / "examples"


@pytest.fixture(scope="module")
def mission(tmp_path_factory: pytest.TempPathFactory) -> Tuple[int, str, Path]:
    """Exit code, output and folder of a mission in which robot_1 of the small world is a Turtlebot."""
    folder = tmp_path_factory.mktemp("mixed")
    text = (WORLDS / "small8x8.world").read_text()
    text = text.replace('include "pioneer.inc"', f'include "{WORLDS}/pioneer.inc"\ninclude "{WORLDS}/turtlebot.inc"')
    mixed = text.replace('pioneer ( name "robot_1"', 'turtlebot ( name "robot_1"')
    assert mixed != text
    (folder / "mixed.world").write_text(mixed)
    command = ["rosrun", "mr_launch", "team", "--world", str(folder / "mixed.world"), "--robots", "2", "--seed", "3"]
    own = ["--slam", str(EXAMPLES / "my_slam.launch"), "--navigation", str(EXAMPLES / "my_navigation.launch")]
    run = subprocess.run(
        [*command, *own, "--rtf", "2", "--duration", "200", "--no-bag", "--out", str(folder / "out")],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=LIMIT_S,
    )
    return run.returncode, run.stdout, folder / "out"


def test_both_kinds_of_robots_explore_the_world(mission: Tuple[int, str, Path]) -> None:
    code, output, out = mission
    assert code == 0, output
    for name, robot in read_record(out / "record.json").robots.items():
        assert robot.map.coverage is not None and robot.map.coverage >= 0.95, (name, output)
        assert robot.map.wrong_walls is not None and robot.map.wrong_walls <= WRONG_WALLS, (name, output)
        assert robot.partners, f"{name} merged with nobody"


def test_the_presets_of_both_kinds_are_kept(mission: Tuple[int, str, Path]) -> None:
    presets = {path.stem: path.read_text() for path in (mission[2] / "robots").iterdir()}
    assert "field_of_view: 4.71" in presets["robot_0"] and "field_of_view: 0.99" in presets["robot_1"]


def test_the_launch_files_of_the_examples_were_used(mission: Tuple[int, str, Path]) -> None:
    """SLAM's sends its map each second, navigation's drives at most 0.4 m/s where the Pioneer can 0.5."""
    series = read_record(mission[2] / "record.json").robots["robot_0"].series
    fastest = max((b - a) / (to - since) for a, b, since, to in
                  zip(series.distance, series.distance[1:], series.time, series.time[1:]))  # fmt: skip
    assert 0.3 < fastest < 0.45
    assert "/slam/map_update_interval" in (mission[2] / "logs/robot_0/nodes/master.log").read_text()
