"""SLAM and navigation with lasers that have few beams, do not see far, or look elsewhere than usual."""

import math
from pathlib import Path
from typing import Callable, List, Tuple

import numpy as np
import pytest
from usual_robot import slam_with

from mr_grid import Pose
from mr_robot.slam.engine import LaserScan
from mr_sim.closed_loop import ClosedLoop, Robot

Box = Tuple[float, float, float, float]
"""Least and greatest x, least and greatest y in m of a room without anything in it."""


def all_around(beams: int, reach: float, box: Box, pose: Pose, random: np.random.Generator) -> LaserScan:
    """`reach`: m."""
    step = 2.0 * math.pi / beams
    angles = -math.pi + step * np.arange(beams)
    dx, dy = np.cos(angles + pose.yaw), np.sin(angles + pose.yaw)
    low_x, high_x, low_y, high_y = box
    with np.errstate(divide="ignore"):
        ahead = np.where(dx > 0.0, high_x - pose.x, low_x - pose.x) / dx
        aside = np.where(dy > 0.0, high_y - pose.y, low_y - pose.y) / dy
    ranges = np.minimum(ahead, aside)
    ranges = np.where(ranges < reach, ranges + random.normal(0.0, 0.01, beams), reach)
    return LaserScan(ranges.astype(np.float32), -math.pi, step, 0.12, reach, Pose())


def lost_along(beams: int, reach: float, box: Box) -> float:
    """m that SLAM is off at worst while the robot drives 6 m ahead, with odometry that tells the truth."""
    slam, random, worst = slam_with(), np.random.default_rng(1), 0.0
    for step in range(160):
        pose = Pose(0.05 * max(0, step - 40), 0.0, 0.0)
        found = slam.process(all_around(beams, reach, box, pose, random), pose, 0.1 * step).pose
        worst = max(worst, math.dist(found[:2], pose[:2]))
    return worst


def test_few_beams_along_a_corridor_do_not_say_that_the_robot_stands() -> None:
    """Where a wall would be seen after a motion was asked from the nearest beam, 5 degrees beside it: next to nothing
    spoke for motion, and a robot with 36 beams lost a metre in a corridor."""
    assert lost_along(36, 8.0, (-30.0, 30.0, -0.9, 1.1)) < 0.05


def test_a_wall_that_the_robot_leaves_out_of_reach_does_not_say_that_it_stands() -> None:
    """A fourth of the piece of a wall that a laser of 2 m shows is out of reach after half a metre along it: that spoke
    against motion, and the robot was put back by as much."""
    assert lost_along(360, 2.0, (-30.0, 30.0, -1.85, 30.0)) < 0.05


@pytest.mark.parametrize("beams, reach", [(36, 8.0), (90, 3.5), (360, 2.0)])
def test_wheels_that_slip_are_seen_by_any_laser(beams: int, reach: float) -> None:
    """In a closed room all walls were one thing whose ends touch, so a small one, and odometry alone was believed."""
    slam, random, box = slam_with(), np.random.default_rng(1), (-1.5, 1.7, -1.2, 1.6)
    for step in range(100):
        odometry = Pose(0.03 * max(0, step - 40), 0.0, 0.0)
        pose = slam.process(all_around(beams, reach, box, Pose(), random), odometry, 0.1 * step).pose
    assert odometry.x > 1.5 and math.hypot(pose.x, pose.y) < 0.05


def test_a_laser_at_the_front_that_looks_ahead_does_not_leave_the_robot_in_unknown_ground() -> None:
    """Of what a laser 0.3 m ahead that sees half a circle does not see, only a disc of 0.17 m around the middle was
    free: a ring of unknown cells closed every way of a robot that had not moved."""
    slam, mount = slam_with(), Pose(0.3, 0.0, 0.0)
    angles = np.linspace(-math.pi / 2.0, math.pi / 2.0, 181)
    with np.errstate(divide="ignore"):
        ranges = np.minimum(1.7 / np.abs(np.sin(angles)), 2.5 / np.cos(angles)).astype(np.float32)
    for step in range(40):
        scan = LaserScan(ranges, float(angles[0]), math.pi / 180.0, 0.02, 5.6, mount)
        slam.process(scan, Pose(), 0.1 * step)
    grid = slam.map()
    ahead = grid.info.cells_of(np.array([(x, y) for x in np.arange(0.0, 1.0, 0.02) for y in (-0.03, 0.0, 0.03)]))
    assert (grid.cells[tuple(ahead.T)] == 0).all()
    behind = grid.info.cells_of(np.array([(-0.3, 0.0), (0.2, 0.2)]))
    assert (grid.cells[tuple(behind.T)] == -1).all(), "what it neither sees nor stands on stays unknown"


def test_a_robot_wider_than_two_metres_has_a_map() -> None:
    """The map was made for a metre around the robot only, whatever was freed below it."""
    slam = slam_with(free_radius=1.4)
    slam.process(all_around(360, 5.0, (-3.0, 3.0, -3.0, 3.0), Pose(), np.random.default_rng(1)), Pose(), 0.0)
    grid = slam.map()
    assert grid.cells[tuple(grid.info.cell_of(1.3, 0.0))] == 0


@pytest.mark.parametrize("degrees, ahead", [(0.0, True), (180.0, False)])
def test_a_robot_drives_where_its_laser_looks(draw_world: Callable[..., str], degrees: float, ahead: bool) -> None:
    """One whose laser looks back drove ahead blindly, and into walls."""
    path = Path(draw_world((6.0, 4.0), [(3.0, 1.5, 0.4, 1.0)], [(1.0, 2.0, degrees)]))
    laser = f"pose [ {0.1 if ahead else -0.1} 0 0 {degrees} ] sensor ( range [ 0 8 ] fov 180 samples 181"
    path.write_text(path.read_text().replace("pose [ 0.1 0 0 0 ] sensor ( range [ 0 8 ] fov 270 samples 541", laser))
    loop = ClosedLoop(str(path), 1, 1)
    driven: List[float] = []

    def count(robot: Robot, _: Pose) -> None:
        driven.append(robot.velocities[0])

    loop.on_scan = count
    loop.run(1.0)
    robot = loop.robots[0]
    robot.set_goal(robot.local(Pose(2.3, 3.2, 0.0)), loop.world.time)
    loop.run(60.0, lambda: bool(robot.results))
    assert robot.results[0][1] == "succeeded" and robot.contacts == 0
    assert (np.sum(driven) > 0.0) == ahead
