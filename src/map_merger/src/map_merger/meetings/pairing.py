"""What two robots saw at the same time, as pairs of places that a transform between their frames must lay on one
another."""

from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from .tracking import Fragment, at_times

_KNOT_M = 0.08
_KNOT_S = 3.0
_FEWEST = 3


class Pairs(NamedTuple):
    """source: complex (n,), m, in the other robot's frame. target: complex (n,), m, in the own one. time: float (n,),
    s. sightings: float (n,), of how many each is the mean. label: int (n,), which fragment it is of: one of `own`
    objects of the own robot (source: where the other says it was) or, from there on, one of the other's objects
    (target: where the own robot was)."""

    source: np.ndarray
    target: np.ndarray
    time: np.ndarray
    sightings: np.ndarray
    label: np.ndarray
    own: int
    fragments: int

    @property
    def seen_by_own(self) -> np.ndarray:
        """Bool (n,)."""
        return self.label < self.own


def paired(told: np.ndarray, objects: Sequence[Fragment], own: np.ndarray, told_objects: Sequence[Fragment]) -> Pairs:
    """told, own: tracks of the other and of the own robot (n, 3 or more: time, x, y, ...)."""
    parts: List[Tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    for fragment in objects:
        parts.append(_common(fragment.samples, told, swap=True))
    kept = [part for part in parts if len(part[0]) >= _FEWEST]
    count = len(kept)
    for fragment in told_objects:
        part = _common(fragment.samples, own, swap=False)
        if len(part[0]) >= _FEWEST:
            kept.append(part)
    rows = [(*knot, label) for label, part in enumerate(kept) for knot in _knots(*part)]
    if not rows:
        none = np.zeros(0)
        return Pairs(none.astype(complex), none.astype(complex), none, none, none.astype(int), 0, 0)
    source, target, time, number, label = (np.array(column) for column in zip(*rows))
    return Pairs(source, target, time, number.astype(float), label, count, len(kept))


def _common(samples: np.ndarray, track: np.ndarray, swap: bool) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sources, targets and times at which both are known. swap: the samples are the targets."""
    places, known = at_times(track, samples[:, 0])
    seen = samples[known, 1] + 1j * samples[known, 2]
    places, times = places[known], samples[known, 0]
    return (places, seen, times) if swap else (seen, places, times)


def _knots(source: np.ndarray, target: np.ndarray, time: np.ndarray) -> List[Tuple[complex, complex, float, int]]:
    """Means of what was seen while neither place changed: standing for a minute says no more than a moment."""
    sources, targets, times = source.tolist(), target.tolist(), time.tolist()
    result, start = [], 0
    for index in range(1, len(sources) + 1):
        if index < len(sources) and (
            abs(sources[index] - sources[start]) < _KNOT_M
            and abs(targets[index] - targets[start]) < _KNOT_M
            and times[index] - times[start] < _KNOT_S
        ):
            continue
        count = index - start
        result.append(
            (
                sum(sources[start:index]) / count,
                sum(targets[start:index]) / count,
                sum(times[start:index]) / count,
                count,
            )
        )
        start = index
    return result
