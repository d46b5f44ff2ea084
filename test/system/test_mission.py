"""A whole mission over raw sockets in network namespaces: two robots, 10 % frame loss, the small world."""

import json
import os
import subprocess
from pathlib import Path

import pytest

LIMIT_S = 400


@pytest.fixture(scope="module")
def mission(tmp_path_factory: pytest.TempPathFactory) -> tuple[int, str, Path]:
    out = tmp_path_factory.mktemp("mission")
    command = ["rosrun", "mr_launch", "team", "--world", "small8x8", "--robots", "2", "--loss", "0.1", "--seed", "3"]
    run = subprocess.run(
        [*command, "--duration", "300", "--out", str(out)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=LIMIT_S,
    )
    return run.returncode, run.stdout, out


def test_every_robot_finishes(mission: tuple[int, str, Path]) -> None:
    code, output, out = mission
    assert code == 0, output
    summary = json.loads((out / "summary.json").read_text())
    assert summary["finished"] and all(robot["finished"] for robot in summary["robots"].values()), output


def test_it_really_ran_in_namespaces_over_raw_sockets(mission: tuple[int, str, Path]) -> None:
    summary = json.loads((mission[2] / "summary.json").read_text())
    assert summary["isolation"] != "hub"
    assert summary["team"]["packets_by_hops"]["1"] > 0


def test_maps_are_complete_and_right(mission: tuple[int, str, Path]) -> None:
    summary = json.loads((mission[2] / "summary.json").read_text())
    for name, robot in summary["robots"].items():
        assert robot["coverage"] >= 0.95, name
        assert robot["wrong_walls"] <= 0.05, name
        assert robot["merged_with"], f"{name} merged with nobody"
    assert summary["team"]["collisions"] == 0


def test_output_folder_has_what_people_look_at(mission: tuple[int, str, Path]) -> None:
    out = mission[2]
    names = {path.name for path in out.rglob("*") if path.is_file() and path.stat().st_size > 0}
    assert {"summary.json", "map.png", "map.pgm", "map.yaml"} <= names, sorted(names)
    assert any(name.endswith(".bag") for name in names)


def test_no_process_of_the_mission_is_left(mission: tuple[int, str, Path]) -> None:
    out = str(mission[2])
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            command = Path(f"/proc/{pid}/cmdline").read_bytes().decode(errors="replace")
        except OSError:
            continue
        assert out not in command, command
