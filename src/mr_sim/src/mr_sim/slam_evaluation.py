"""How well SLAM does on a log of scans whose truth is known."""

import time
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from mr_grid import OccupancyGrid, Pose, normalized
from mr_measures.figures import coverage, wrong_walls
from mr_measures.truth import Truth
from mr_robot.slam.engine import LaserScan, SlamUpdate
from mr_sim.scan_log import ScanLog

LOOP_RADIUS, LOOP_WAY = 5.0, 60.0  # m: a loop ends this near to a place that lies so much of way back
PLACES_APART = 0.25  # m of way between the places where a loop may end


class Engine(Protocol):
    """SLAM to be judged, ours or another."""

    def process(self, scan: LaserScan, odometry: Pose, time: float) -> SlamUpdate: ...

    def map(self) -> OccupancyGrid: ...


@dataclass(frozen=True)
class Evaluation:
    """Errors of the position in m: mean, 0.95 quantile, at the end, and of each scan where a loop ends; of the heading
    in rad, 0.95 quantile. Shares from 0 to 1: occupied cells that are no walls, the reference that is known, scans that
    contradicted the map. `milliseconds` of processor time of a scan: mean and worst, map included."""

    mean_error: float
    q95_error: float
    end_error: float
    loop_errors: np.ndarray
    q95_heading: float
    wrong_walls: float
    coverage: float
    contradicted: float
    milliseconds: tuple[float, float]


@dataclass(frozen=True)
class Run:
    """Of n scans: `poses` (n, 3) of the robot, map frame; `errors` (n,) of the position, m; `matched` bool (n,),
    whether the scan confirmed it. `milliseconds` as in `Evaluation`."""

    poses: np.ndarray
    errors: np.ndarray
    matched: np.ndarray
    milliseconds: tuple[float, float]


def run(log: ScanLog, slam: Engine) -> Run:
    """SLAM over the whole log. Its first pose is where the log begins."""
    start = Pose(*log.truth[0].tolist())
    poses, matched, spent = [], [], []
    for index, (moment, odometry) in enumerate(zip(log.times.tolist(), log.odometry.tolist())):
        scan: LaserScan = log.scan(index)
        began = time.process_time()
        update = slam.process(scan, Pose(*odometry), moment)
        spent.append(1e3 * (time.process_time() - began))
        poses.append(update.pose)
        matched.append(update.matched)
    found = np.array(poses)
    errors = np.hypot(*(found[:, :2] - start.apply_inverse(log.truth[:, :2])).T)
    return Run(found, errors, np.array(matched), (float(np.mean(spent)), float(np.max(spent))))


def evaluate(log: ScanLog, truth: Truth, slam: Engine) -> Evaluation:
    """`slam`: with the options of the log's robot."""
    done = run(log, slam)
    errors, start = done.errors, Pose(*log.truth[0].tolist())
    headings = np.abs([normalized(yaw) for yaw in done.poses[:, 2] - (log.truth[:, 2] - start.yaw)])
    occupancy = slam.map()
    return Evaluation(
        float(errors.mean()), float(np.quantile(errors, 0.95)), float(errors[-1]), errors[loop_ends(log.truth[:, :2])],
        float(np.quantile(headings, 0.95)), wrong_walls(truth, occupancy, start), coverage(truth, occupancy, start),
        1.0 - float(np.mean(done.matched)), done.milliseconds,
    )  # fmt: skip


def loop_ends(positions: np.ndarray) -> np.ndarray:
    """Of positions (n, 2) along a way: bool (n,), whether the robot is within `LOOP_RADIUS` of a place where it was at
    least `LOOP_WAY` of way earlier."""
    way = np.concatenate([[0.0], np.hypot(*np.diff(positions, axis=0).T).cumsum()])
    places = np.unique(np.searchsorted(way, np.arange(0.0, way[-1], PLACES_APART)))
    ends = np.zeros(len(way), dtype=bool)
    for place in places:
        later = int(np.searchsorted(way, way[place] + LOOP_WAY))
        ends[later:] |= np.hypot(*(positions[later:] - positions[place]).T) <= LOOP_RADIUS
    return ends
