"""What the others have said of frontiers, as this robot sees it: one frozen value."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Callable, Iterable, Mapping, NamedTuple, Optional, Tuple

import numpy as np

from explorer._kernels import near_any
from explorer.statement import Kind

SAME_PLACE = 0.35  # m within which a verdict of another robot means an own point: both thin their points to 0.2 m
SAME_LEFTOVER = 1.5  # m within which a place that another robot leaves means an own cluster
MORE_KNOWN = 0.15  # m^2 that the map shows more than the robot knew that has decided: something new is there
LEAST_KNOWN = 0.98  # of the own known area: a robot whose map has less cannot tell what is left

KnownArea = Callable[[float, float], float]
"""m^2 of the map that are known within a metre of a point in metres."""


class HeardVerdict(NamedTuple):
    """In metres in the own frame; see `Decided`."""

    x: float
    y: float
    kind: Kind
    known: float
    robot: str


class Witness(NamedTuple):
    """A robot that has nothing left, with the m^2 that it knows; `left`: (n, 2) array of the places that it leaves, in
    metres in the own frame. `ended`: it has made sure of it."""

    robot: str
    area: float
    left: np.ndarray
    ended: bool


@dataclass(frozen=True)
class Heard:
    """`speakers`: the robots in reach that have said something; what they said of places needs their transforms.
    `explorers`: those of them that have said lately that they still explore."""

    verdicts: Tuple[HeardVerdict, ...] = ()
    witnesses: Tuple[Witness, ...] = ()
    speakers: Tuple[str, ...] = ()
    explorers: Tuple[str, ...] = ()

    @property
    def has_places(self) -> bool:
        return bool(self.verdicts or self.witnesses)

    @cached_property
    def _decided(self) -> Tuple[HeardVerdict, ...]:
        return tuple(verdict for verdict in self.verdicts if verdict.kind != Kind.LOOKED)

    @cached_property
    def _places(self) -> np.ndarray:
        return np.array([(verdict.x, verdict.y) for verdict in self._decided], dtype=float).reshape(-1, 2)

    def decided(self, points: np.ndarray, known: KnownArea) -> Mapping[int, str]:
        """{row: robot} of those of the (n, 2) points in metres that another robot has visited or given up, unless the
        own map shows more there than that robot knew."""
        if not self._decided or not len(points):
            return {}
        found = {}
        for row in np.flatnonzero(near_any(points, self._places, SAME_PLACE)).tolist():
            x, y = points[row].tolist()
            gaps = np.hypot(self._places[:, 0] - x, self._places[:, 1] - y)
            verdict = self._decided[int(gaps.argmin())]
            if known(x, y) <= verdict.known + MORE_KNOWN:
                found[row] = verdict.robot
        return found

    def denied_by(self, points: np.ndarray, area: float) -> Optional[str]:
        """The robot that has nothing left and does not know of a cluster of these (n, 2) points in metres, though it
        knows as much as the `area` m^2 of the own map; None without one."""
        for witness in self.witnesses:
            if witness.area >= LEAST_KNOWN * area and not near_any(points, witness.left, SAME_LEFTOVER).any():
                return witness.robot
        return None

    def settled(self, area: float) -> bool:
        """True if a robot that knows as much as the `area` m^2 of the own map has ended: what it leaves is little
        enough together. Of robots that have only nothing left for now each would take the other for its witness."""
        return any(witness.ended and witness.area >= LEAST_KNOWN * area for witness in self.witnesses)

    def looks_near(self, x: float, y: float, radius: float) -> int:
        """Closer looks that others have taken within `radius` metres."""
        return sum(
            verdict.kind == Kind.LOOKED and math.hypot(verdict.x - x, verdict.y - y) <= radius
            for verdict in self.verdicts
        )

    def vouched(self, robots: Iterable[str]) -> bool:
        """True if all of these robots are in reach and say what they have decided, so that their word holds."""
        return set(robots) <= set(self.speakers)
