"""SLAM of robots that are carried away: what is asked of it, and what is said of that."""

import math
import os
import signal

import numpy as np
import pytest

from mr_experiments.bench.slam_carried import MOST_BELIEVED, recoveries, rows_of
from mr_experiments.bench.slam_logs import KINDS
from mr_grid import OccupancyGrid, Pose
from mr_robot.slam.engine import LaserScan, SlamUpdate
from mr_sim.carried_robot import Recovery
from mr_sim.scan_log import ScanLog


class Wheels:
    """SLAM that trusts its odometry, whatever it sees."""

    def process(self, scan: LaserScan, odometry: Pose, time: float) -> SlamUpdate:
        return SlamUpdate(odometry, True, False, 1.0)

    def map(self) -> OccupancyGrid:
        return OccupancyGrid.of(np.full((20, 20), -1, np.int8), 0.1, Pose())


class Killed(Wheels):
    def process(self, scan: LaserScan, odometry: Pose, time: float) -> SlamUpdate:
        os.kill(os.getpid(), signal.SIGKILL)
        raise AssertionError


def on_an_arc() -> ScanLog:
    """Ten seconds of 0.5 m/s and 1/6 rad/s: 3 m are half a rad."""
    times = np.arange(100) / 10.0
    truth = np.column_stack([3.0 * np.sin(times / 6.0), 3.0 - 3.0 * np.cos(times / 6.0), times / 6.0])
    geometry = np.array([-0.5, 0.25, 0.1, 4.0, 0.0, 0.0, 0.0])
    return ScanLog("small8x8", geometry, times, np.ones((100, 5), np.float32), truth, truth)


def test_a_robot_that_trusts_its_wheels_believes_in_another_place_to_the_end() -> None:
    found = recoveries({"arc": on_an_arc()}, lambda _: Wheels())
    (recovery,), (scans,) = found.found, found.scans
    assert math.isinf(recovery.seconds) and not found.failed
    assert scans == 60 + 100, "carried back to its start, the place that is most like the one asked for"
    assert recovery.believed == pytest.approx(9.9)


def test_a_robot_whose_slam_does_not_end_is_named() -> None:
    found = recoveries({"arc": on_an_arc()}, lambda _: Killed())
    assert found.failed == ["arc, carried: its process was ended by SIGKILL"]
    assert not found.found and not found.scans


def test_rows_tell_who_was_found_and_when_who_believes_and_what_was_drawn() -> None:
    results = [
        Recovery(4.0, 0.0, 0.0, (1.0, 2.0)),
        Recovery(math.inf, MOST_BELIEVED + 1.0, 0.04, (1.0, 2.0)),
        Recovery(60.0, MOST_BELIEVED, 0.02, (1.0, 2.0)),
        Recovery(6.0, 0.0, 0.0, (1.0, 2.0)),
    ]
    found, believed, walls = rows_of("office", KINDS["pioneers"], results)
    assert (found["value"], found["bar"], found["holds"]) == (75.0, ">= 80", False)
    assert found["detail"] == "3 of 4 within 0.2 m of their places at the end; median 6.0 s, worst 60.0 s"
    assert (believed["value"], believed["holds"]) == (1.0, False)
    assert believed["detail"] == "of 4, for more than 10 s; longest 11.0 s"
    assert (walls["value"], walls["bar"], walls["holds"]) == (pytest.approx(4.0), "<= 3", False)
    assert walls["detail"] == "mean 1.50 %; 1 of 4 logs above"


def test_robots_that_rightly_stay_lost_are_no_miss() -> None:
    rows = rows_of("equal rooms", KINDS["equal rooms"], [Recovery(math.inf, 0.0, 0.0, (1.0, 2.0))])
    assert all(row["holds"] for row in rows)
    assert rows[0]["detail"] == "0 of 1 within 0.2 m of their places at the end"
