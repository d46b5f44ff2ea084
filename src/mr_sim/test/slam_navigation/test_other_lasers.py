"""The SLAM engine with lasers that have few beams or do not see far."""

import math
from typing import Tuple

import numpy as np
import pytest
from usual_robot import slam_with

from mr_grid import Pose
from mr_robot.slam.engine import LaserScan

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
