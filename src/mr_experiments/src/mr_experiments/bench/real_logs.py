"""SLAM on CARMEN logs of real robots: their corrected poses are the truth, and odometry errs as a random walk.

Of such logs only the corrected poses are public; what odometry said is drawn around them.
"""

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from map_merger.benchmark.real_logs import Log, logs_of
from mr_experiments.bench.slam_comparison import Measure
from mr_grid import Pose
from mr_sim.scan_log import ScanLog, with_random_walk
from mr_sim.slam_evaluation import Engine

FULL_SCALE = 0.97  # of the longest reading, from where on readings are failures
NEAREST = 0.02  # m
INTERVAL = 1.0  # s between scans: the logs are thinned out, and SLAM takes differences only
ODOMETRY_ERROR = (0.03, 0.05)  # m after 1 m and rad after 1 rad
RELATION = 5.0  # m of way between the scans whose relation is judged


@dataclass(frozen=True)
class PathErrors:
    """Root mean squares: of the positions after the best rigid fit, m; of the relations between scans 5 m of way apart,
    m and rad. `milliseconds` of processor time of a scan: mean and worst."""

    position: float
    relation: float
    turn: float
    milliseconds: tuple[float, float]


def scan_logs(folder: Path, seed: int) -> Iterator[ScanLog]:
    """All logs of a folder, with odometry drawn from the seed. Raises ValueError for a folder without logs."""
    for number, log in enumerate(logs_of(folder)):
        yield with_random_walk(scan_log(log), *ODOMETRY_ERROR, seed + number)


def scan_log(log: Log) -> ScanLog:
    """With the corrected poses as odometry."""
    count = log.ranges.shape[1]
    step = math.pi / count if count % 2 == 0 else math.pi / (count - 1)
    most = FULL_SCALE * float(log.ranges.max())
    ranges = np.where(log.ranges < most, log.ranges, np.nan).astype(np.float32)
    geometry = np.array([-0.5 * math.pi, step, NEAREST, most, 0.0, 0.0, 0.0])
    return ScanLog(log.name, geometry, INTERVAL * np.arange(len(ranges)), ranges, log.poses, log.poses)


def judge(log: ScanLog, slam: Engine) -> PathErrors:
    poses, spent = [], []
    for index, (moment, odometry) in enumerate(zip(log.times.tolist(), log.odometry.tolist())):
        began = time.process_time()
        poses.append(slam.process(log.scan(index), Pose(*odometry), moment).pose)
        spent.append(1e3 * (time.process_time() - began))
    found = np.array(poses)
    way = np.concatenate([[0.0], np.hypot(*np.diff(log.truth[:, :2], axis=0).T).cumsum()])
    later = np.searchsorted(way, way + RELATION)
    first = np.flatnonzero(later < len(way))
    relations = _relations(found, first, later[first]), _relations(log.truth, first, later[first])
    off = relations[0] - relations[1]
    turns = np.arctan2(np.sin(off[:, 2]), np.cos(off[:, 2]))
    return PathErrors(
        _root_mean_square(np.hypot(*(fitted(found[:, :2], log.truth[:, :2]) - log.truth[:, :2]).T)),
        _root_mean_square(np.hypot(*off[:, :2].T)), _root_mean_square(turns),
        (float(np.mean(spent)), float(np.max(spent))),
    )  # fmt: skip


def measures_of(errors: PathErrors) -> list[Measure]:
    return [
        Measure("position error, RMS", "m", errors.position),
        Measure(f"relation over {RELATION:g} m, RMS", "m", errors.relation),
        Measure("its turn", "deg", math.degrees(errors.turn), False),
        Measure("time per scan, mean", "ms", errors.milliseconds[0], False),
        Measure("time per scan, worst", "ms", errors.milliseconds[1], False),
    ]


def fitted(points: np.ndarray, target: np.ndarray) -> np.ndarray:
    """The points (n, 2) moved and turned so that they lie nearest to the target's (n, 2)."""
    a, b = points - points.mean(axis=0), target - target.mean(axis=0)
    angle = math.atan2(float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()), float((a * b).sum()))
    c, s = math.cos(angle), math.sin(angle)
    return a @ np.array([[c, s], [-s, c]]) + target.mean(axis=0)


def _relations(poses: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Poses (n, 3) seen from others."""
    a, b = poses[first], poses[second]
    c, s, d = np.cos(a[:, 2]), np.sin(a[:, 2]), b - a
    return np.stack([c * d[:, 0] + s * d[:, 1], -s * d[:, 0] + c * d[:, 1], d[:, 2]], axis=1)


def _root_mean_square(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else math.nan
