"""Robots that are carried away: scan logs in which that happens, and whether SLAM finds out where they are."""

import math
from dataclasses import dataclass, replace

import numpy as np

from mr_grid import Pose
from mr_measures.figures import wrong_walls
from mr_measures.truth import Truth
from mr_sim.scan_log import ScanLog
from mr_sim.slam_evaluation import Engine, run

CARRYING = 3.0  # s
FOUND = 0.2  # m from where the robot is, within which it knows its place


@dataclass(frozen=True)
class Recovery:
    """Of a robot after it was put down. `seconds` until it knows its place, and does to the end; infinite: it does not.
    `believed`: s in which scans confirmed another place. `wrong_walls`: share of the occupied cells of the map at the
    end. `milliseconds` of processor time of a scan: mean and worst over the whole log."""

    seconds: float
    believed: float
    wrong_walls: float
    milliseconds: tuple[float, float]


def carried(log: ScanLog, known: int, way: float, turn: float) -> ScanLog:
    """The first `known` scans, and those from about `way` (m) and `turn` (rad) away, its wheels silent meanwhile."""
    off = np.hypot(*(log.truth[:known, :2] - log.truth[known - 1, :2]).T)
    turned = np.abs(np.remainder(log.truth[:known, 2] - log.truth[known - 1, 2] + math.pi, 2.0 * math.pi) - math.pi)
    first = int(np.argmin(np.abs(off - way) + 2.0 * np.abs(turned - turn)))
    before, begun = Pose(*log.odometry[known - 1].tolist()), Pose(*log.odometry[first].tolist())
    later = [tuple(before.compose(begun.between(Pose(*each)))) for each in log.odometry[first:].tolist()]
    times = log.times[first:] - log.times[first] + log.times[known - 1] + CARRYING
    return replace(
        log,
        times=np.concatenate([log.times[:known], times]),
        ranges=np.concatenate([log.ranges[:known], log.ranges[first:]]),
        odometry=np.concatenate([log.odometry[:known], np.array(later)]),
        truth=np.concatenate([log.truth[:known], log.truth[first:]]),
    )


def evaluate_carried(log: ScanLog, known: int, truth: Truth, slam: Engine) -> Recovery:
    """Runs SLAM over a log whose robot is carried after its first `known` scans."""
    done = run(log, slam)
    start = Pose(*log.truth[0].tolist())
    return Recovery(
        *judged(log.times[known:], done.errors[known:], done.matched[known:]),
        wrong_walls(truth, slam.map(), start),
        done.milliseconds,
    )


def judged(times: np.ndarray, errors: np.ndarray, matched: np.ndarray) -> tuple[float, float]:
    """`seconds` and `believed` of a `Recovery`. Of the n scans since the robot was put down: `times` (n,) in s,
    `errors` (n,) of the position in m, `matched` bool (n,), whether the scan confirmed it."""
    wrong = errors > FOUND
    believed = float(np.diff(times)[(wrong & matched)[:-1]].sum())
    if wrong[-1]:
        return math.inf, believed
    lost = np.flatnonzero(wrong)
    return (float(times[lost[-1] + 1] - times[0]) if len(lost) else 0.0), believed
