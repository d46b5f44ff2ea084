"""A mission that ran over raw sockets is played back and exported: the maps that its robots had come to are merged
again from what was recorded, without robots."""

import json
import os
import shlex
import signal
import subprocess
import time
from pathlib import Path
from typing import Dict, Iterator, List

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from team_missions import LOOK, Mission, enter, processes_of

from mr_grid.map_files import read_map

ROBOTS = ("robot_0", "robot_1")
# Registration sees other intermediate maps each time and ends near the same optimum: walls may lie in the next cell.
DIFFERENT_CELLS = 0.005


def replay(*arguments: object) -> "subprocess.CompletedProcess[str]":
    words = ["rosrun", "mr_launch", "replay", *map(str, arguments)]
    return subprocess.run(words, capture_output=True, text=True, timeout=300, check=False)


@pytest.fixture(scope="module")
def recorded(missions: Dict[str, Mission]) -> Path:
    return missions["distributed"].out


@pytest.fixture(scope="module")
def computed(recorded: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """At a rate at which the nodes cannot keep up, as on a slow computer: maps lacked what other robots had seen."""
    out = tmp_path_factory.mktemp("replay") / "out"
    done = replay(recorded, "--compute", "map_merger", "explorer", "--rate", 20, "--out", out)
    assert done.returncode == 0, done.stdout + done.stderr
    return out


def messages(bag: Path, topic: str) -> List[object]:
    with AnyReader([bag]) as reader:
        wanted = [connection for connection in reader.connections if connection.topic.strip("/") == topic]
        return [reader.deserialize(octets, one.msgtype) for one, _, octets in reader.messages(connections=wanted)]


def without_counterpart(cells: np.ndarray, others: np.ndarray) -> int:
    """Cells whose value none of the others has within one cell."""
    rows, columns = cells.shape
    around = np.pad(others, 1, constant_values=-1)
    shifted = [around[row : row + rows, column : column + columns] for row in range(3) for column in range(3)]
    return int((~np.logical_or.reduce([cells == each for each in shifted])).sum())


def assert_same_map(recorded: Path, computed: Path, robot: str) -> None:
    then, now = (read_map(str(folder / robot / "map.yaml")) for folder in (recorded, computed))
    assert then.cells.shape == now.cells.shape and then.origin == now.origin
    different = max(without_counterpart(then.cells, now.cells), without_counterpart(now.cells, then.cells))
    assert different <= DIFFERENT_CELLS * np.count_nonzero(then.cells >= 0)


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_maps_are_merged_again(recorded: Path, computed: Path, robot: str) -> None:
    assert_same_map(recorded, computed, robot)


def test_the_maps_that_a_base_merged_are_merged_again(missions: Dict[str, Mission], tmp_path: Path) -> None:
    """There robots know of one another by what the base tells of their runs alone: in runs of other names they placed
    nobody."""
    recorded = missions["centralized"].out
    done = replay(recorded, "--compute", "map_merger", "--rate", 10, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stdout + done.stderr
    for robot in ROBOTS:
        assert_same_map(recorded, tmp_path / "out", robot)


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_explorers_decide_again(recorded: Path, computed: Path, robot: str) -> None:
    """Not what they published then is in the new bag: time and again the same robot in the same map wants new goals."""
    then, now = (messages(folder / robot / f"{robot}.bag", "move_base/goal") for folder in (recorded, computed))
    stamps = {(goal.header.stamp.sec, goal.header.stamp.nanosec) for goal in then}  # type: ignore[attr-defined]
    again = [goal for goal in now if (goal.header.stamp.sec, goal.header.stamp.nanosec) not in stamps]  # type: ignore[attr-defined]
    assert len(again) >= 2
    scans = [len(messages(folder / robot / f"{robot}.bag", "base_scan")) for folder in (recorded, computed)]
    assert scans[1] >= 0.98 * scans[0]


def test_what_was_computed_is_a_recording_again(computed: Path) -> None:
    done = subprocess.run(["rosrun", "mr_launch", "export", computed], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with AnyReader([computed / "mission.mcap"]) as reader:
        topics = {connection.topic: connection.msgcount for connection in reader.connections}
        assert {f"/{robot}/map_merger/global_map" for robot in ROBOTS} <= set(topics)
        assert topics["/tf_static"] == 1


def test_bags_of_real_robots_are_merged_again(recorded: Path, tmp_path: Path) -> None:
    """Without what the team runner knows: folders of single robots side by side, as the tutorial has it."""
    for robot in ROBOTS:
        (tmp_path / "records" / robot).mkdir(parents=True)
        bag = tmp_path / "records" / robot / "topics_2026-01-31.bag"
        bag.symlink_to(recorded / robot / f"{robot}.bag")
    preset = recorded / "robots" / "robot_0.yaml"
    span = ("--from", 2, "--to", 12, "--rate", 2)
    done = replay(tmp_path / "records", "--compute", "map_merger", "--robot", preset, *span, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stdout + done.stderr
    assert all((tmp_path / "out" / robot / "map.pgm").stat().st_size > 1000 for robot in ROBOTS)


@pytest.fixture
def playing(recorded: Path, tmp_path: Path) -> Iterator["tuple[subprocess.Popen[str], Path]"]:
    """Slowly: on a busy computer the mission was over before all had been looked at."""
    out = tmp_path / "out"
    words = ["rosrun", "mr_launch", "replay", str(recorded), "--from", "5", "--rate", "0.4", "--out", str(out)]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        yield process, out
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(60)


def test_every_robot_has_its_master_and_time_and_ctrl_c_leaves_nothing(
    playing: "tuple[subprocess.Popen[str], Path]",
) -> None:
    process, out = playing
    # The command to look inside was told before there was anything to look into.
    assert process.stdout is not None
    told = next(line for line in process.stdout if "rosrun" in line)
    words = shlex.split(told.partition("look inside with: ")[2])
    assert words[:5] == ["rosrun", "mr_launch", "enter", "--team", str(out)]
    while "state:" not in (looked := enter(out, "robot_1", *LOOK, "/explorer/state")).stdout:
        assert process.poll() is None and "no running team" not in looked.stderr
        time.sleep(0.3)
    own = {robot: enter(out, robot, *LOOK, "/explorer/state/robot_name").stdout for robot in ROBOTS}
    assert all(robot in text for robot, text in own.items())
    assert "true" in enter(out, "robot_0", "rosparam", "get", "/use_sim_time").stdout
    first, second = (float(clock(out)) for _ in range(2))
    assert 5.0 <= first < second
    assert "base_laser_link" in enter(out, "robot_0", *LOOK, "/tf_static").stdout, "it was told before the 5th second"
    os.kill(process.pid, signal.SIGINT)
    output, _ = process.communicate(timeout=60)
    assert process.returncode == 130 and "interrupted" in output, output
    assert not processes_of(str(out)) and not (out / "played").exists() and not (out / "team.json").exists()


def clock(out: Path) -> str:
    words = enter(out, "robot_0", *LOOK, "/clock/clock").stdout.split()
    return f"{words[words.index('secs:') + 1]}.{int(words[words.index('nsecs:') + 1]):09d}"


def test_the_plan_is_kept_with_the_mission(recorded: Path) -> None:
    assert [robot["name"] for robot in json.loads((recorded / "plan.json").read_text())["robots"]] == list(ROBOTS)
