"""One robot's part of a mission record. Lengths in m, angles in rad, times in s since the start of the mission."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from mr_grid import Pose
from mr_measures.record.json_form import Key, Written
from mr_measures.record.series import RobotSeries

SPARSE = Written.UNLESS_DEFAULT
COUNTERS = ("bytes_sent", "frames_sent", "packets_sent", "packets_failed")  # of the radio, in every host


@dataclass(frozen=True)
class Contacts:
    """How often the footprint would have overlapped something, and when each contact began."""

    walls: int = 0
    robots: int = 0
    times: tuple[float, ...] = ()

    @property
    def total(self) -> int:
        return self.walls + self.robots


@dataclass(frozen=True)
class MapFigures:
    """Of the robot's last global map; None without a map, or for a reason that `error_reason` gives. `error`: in
    percent; `coverage`, `wrong_walls`: shares."""

    free_cells: Annotated[int | None, SPARSE] = None
    error: Annotated[float | None, SPARSE] = None
    error_reason: Annotated[str, SPARSE] = ""
    coverage: Annotated[float | None, SPARSE] = None
    wrong_walls: Annotated[float | None, SPARSE] = None


@dataclass(frozen=True)
class Goal:
    """A place, in the robot's map frame, that the explorer sent it to, since when and until when."""

    set: float
    x: float
    y: float
    end: float | None = None
    outcome: str = ""
    text: str = ""
    id: int | None = None


@dataclass(frozen=True)
class Offer:
    """A cluster of frontiers: its middle in the map frame of the robot that offers it, {robot: bid} of those with a
    finite one, and the robot that explored it when the auction was over, empty: none."""

    x: float
    y: float
    bids: Mapping[str, float]
    explored_by: Annotated[str, SPARSE] = ""


@dataclass(frozen=True)
class Auction:
    """One that the robot opened, on so many clusters of frontiers. `offers`: what came of it, where that is known, with
    bids in `unit` (1: m^2, else the number of the strategy whose bids they are). `answered`: when bids of others came,
    {robot: s}; `decided`: when, None where that was not recorded."""

    at: float
    id: int | None = None
    clusters: int = 0
    unit: Annotated[int, SPARSE] = 0
    offers: Annotated[tuple[Offer, ...], SPARSE] = ()
    answered: Annotated[Mapping[str, float], SPARSE] = field(default_factory=dict)
    decided: Annotated[float | None, SPARSE] = None


@dataclass(frozen=True)
class Merge:
    """A robot has come to believe, or no longer believes (`transform` None), where another robot's map lies in its own.
    `offset`, `turn`: greatest displacement and turn against the truth; `kind`: right, imprecise or wrong; both and
    `right` are None where nobody has judged."""

    partner: Annotated[str, Key("with")]
    at: float
    transform: Pose | None
    offset: Annotated[float | None, SPARSE] = None
    turn: Annotated[float | None, SPARSE] = None
    kind: Annotated[str, Key("class"), SPARSE] = ""
    right: Annotated[bool | None, SPARSE] = None

    @property
    def accepted(self) -> bool:
        return self.transform is not None


@dataclass(frozen=True)
class RobotRecord:
    """`start`: true, world frame. `finished_at`: T_r. `distance`: until then. `moving`: share of the time with a task.
    `stalled`: s for which the simulator held it back. `merges`: None where the host does not see them."""

    start: Pose
    distance: float
    moving: float
    finished_at: float | None = None
    died_at: float | None = None
    state: str = ""
    stalled: float = 0.0
    collisions: Contacts = field(default_factory=Contacts)
    map: MapFigures = field(default_factory=MapFigures)
    radio: Mapping[str, Any] = field(default_factory=dict)
    counters: Mapping[str, int] = field(default_factory=dict)
    goals: tuple[Goal, ...] = ()
    auctions: tuple[Auction, ...] = ()
    merges: Annotated[tuple[Merge, ...] | None, SPARSE] = None
    series: RobotSeries = field(default_factory=RobotSeries)

    def __post_init__(self) -> None:
        for name in COUNTERS:
            count = self.radio.get(name, 0)
            if type(count) is not int or count < 0:
                raise ValueError(f"radio.{name} must be a whole number from 0 on, not {count!r}")

    @property
    def partners(self) -> tuple[str, ...]:
        """Robots whose maps it believes to have a place in its own, at the end."""
        believed = {merge.partner: merge.accepted for merge in self.merges or ()}
        return tuple(sorted(name for name, accepted in believed.items() if accepted))

    def sent(self, counter: str) -> int:
        """One of COUNTERS."""
        return int(self.radio.get(counter, 0))
