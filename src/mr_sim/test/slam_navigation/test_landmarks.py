"""Ends of surfaces: where they are seen, which are one, and what they tell of the way."""

import math

import numpy as np
import pytest

from mr_robot._slam import PoseGraph, edges

VIEW, BEAMS, RANGE_MAX = 1.0, 320, 4.0  # rad, and m
DOORS = [(2.0 * number, 2.0 * number + 0.8) for number in range(-1, 9)]  # m along a corridor
HALF_WIDTH, THICKNESS = 1.2, 0.2  # m


def corridor() -> np.ndarray:
    """Its walls with doors on both sides: ends of segments (n, 2, 2), m."""
    bounds = [-5.0, *[end for door in DOORS for end in door], 20.0]
    walls = []
    for low, high in zip(bounds[::2], bounds[1::2]):
        for side in (-1.0, 1.0):
            near, far = side * HALF_WIDTH, side * (HALF_WIDTH + THICKNESS)
            walls += [((low, near), (high, near)), ((low, near), (low, far)), ((high, near), (high, far))]
    return np.array(walls)


def scan(walls: np.ndarray, pose: tuple[float, float, float], generator: np.random.Generator) -> np.ndarray:
    angles = np.linspace(-VIEW / 2, VIEW / 2, BEAMS) + pose[2]
    ray = np.stack([np.cos(angles), np.sin(angles)], 1)[:, None]
    begin, along = walls[:, 0] - pose[:2], walls[:, 1] - walls[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        across = ray[..., 0] * along[:, 1] - ray[..., 1] * along[:, 0]
        distance = (begin[:, 0] * along[:, 1] - begin[:, 1] * along[:, 0]) / across
        place = (begin[:, 0] * ray[..., 1] - begin[:, 1] * ray[..., 0]) / across
    hit = (distance > 0) & (place >= 0) & (place <= 1)
    ranges = np.where(hit, distance, np.inf).min(1)
    return np.where(ranges < RANGE_MAX, ranges + generator.normal(0.0, 0.01, BEAMS), np.inf)


def seen_from(walls: np.ndarray, pose: tuple[float, float, float], generator: np.random.Generator) -> np.ndarray:
    ranges = scan(walls, pose, generator)
    return edges(ranges, (0.0, 0.0, 0.0), -VIEW / 2, VIEW / (BEAMS - 1), 0.45, RANGE_MAX, 0.7)


def on_map(rows: np.ndarray, pose: tuple[float, float, float]) -> np.ndarray:
    """Places and directions (n, 6) of edges, in the frame of the corridor."""
    turn = np.array([[math.cos(pose[2]), math.sin(pose[2])], [-math.sin(pose[2]), math.cos(pose[2])]])
    return np.concatenate([rows[:, :2] @ turn + pose[:2], rows[:, 2:4] @ turn, rows[:, 4:6] @ turn], 1)


def test_jambs_are_found_where_they_are_from_either_side() -> None:
    generator, walls = np.random.default_rng(1), corridor()
    found = []
    for yaw in (0.0, 0.3, -0.3, math.pi, math.pi - 0.3):
        for x in np.arange(-1.0, 12.0, 0.25):
            pose = (float(x), 0.2, yaw)
            found.append(on_map(seen_from(walls, pose, generator), pose))
    places = np.concatenate(found)
    jambs = np.array([end for door in DOORS for end in door])
    on_face = np.abs(np.abs(places[:, 1]) - HALF_WIDTH) < 0.05
    across = np.abs(places[:, 5]) > 0.9  # of the corridor's own walls, not of what is inside the doors
    away = np.abs(places[on_face & across, None, 0] - jambs).min(1)
    assert len(away) > 150 and np.quantile(away, 0.95) < 0.04 and away.max() < 0.12
    # Off the end of a wall is into the door.
    into = places[on_face & across]
    low = np.abs(into[:, None, 0] - jambs[::2]).min(1) < 0.12  # where doors begin
    assert (np.sign(into[:, 2]) == np.where(low, 1.0, -1.0)).all()


def test_a_jamb_is_found_behind_the_face_that_it_turns_to_the_robot() -> None:
    """Ahead in a corridor the farther jamb of each door is seen with its face; half of what tells the way was lost."""
    generator, walls = np.random.default_rng(5), corridor()
    farther = []
    for x in np.arange(-1.0, 12.0, 0.25):
        rows = on_map(seen_from(walls, (float(x), 0.2, 0.0), generator), (float(x), 0.2, 0.0))
        along = (np.abs(np.abs(rows[:, 1]) - HALF_WIDTH) < 0.05) & (np.abs(rows[:, 5]) > 0.9)
        farther.append(rows[along & (rows[:, 2] < 0), 0])
    places, ends = np.concatenate(farther), np.array([high for _, high in DOORS])
    assert len(places) > 20 and np.abs(places[:, None] - ends).min(1).max() < 0.05


def test_a_wall_that_leaves_the_range_of_the_laser_does_not_end() -> None:
    generator = np.random.default_rng(2)
    walls = np.array([((-30.0, -1.2), (30.0, -1.2)), ((-30.0, 1.2), (30.0, 1.2))])
    for yaw in np.linspace(-0.8, 0.8, 33):
        assert len(seen_from(walls, (0.0, 0.0, float(yaw)), generator)) == 0


def test_a_robot_that_stands_near_a_wall_has_no_edges() -> None:
    """Both look like one surface, longer than any robot; a team in equal rooms drew 4.5 % of its walls wrong."""
    generator = np.random.default_rng(4)
    wall, left, right, front, back = ((-30.0, 1.2), (30.0, 1.2)), 2.0, 2.45, 0.65, 1.1
    corners = [(left, back), (left, front), (right, front), (right, back)]
    walls = np.array([wall, *zip(corners, corners[1:] + corners[:1])])
    for x in np.arange(-1.2, 1.4, 0.1):
        for yaw in (0.1, 0.3, 0.5):
            assert len(seen_from(walls, (float(x), 0.0, yaw), generator)) == 0


def drift_along_corridor(edges_count: bool) -> float:
    """m by which the last pose of a way of 12 m is off that odometry counts 6 % too long."""
    generator, walls, graph = np.random.default_rng(3), corridor(), PoseGraph()
    for step in range(49):
        graph.add((0.265 * step, 0.0, 0.0))
        if step:
            graph.link_odometry(step, (0.265, 0.0, 0.0), (0.03, 0.01, 0.001))
            graph.link(step - 1, step, (0.0, 0.0, 0.0), np.diag([1e-3, 1e6, 1e6]))  # its walls tell all but the way
        for row in seen_from(walls, (0.25 * step - 1.0, 0.0, 0.0), generator) if edges_count else ():
            graph.see_edge(step, *row.tolist())
    graph.match_edges()
    graph.solve()
    return abs(graph.pose(48)[0] - 12.0)


def test_jambs_tell_the_way_along_a_corridor() -> None:
    """The walls of a corridor say nothing of it: robots that see 57 degrees went by their wheels alone."""
    assert drift_along_corridor(False) > 0.6
    assert drift_along_corridor(True) < 0.25


@pytest.mark.parametrize(
    "off, normal, across, same",
    [
        ((1, 0), (0, 1), 0.0, True),
        ((-1, 0), (0, 1), 0.0, False),
        ((1, 0), (0, 1), -0.2, False),
        ((1, 0), (0, -1), -0.2, True),
        ((1, 0), (0, -1), 0.2, False),
        ((1, 0), (0, -1), -0.4, False),
    ],
    ids=["as before", "the jamb across", "another wall", "its other side", "an inner corner", "too thick"],
)
def test_edges_are_one_where_they_end_the_same_way_round(
    off: tuple[int, int], normal: tuple[int, int], across: float, same: bool
) -> None:
    """Jambs that face one another across a gap are two things; the end of a wall is one from either of its sides."""
    graph = PoseGraph()
    graph.add((0.0, 0.0, 0.0))
    graph.add((1.0, 0.0, 0.0))
    graph.link_odometry(1, (1.0, 0.0, 0.0), (0.1, 0.1, 0.001))
    graph.see_edge(0, 2.0, -1.0, 1.0, 0.0, 0.0, 1.0, 0.001)
    graph.see_edge(1, 0.9, -1.0 + across, *map(float, off), *map(float, normal), 0.001)
    graph.match_edges()
    graph.solve()
    assert graph.pose(1)[0] == pytest.approx(1.1 if same else 1.0, abs=0.01)
