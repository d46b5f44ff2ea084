"""Whole missions over raw sockets in network namespaces, one of each topology: two robots, 10 % frame loss, the small
world."""

import json
import os
import subprocess
from pathlib import Path
from typing import Dict, Tuple

import pytest

LIMIT_S = 400


TOPOLOGIES = ("distributed", "centralized")
Mission = Tuple[int, str, Path]


@pytest.fixture(scope="module")
def missions(tmp_path_factory: pytest.TempPathFactory) -> Dict[str, Mission]:
    return {topology: run_of(topology, tmp_path_factory.mktemp(topology)) for topology in TOPOLOGIES}


@pytest.fixture(params=TOPOLOGIES)
def mission(missions: Dict[str, Mission], request: pytest.FixtureRequest) -> Mission:
    return missions[request.param]


def run_of(topology: str, out: Path) -> Mission:
    """Exit code, output and folder of a mission."""
    command = ["rosrun", "mr_launch", "team", "--world", "small8x8", "--robots", "2", "--loss", "0.1", "--seed", "3"]
    run = subprocess.run(
        [*command, "--topology", topology, "--duration", "300", "--out", str(out)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=LIMIT_S,
    )
    return run.returncode, run.stdout, out


def test_every_robot_finishes(mission: Mission) -> None:
    code, output, out = mission
    assert code == 0, output
    summary = json.loads((out / "summary.json").read_text())
    assert summary["finished"] and all(robot["finished"] for robot in summary["robots"].values()), output


def test_it_really_ran_in_namespaces_over_raw_sockets(mission: Mission) -> None:
    summary = json.loads((mission[2] / "summary.json").read_text())
    assert summary["isolation"] != "hub"
    assert summary["team"]["packets_by_hops"]["1"] > 0


def test_maps_are_complete_and_right(mission: Mission) -> None:
    summary = json.loads((mission[2] / "summary.json").read_text())
    for name, robot in summary["robots"].items():
        assert robot["coverage"] >= 0.95, name
        assert robot["wrong_walls"] <= 0.05, name
        assert robot["merged_with"], f"{name} merged with nobody"
    assert summary["team"]["collisions"] == 0


def test_both_topologies_end_with_the_same_map(missions: Dict[str, Mission]) -> None:
    areas = []
    for _, _, out in missions.values():
        summary = json.loads((out / "summary.json").read_text())
        areas += [robot["free_cells"] for robot in summary["robots"].values()]
    assert max(areas) <= 1.02 * min(areas), areas


def test_output_folder_has_what_people_look_at(mission: Mission) -> None:
    out = mission[2]
    names = {path.name for path in out.rglob("*") if path.is_file() and path.stat().st_size > 0}
    assert {"summary.json", "map.png", "map.pgm", "map.yaml"} <= names, sorted(names)
    assert any(name.endswith(".bag") for name in names)


def test_no_process_of_the_mission_is_left(mission: Mission) -> None:
    out = str(mission[2])
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            command = Path(f"/proc/{pid}/cmdline").read_bytes().decode(errors="replace")
        except OSError:
            continue
        assert out not in command, command
