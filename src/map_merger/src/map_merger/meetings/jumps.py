"""Tracks without the jumps of SLAM.

SLAM that sees little, as with a narrow view, now and then moves a robot by some decimetres at once, and perhaps back
later. What was seen before and after such a jump is not in one frame, and the poses of a robot that drives past have a
step in them that nobody sees. So what was before is carried to where it would be had the robot driven on evenly.
"""

import math
from typing import List, NamedTuple, Tuple

import numpy as np

from mr_grid import Pose

from .fitting import transform_from
from .sweeps import Sweeps
from .tracking import Fragment

_LONGEST_STEP_S = 0.75
"""Between two poses farther apart in time a robot may have done anything."""
_JUMP_M = 0.06
_FASTER = 1.0
"""A step differs from those beside it by more than _JUMP_M (m) and what an acceleration of _FASTER (m/s^2) explains."""
_JUMP_RAD = 0.2
_TURNS_FASTER = 4.0
"""The same of the heading, rad and rad/s^2."""


class Jumps(NamedTuple):
    """times: float (n,), s, rising. turns: unit complex (n + 1,), and shifts: complex (n + 1,), m: what carries a place
    from before the first jump, the second one and so on, and from after the last one, to the present frame. size: root
    sum of the squares of the jumps, m."""

    times: np.ndarray
    turns: np.ndarray
    shifts: np.ndarray
    size: float = 0.0

    def steady(self, rows: np.ndarray) -> np.ndarray:
        """Rows (n, >= 3: time, x, y and perhaps yaw) in the present frame."""
        if not len(self.times) or not len(rows):
            return rows
        turn, shift = self._at(rows[:, 0])
        places = turn * (rows[:, 1] + 1j * rows[:, 2]) + shift
        moved = rows.copy()
        moved[:, 1], moved[:, 2] = places.real, places.imag
        if rows.shape[1] > 3:
            moved[:, 3] += np.angle(turn)
        return moved

    def steady_fragments(self, fragments: Tuple[Fragment, ...]) -> Tuple[Fragment, ...]:
        """What was seen, in the present frame."""
        if not len(self.times):
            return fragments
        return tuple(Fragment(each.number, self.steady(each.samples)) for each in fragments)

    def steady_sweeps(self, sweeps: Sweeps) -> Sweeps:
        """Scans, in the present frame."""
        if not len(self.times):
            return sweeps
        turn, shift = self._at(sweeps.times)
        return sweeps._replace(eyes=turn * sweeps.eyes + shift, headings=turn * sweeps.headings)

    def mean_frame(self, track: np.ndarray) -> Pose:
        """From the present frame to that in which the robot was on the mean of the time of its track (n, 4), as it is
        without this correction: what was mapped meanwhile lies about there."""
        if not len(self.times):
            return Pose()
        turn, shift = self._at(track[:, 0])
        weight = np.gradient(track[:, 0])
        mapped = track[:, 1] + 1j * track[:, 2]
        present = complex(np.average(turn * mapped + shift, weights=weight))
        back = complex(np.average(turn.conjugate(), weights=weight))
        back /= abs(back)
        return transform_from(back, complex(np.average(mapped, weights=weight)) - back * present)

    def _at(self, times: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        before = np.searchsorted(self.times, times, side="right")
        return self.turns[before], self.shifts[before]


def jumps_of(track: np.ndarray) -> Jumps:
    """The jumps of a track (n, 4: time, x, y, yaw), oldest first."""
    turns, shifts, times, size = [1.0 + 0j], [0j], [], 0.0
    for index, step, heading in reversed(_uneven(track)):
        # From the frame before the jump to that after it: the pose that was expected becomes the one there is.
        turn = complex(np.exp(1j * (track[index + 1, 3] - track[index, 3] - heading)))
        here = complex(track[index, 1], track[index, 2])
        expected = here + step * complex(np.exp(1j * track[index, 3]))
        shift = complex(track[index + 1, 1], track[index + 1, 2]) - turn * expected
        size = math.hypot(size, abs(complex(track[index + 1, 1], track[index + 1, 2]) - expected))
        times.append(0.5 * float(track[index, 0] + track[index + 1, 0]))
        shifts.append(turns[-1] * shift + shifts[-1])
        turns.append(turns[-1] * turn)
    return Jumps(np.array(times[::-1]), np.array(turns[::-1]), np.array(shifts[::-1]), size)


def _uneven(track: np.ndarray) -> List[Tuple[int, complex, float]]:
    """The steps that differ from both beside them: the row before, and what step (m, in the robot's frame) and turn
    (rad) the steps beside it would have made."""
    if len(track) < 2:
        return []
    span = np.maximum(np.diff(track[:, 0]), 1e-3)
    places = track[:, 1] + 1j * track[:, 2]
    speed = np.diff(places) * np.exp(-1j * track[:-1, 3]) / span
    rate = (np.mod(np.diff(track[:, 3]) + np.pi, 2.0 * np.pi) - np.pi) / span
    close = span <= _LONGEST_STEP_S
    beside_speed, beside_rate = _beside(speed, close), _beside(rate, close)
    off = np.abs(speed - beside_speed) * span > _JUMP_M + _FASTER * span**2
    off |= np.abs(rate - beside_rate) * span > _JUMP_RAD + _TURNS_FASTER * span**2
    # Beside a jump every step looks uneven: the greatest counts.
    size = np.abs(speed - beside_speed) * span + np.abs(rate - beside_rate) * span
    found = []
    for index in np.flatnonzero(off & close).tolist():
        neighbours = size[max(0, index - 1) : index + 2]
        if size[index] >= neighbours.max():
            found.append((index, complex(beside_speed[index] * span[index]), float(beside_rate[index] * span[index])))
    return found


def _beside(values: np.ndarray, close: np.ndarray) -> np.ndarray:
    """Mean of the values before and after each, of those that are close in time; 0 where there are none."""
    usable = np.where(close, values, 0.0)
    total, count = np.zeros_like(usable), np.zeros(len(values))
    total[1:] += usable[:-1]
    count[1:] += close[:-1]
    total[:-1] += usable[1:]
    count[:-1] += close[1:]
    return total / np.maximum(count, 1.0)
