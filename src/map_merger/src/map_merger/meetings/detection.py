"""Objects of a robot's size in a laser scan."""

from typing import NamedTuple, Tuple

import numpy as np

from ..robot_size import RobotSize
from .values import LaserScan, goes_round

FARTHEST_M = 6.0
NARROWEST_M = 0.1
_JUMP_M = 0.15
_JUMP_SHARE = 0.05
"""The background is farther than the edge of an object by at least this, and this share of the range."""
_FEWEST_BEAMS = 4


class Objects(NamedTuple):
    """Objects in the robot's frame. centres: float (n, 2), m. widths: float (n,), m, as seen."""

    centres: np.ndarray
    widths: np.ndarray


NO_OBJECTS = Objects(np.empty((0, 2)), np.empty(0))


def objects_in_scan(scan: LaserScan, size: RobotSize) -> Objects:
    """Objects of the size of the team's robots that stand in front of all that is beside them.

    The beams end on the surface, the centre lies behind it: at half a body's depth behind a flat side, and on the line
    between both edges of anything that bulges towards the sensor as far as that (a corner, a round body).
    """
    ranges = np.asarray(scan.ranges, float)
    with np.errstate(invalid="ignore"):
        valid = (ranges >= scan.range_min) & (ranges > 0.05)
    seen = np.where(valid, np.minimum(ranges, scan.range_max), 0.0)
    beams = seen.size
    if goes_round(beams, scan.angle_increment):
        seen = np.concatenate([seen, seen[: beams // 4]])  # what the last beams see goes on with the first ones
    first, last = _in_front(seen)
    # Wider things are dropped by their angle, before their points are looked at.
    with np.errstate(divide="ignore"):
        widths = seen[first] * abs(scan.angle_increment) * (last - first)
    fits = (
        (first < beams)
        & (seen[first] <= FARTHEST_M)
        & (last - first + 1 >= _FEWEST_BEAMS)
        & (widths <= 2.0 * size.widest)
    )
    first, last = first[fits], last[fits]
    if not first.size:
        return NO_OBJECTS
    angles = scan.angle_min + scan.angle_increment * np.arange(seen.size)
    points = scan.mount.apply(np.column_stack([seen * np.cos(angles), seen * np.sin(angles)]))
    return _measured(points.view(complex).ravel(), first, last, complex(scan.mount.x, scan.mount.y), size)


def _in_front(seen: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """First and last beams of the runs without a jump whose neighbours on both sides are farther. A beam that gives
    nothing (0 m) is a neighbour that may hide the rest."""
    step = np.diff(seen)
    jump = np.maximum(_JUMP_M, _JUMP_SHARE * np.minimum(seen[:-1], seen[1:]))
    breaks = np.flatnonzero(np.abs(step) > jump)
    first, last = breaks[:-1] + 1, breaks[1:]
    front = (step[breaks[:-1]] < 0.0) & (step[breaks[1:]] > 0.0) & (seen[first] > 0.0)
    return first[front], last[front]


def _measured(points: np.ndarray, first: np.ndarray, last: np.ndarray, eye: complex, size: RobotSize) -> Objects:
    centres, widths = [], []
    for start, end in zip(first.tolist(), last.tolist()):
        part = points[start : end + 1]
        chord = part[-1] - part[0]
        width = abs(chord)
        middle = 0.5 * (part[-1] + part[0])
        if not NARROWEST_M <= width <= size.widest:
            continue
        away = chord / width * 1j
        if (away * (middle - eye).conjugate()).real < 0.0:
            away = -away
        bulge = max(0.0, float(-((part - middle) * away.conjugate()).real.min()))
        centres.append(middle + away * max(0.0, size.body_radius - bulge))
        widths.append(width)
    if not centres:
        return NO_OBJECTS
    return Objects(np.array(centres).view(float).reshape(-1, 2), np.array(widths))
