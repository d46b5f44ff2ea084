"""SLAM on CARMEN logs: what is read, and how paths are judged."""

import math
from pathlib import Path

import numpy as np
import pytest

from map_merger.benchmark.real_logs import Log
from mr_experiments.bench import bench_slam
from mr_experiments.bench.real_logs import fitted, judge, measures_of, scan_log, scan_logs
from mr_grid import OccupancyGrid, Pose
from mr_robot.slam.engine import LaserScan, SlamUpdate


class Follows:
    """Believes odometry, turned by an angle at the start and stretched."""

    def __init__(self, turn: float, stretch: float) -> None:
        self._start, self._stretch = Pose(1.0, 2.0, turn), stretch

    def process(self, scan: LaserScan, odometry: Pose, time: float) -> SlamUpdate:
        stretched = Pose(self._stretch * odometry.x, self._stretch * odometry.y, odometry.yaw)
        return SlamUpdate(self._start.compose(stretched), True, True, 1.0)

    def map(self) -> OccupancyGrid:
        raise NotImplementedError


def square() -> Log:
    """Along a square of 20 m in steps of half a metre."""
    poses = [
        (x, y, yaw)
        for k, yaw in enumerate((0.0, 0.5 * math.pi, math.pi, -0.5 * math.pi))
        for x, y in ((np.array([0.5 * i - 10.0, -10.0]) @ _turned(k)) for i in range(40))
    ]
    return Log("square", np.array(poses), np.full((160, 180), 4.0))


def _turned(quarters: int) -> np.ndarray:
    c, s = math.cos(0.5 * math.pi * quarters), math.sin(0.5 * math.pi * quarters)
    return np.array([[c, s], [-s, c]])


def test_where_the_path_begins_does_not_count() -> None:
    errors = judge(scan_log(square()), Follows(0.7, 1.0))
    assert errors.position == pytest.approx(0.0, abs=1e-9) and errors.relation == pytest.approx(0.0, abs=1e-9)


def test_a_stretched_path_is_off_by_the_share_of_its_relations() -> None:
    errors = judge(scan_log(square()), Follows(0.0, 1.02))
    assert errors.relation == pytest.approx(0.02 * 5.0, rel=0.15) and errors.turn == pytest.approx(0.0, abs=1e-9)
    assert errors.position == pytest.approx(0.02 * 11.5, rel=0.05)
    assert [measure.counts for measure in measures_of(errors)] == [True, True, False, False, False]


def test_points_are_fitted_by_turning_and_moving() -> None:
    target = np.array([[0.0, 0.0], [3.0, 1.0], [1.0, 4.0]])
    assert fitted(target @ _turned(1) + (5.0, -2.0), target) == pytest.approx(target)


def test_failed_readings_are_invalid_and_odometry_comes_from_the_seed(tmp_path: Path) -> None:
    lines = [f"FLASER 4 1.0 2.0 3.0 80.0 {x} 0 0 {x} 0 0 {x} host {x}" for x in (0.0, 1.0, 2.0)]
    (tmp_path / "hall.log").write_text("\n".join(lines) + "\n")
    (log,), (again,), (other,) = (list(scan_logs(tmp_path, seed)) for seed in (1, 1, 2))
    assert log.world == "hall" and np.isnan(log.ranges[:, 3]).all() and log.ranges[0, 2] == 3.0
    assert (log.odometry == again.odometry).all() and (log.odometry != other.odometry).any()
    assert (log.truth[:, 0] == [0.0, 1.0, 2.0]).all()


def test_a_folder_without_logs_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert bench_slam.main(["--kinds", "--real-logs", str(tmp_path), "--out", str(tmp_path / "rows.json")]) == 2
    assert "--real-logs: no *.log or *.log.gz" in capsys.readouterr().err
