"""Whole missions over raw sockets in network namespaces, one of each topology: two robots, 10 % frame loss, the small
world. In the distributed one the doctor looks at a robot; explorer, map_merger, adhoc_communication are killed. In the
centralized one the base pauses the team and lets it go on."""

import os
import signal
import subprocess
import time
from pathlib import Path
from typing import Dict, List, NamedTuple

import pytest

from mr_measures.record.files import read_record

LIMIT_S = 400
TOPOLOGIES = ("distributed", "centralized")
LOOK = ("timeout", "5", "rostopic", "echo", "-n1")
KILLED = {"robot_0": ("explorer", "adhoc_communication"), "robot_1": ("map_merger",)}


class Mission(NamedTuple):
    """`visit`: exit code and output of the doctor; `orders`: answers of the base's mission control."""

    code: int
    output: str
    out: Path
    visit: tuple = ()
    orders: str = ""


@pytest.fixture(scope="module")
def missions(tmp_path_factory: pytest.TempPathFactory) -> Dict[str, Mission]:
    return {topology: run_of(topology, tmp_path_factory.mktemp(topology)) for topology in TOPOLOGIES}


@pytest.fixture(params=TOPOLOGIES)
def mission(missions: Dict[str, Mission], request: pytest.FixtureRequest) -> Mission:
    return missions[request.param]


def run_of(topology: str, out: Path) -> Mission:
    command = ["rosrun", "mr_launch", "team", "--world", "small8x8", "--robots", "2", "--loss", "0.1", "--seed", "3"]
    disturbed = topology == "distributed"
    run = subprocess.Popen(
        [*command, "--topology", topology, "--duration", "300", "--out", str(out), *["--respawn"] * disturbed],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        while "state: 1" not in enter(out, "robot_0", *LOOK, "/explorer/state").stdout:
            assert run.poll() is None, run.stdout and run.stdout.read()
            time.sleep(0.3)
        visit, orders = (disturb(out), "") if disturbed else ((), order(out))
        output, _ = run.communicate(timeout=LIMIT_S)
    finally:
        run.terminate()
    return Mission(run.returncode, output, out, visit, orders)


def order(out: Path) -> str:
    """The base pauses both robots, sees that they are paused, and lets them go on."""
    answers = enter(out, "base", "rosservice", "call", "/mission_control/pause").stdout
    for _ in range(20):
        team = enter(out, "base", *LOOK, "/mission_control/team").stdout
        if team.count('text: "is paused"') == 2:
            break
    return answers + team + enter(out, "base", "rosservice", "call", "/mission_control/resume").stdout


def disturb(out: Path) -> tuple:
    """The doctor's visit to robot_1, while robot_0 loses its explorer; then the other nodes are killed."""
    kill(out, "robot_0", "explorer")
    visit = enter(out, "robot_1", "rosrun", "mr_launch", "doctor", "--peers", "robot_0", "--seconds", "2")
    kill(out, "robot_1", "map_merger")
    kill(out, "robot_0", "adhoc_communication")
    return visit.returncode, visit.stdout + visit.stderr


def enter(out: Path, robot: str, *command: str) -> "subprocess.CompletedProcess[str]":
    words = ["rosrun", "mr_launch", "enter", "--team", str(out), robot, *command]
    return subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)


def kill(out: Path, robot: str, node: str) -> None:
    (pid,) = processes_of(f"{out}/logs/{robot}/nodes/{node}-")
    os.kill(pid, signal.SIGKILL)


def processes_of(words: str) -> List[int]:
    """Processes with these words in their command line."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            command = Path(f"/proc/{pid}/cmdline").read_bytes().decode(errors="replace")
        except OSError:
            continue
        if words in command:
            found.append(int(pid))
    return found


def test_every_robot_finishes(mission: Mission) -> None:
    code, output, out = mission[:3]
    assert code == 0, output
    record = read_record(out / "record.json")
    assert record.finished and all(robot.state == "finished" for robot in record.robots.values()), output


def test_it_really_ran_in_namespaces_over_raw_sockets(mission: Mission) -> None:
    record = read_record(mission.out / "record.json")
    assert record.asked.settings["isolation"] != "hub"
    assert record.packets_by_hops[1] > 0


def test_the_doctor_finds_nothing_wrong_with_a_healthy_robot(missions: Dict[str, Mission]) -> None:
    assert missions["distributed"].visit == (0, "")


def test_the_mission_goes_on_without_nodes_that_are_killed_and_they_come_back(missions: Dict[str, Mission]) -> None:
    record = read_record(missions["distributed"].out / "record.json")
    assert record.restarts == {robot: dict.fromkeys(nodes, 1) for robot, nodes in KILLED.items()}
    for robot in KILLED:
        log = missions["distributed"].out / "logs" / robot / "nodes"
        again = any("goes on with its mission" in path.read_text() for path in log.glob("explorer-*.log"))
        assert again == (robot == "robot_0")


def test_the_base_sees_how_the_robots_are_and_orders_them_about(missions: Dict[str, Mission]) -> None:
    orders = missions["centralized"].orders
    assert "pause: sent to robot_0, robot_1" in orders and "resume: sent to robot_0, robot_1" in orders, orders
    assert orders.count('text: "is paused"') == orders.count('order_answer: "paused"') == 2, orders
    assert orders.count("placed") >= 2, orders  # what map_merger says of each robot


def test_maps_are_complete_and_right(mission: Mission) -> None:
    record = read_record(mission.out / "record.json")
    for name, robot in record.robots.items():
        assert robot.map.coverage is not None and robot.map.coverage >= 0.95, name
        assert robot.map.wrong_walls is not None and robot.map.wrong_walls <= 0.05, name
        assert robot.partners, f"{name} merged with nobody"
        assert robot.collisions.total == 0, name


def test_the_record_tells_how_the_mission_went(mission: Mission) -> None:
    record = read_record(mission.out / "record.json")
    for name, robot in record.robots.items():
        assert robot.goals and robot.goals[0].end is not None, name
        assert robot.auctions and sum(auction.clusters for auction in robot.auctions) > 0, name
        assert robot.series.explored[-1] > 40.0 and {1, 3} <= set(robot.series.state), name
        assert robot.series.bytes[-1] > 0 and any(robot.series.neighbors), name
    assert record.notes and record.code and set(record.maps) == set(record.robots)


def test_both_topologies_end_with_the_same_map(missions: Dict[str, Mission]) -> None:
    areas = []
    for mission in missions.values():
        robots = read_record(mission.out / "record.json").robots.values()
        areas += [robot.map.free_cells or 0 for robot in robots]
    assert max(areas) <= 1.02 * min(areas), areas


def test_output_folder_has_what_people_look_at(mission: Mission) -> None:
    out = mission.out
    names = {path.name for path in out.rglob("*") if path.is_file() and path.stat().st_size > 0}
    assert {"record.json", "map.png", "map.pgm", "map.yaml"} <= names, sorted(names)
    assert any(name.endswith(".bag") for name in names)


def test_no_process_of_the_mission_is_left(mission: Mission) -> None:
    assert not processes_of(str(mission.out))
