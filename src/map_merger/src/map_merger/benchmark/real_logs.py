"""Pairs of maps from CARMEN logs: two disjoint pieces of one log, each mapped in the frame of its own start.

CARMEN logs: lines `FLASER n r1..rn x y theta odom_x odom_y odom_theta time host time`, plain or gzip; metres and
radians, 180 degrees of view. The poses, corrected by who published the log, are the truth.
"""

import gzip
import math
from pathlib import Path
from typing import Iterator, List, NamedTuple, Optional, TextIO, Tuple

import numpy as np

from mr_grid import OccupancyGrid, Pose

from ..surface import landmarks_of
from ..synthetic import GridDrawer, info_around
from .families import STAGES, Case, self_alias
from .outcome import best_rigid_fit, shared_wall

REACH_M = 12.0
RESOLUTION = 0.05
_SHORTEST_M, _LONGEST_M = 8.0, 70.0
_FULL_SCALE = 0.97
"""Readings from this share of the largest one on are failures (glass, black things), not free space."""
_NEAR_M = 8.0
"""Only pieces whose paths come this near to one another are of interest."""


class Log(NamedTuple):
    """A log: laser poses (n, 3; x, y, yaw) and ranges (n, beams; m), over 180 degrees."""

    name: str
    poses: np.ndarray
    ranges: np.ndarray


def read_log(path: Path) -> Log:
    """The log at that path. ValueError, naming the file, if it holds no scan that can be read."""
    poses: List[np.ndarray] = []
    ranges: List[np.ndarray] = []
    with _opened(path) as file:
        for line in file:
            if not line.startswith("FLASER "):
                continue
            words = line.split()
            count = int(words[1])
            values = np.array(words[2 : count + 5], float)
            if len(values) == count + 3 and (not ranges or len(ranges[0]) == count):
                ranges.append(values[:count])
                poses.append(values[count:])
    if not poses:
        raise ValueError(f"no FLASER lines in {path}")
    return Log(path.name.split(".")[0], np.array(poses), np.array(ranges))


def _opened(path: Path) -> TextIO:
    if path.suffix == ".gz":
        return gzip.open(path, "rt", encoding="utf-8", errors="replace")  # type: ignore[return-value]
    return open(path, encoding="utf-8", errors="replace")


def logs_of(folder: Path) -> List[Log]:
    """All logs (*.log, *.log.gz) of a folder, by name. ValueError if there is none."""
    paths = sorted(path for path in folder.glob("*") if path.name.endswith((".log", ".log.gz")))
    if not paths:
        raise ValueError(f"no *.log or *.log.gz in {folder}")
    return [read_log(path) for path in paths]


def cases_of(log: Log, seed: int, count: int) -> Iterator[Case]:
    """Pairs of pieces of one log, of many lengths, that come near to one another."""
    random = np.random.default_rng(seed)
    found = 0
    for trial in range(200 * count):
        case = _drawn(log, random, seed + trial)
        if case is not None:
            found += 1
            yield case
        if found == count:
            return


def _drawn(log: Log, random: np.random.Generator, seed: int) -> Optional[Case]:
    along = np.concatenate([[0.0], np.hypot(*np.diff(log.poses[:, :2], axis=0).T).cumsum()])
    pieces = []
    for _ in range(2):
        length = random.uniform(_SHORTEST_M, min(_LONGEST_M, 0.45 * along[-1]))
        start = random.uniform(0.0, along[-1] - length)
        pieces.append(np.flatnonzero((along >= start) & (along <= start + length)))
    first, second = pieces
    if min(len(first), len(second)) < 5 or not (first[-1] < second[0] or second[-1] < first[0]):
        return None
    gaps = log.poses[first, None, :2] - log.poses[None, second, :2]
    if np.hypot(gaps[..., 0], gaps[..., 1]).min() > _NEAR_M:
        return None
    return _case(log, first, second, random, seed)


def _case(log: Log, first: np.ndarray, second: np.ndarray, random: np.random.Generator, seed: int) -> Case:
    starts = [Pose(*log.poses[piece[0]].tolist()) for piece in (first, second)]
    maps = [_maps(log, piece, start, random) for piece, start in zip((first, second), starts)]
    target, source = (landmarks_of(stages[-1]) for stages in maps)
    truth = best_rigid_fit(target, source, starts[0].inverse().compose(starts[1]))
    shared = shared_wall(maps[0][-1], maps[1][-1], truth)
    return Case(seed, log.name, maps[0], maps[1], truth, shared, self_alias(target, source, truth), math.nan)


def _maps(log: Log, piece: np.ndarray, start: Pose, random: np.random.Generator) -> Tuple[OccupancyGrid, ...]:
    """The growing map of a piece in the frame of its start."""
    to_map = start.inverse()
    path = to_map.apply(log.poses[piece, :2])
    drawer = GridDrawer(info_around(path, REACH_M, RESOLUTION, random.uniform(-0.5, 0.5, 2).tolist()))
    count = log.ranges.shape[1]
    step = math.pi / count if count % 2 == 0 else math.pi / (count - 1)
    angles = -0.5 * math.pi + step * np.arange(count)
    no_return = _FULL_SCALE * log.ranges.max()
    ends = [max(1, round(share * len(piece))) - 1 for share in STAGES]
    stages: List[OccupancyGrid] = []
    for index, scan in enumerate(piece):
        pose = to_map.compose(Pose(*log.poses[scan].tolist()))
        returned = log.ranges[scan] < no_return
        drawer.add(pose, angles[returned], np.minimum(log.ranges[scan][returned], REACH_M), REACH_M)
        stages.extend([drawer.grid()] * ends.count(index))
    return tuple(stages)
