"""Whole missions over raw sockets in network namespaces, one of each topology: two robots, 10 % frame loss, the small
world. In the distributed one the doctor looks at a robot; explorer, map_merger, adhoc_communication are killed. In the
centralized one slam of a robot is killed, and the base pauses the team and lets it go on."""

from typing import Dict

import pytest
from team_missions import KILLED, TOPOLOGIES, Mission, processes_of

from mr_measures.record.files import read_record


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


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_the_mission_goes_on_without_nodes_that_are_killed_and_they_come_back(
    missions: Dict[str, Mission], topology: str
) -> None:
    record = read_record(missions[topology].out / "record.json")
    assert record.restarts == {robot: dict.fromkeys(nodes, 1) for robot, nodes in KILLED[topology].items()}


def test_explorer_that_was_killed_goes_on_with_its_mission(missions: Dict[str, Mission]) -> None:
    for robot in ("robot_0", "robot_1"):
        assert said(missions["distributed"], robot, "explorer", "goes on with its mission") == (robot == "robot_0")


def test_slam_that_was_killed_goes_on_with_its_map_and_nobody_places_the_robot_anew(
    missions: Dict[str, Mission],
) -> None:
    mission = missions["centralized"]
    for robot in ("robot_0", "robot_1"):
        assert said(mission, robot, "slam", "slam goes on with its map") == (robot == "robot_1")
        assert not said(mission, robot, "map_merger", "begins anew")
    assert not list(mission.out.rglob("slam_*.map")), "it ended in order"


def test_the_base_sees_how_the_robots_are_and_orders_them_about(missions: Dict[str, Mission]) -> None:
    orders = missions["centralized"].orders
    assert "pause: sent to robot_0, robot_1" in orders and "resume: sent to robot_0, robot_1" in orders, orders
    assert orders.count('text: "is paused"') == orders.count('order_answer: "paused"') == 2, orders
    assert orders.count("placed") >= 2, orders  # what map_merger says of each robot


def said(mission: Mission, robot: str, node: str, text: str) -> bool:
    logs = (mission.out / "logs" / robot / "nodes").glob(f"{node}-*.log")
    return any(text in path.read_text() for path in logs)


def test_maps_are_complete_and_right(mission: Mission) -> None:
    record = read_record(mission.out / "record.json")
    for name, robot in record.robots.items():
        assert robot.map.coverage is not None and robot.map.coverage >= 0.98, name
        assert robot.map.wrong_walls is not None and robot.map.wrong_walls <= 0.02, name
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
