"""SLAM of robots that are carried away in the midst of their missions, once their maps are well known."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from mr_experiments.bench.rows import Row, printed, row_of
from mr_experiments.bench.slam_logs import Kind, results_of, truth_of
from mr_sim.carried_robot import FOUND, Recovery, carried, evaluate_carried
from mr_sim.scan_log import ScanLog
from mr_sim.slam_evaluation import Engine

KNOWN = 0.6  # of the scans of a log, before its robot is carried,
WAY, TURN = 3.0, 1.0  # m and rad away
MOST_BELIEVED = 10.0  # s in which scans may confirm another place by chance

Make = Callable[[ScanLog], Engine]


@dataclass
class Recoveries:
    """`found`: of the logs on which SLAM ended, with their numbers of `scans`; `failed`: the others, in words."""

    found: list[Recovery] = field(default_factory=list)
    scans: list[int] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)


def recoveries(logs: Mapping[str, ScanLog], make: Make) -> Recoveries:
    """Of the robots of logs by name, each carried after `KNOWN` of its log; a new engine for each, in a process of its
    own."""
    result = Recoveries()
    for name, (each, scans) in results_of(logs, "carried", lambda log: _carried_away(log, make), result.failed):
        result.found.append(each)
        result.scans.append(scans)
        print(f"{name}, carried: {_found(each.seconds)}, another place believed for {each.believed:.1f} s, "
              f"wrong walls {100 * each.wrong_walls:.1f} %", flush=True)  # fmt: skip
    return result


def _carried_away(log: ScanLog, make: Make) -> tuple[Recovery, int]:
    """And the number of scans."""
    known = math.ceil(KNOWN * len(log.times))
    longer = carried(log, known, WAY, TURN)
    return evaluate_carried(longer, known, truth_of(longer), make(longer)), len(longer.times)


def _found(seconds: float) -> str:
    return "not found" if math.isinf(seconds) else f"found after {seconds:.1f} s"


def rows_of(name: str, kind: Kind, results: Sequence[Recovery]) -> list[Row]:
    """Of the logs of one kind; `name`: of that and its odometry."""
    return [
        _found_row(name, kind.found or 0.0, [each.seconds for each in results]),
        _believed_row(name, [each.believed for each in results]),
        _walls_row(name, kind.walls[1], [100.0 * each.wrong_walls for each in results]),
    ]


def _found_row(name: str, bar: float, seconds: Sequence[float]) -> Row:
    found = [each for each in seconds if math.isfinite(each)]
    share = 100.0 * len(found) / len(seconds)
    times = f"; median {np.median(found):.1f} s, worst {max(found):.1f} s" if found else ""
    detail = f"{len(found)} of {len(seconds)} within {FOUND:g} m of their places at the end{times}"
    return printed(row_of(f"carried robots that find themselves, {name}", f">= {bar:g}", share, "%",
                          share >= bar, detail))  # fmt: skip


def _believed_row(name: str, believed: Sequence[float]) -> Row:
    wrong = sum(each > MOST_BELIEVED for each in believed)
    detail = f"of {len(believed)}, for more than {MOST_BELIEVED:g} s; longest {max(believed):.1f} s"
    return printed(row_of(f"carried robots that believe in another place, {name}", "0", float(wrong), "robots",
                          wrong == 0, detail))  # fmt: skip


def _walls_row(name: str, bar: float, walls: Sequence[float]) -> Row:
    detail = f"mean {np.mean(walls):.2f} %; {sum(each > bar for each in walls)} of {len(walls)} logs above"
    return printed(row_of(f"wrong walls of carried robots, worst, {name}", f"<= {bar:g}", max(walls), "%",
                          max(walls) <= bar, detail))  # fmt: skip
