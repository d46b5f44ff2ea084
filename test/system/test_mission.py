"""Whole missions over raw sockets in network namespaces, one of each topology: two robots, 10 % frame loss, the small
world. In the distributed one the doctor looks at a robot; explorer, map_merger, adhoc_communication are killed. In the
centralized one the base pauses the team and lets it go on."""

import json
from typing import Dict

from team_missions import KILLED, Mission, processes_of


def test_every_robot_finishes(mission: Mission) -> None:
    code, output, out = mission[:3]
    assert code == 0, output
    summary = json.loads((out / "summary.json").read_text())
    assert summary["finished"] and all(robot["finished"] for robot in summary["robots"].values()), output


def test_it_really_ran_in_namespaces_over_raw_sockets(mission: Mission) -> None:
    summary = json.loads((mission.out / "summary.json").read_text())
    assert summary["isolation"] != "hub"
    assert summary["team"]["packets_by_hops"]["1"] > 0


def test_the_doctor_finds_nothing_wrong_with_a_healthy_robot(missions: Dict[str, Mission]) -> None:
    assert missions["distributed"].visit == (0, "")


def test_the_mission_goes_on_without_nodes_that_are_killed_and_they_come_back(missions: Dict[str, Mission]) -> None:
    summary = json.loads((missions["distributed"].out / "summary.json").read_text())
    assert summary["restarts"] == {robot: dict.fromkeys(nodes, 1) for robot, nodes in KILLED.items()}
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
    summary = json.loads((mission.out / "summary.json").read_text())
    for name, robot in summary["robots"].items():
        assert robot["coverage"] >= 0.95, name
        assert robot["wrong_walls"] <= 0.05, name
        assert robot["merged_with"], f"{name} merged with nobody"
    assert summary["team"]["collisions"] == 0


def test_both_topologies_end_with_the_same_map(missions: Dict[str, Mission]) -> None:
    areas = []
    for mission in missions.values():
        summary = json.loads((mission.out / "summary.json").read_text())
        areas += [robot["free_cells"] for robot in summary["robots"].values()]
    assert max(areas) <= 1.02 * min(areas), areas


def test_output_folder_has_what_people_look_at(mission: Mission) -> None:
    out = mission.out
    names = {path.name for path in out.rglob("*") if path.is_file() and path.stat().st_size > 0}
    assert {"summary.json", "map.png", "map.pgm", "map.yaml"} <= names, sorted(names)
    assert any(name.endswith(".bag") for name in names)


def test_no_process_of_the_mission_is_left(mission: Mission) -> None:
    assert not processes_of(str(mission.out))
