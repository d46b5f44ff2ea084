"""The course of one robot's mission, from what its monitor tells: samples and events, as the record has them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Iterable, Mapping, Sequence

import numpy as np

from mr_grid import Pose
from mr_measures.record.logs import CANCELLED, AuctionLog, GoalLog, NoteLog
from mr_measures.record.mission_record import Note
from mr_measures.record.robot_record import Auction, Goal, Merge, Offer
from mr_measures.record.series import RobotSeries

SERIES_PERIOD = 1.0  # s between two samples


TOLD = ("explored", "own", "bytes", "frames", "bids", "state", "neighbors")


@dataclass(frozen=True)
class Sample:
    """As the columns of `RobotSeries`."""

    time: float
    explored: float = 0.0
    own: float = 0.0
    bytes: int = 0
    frames: int = 0
    bids: int = 0
    state: int = 0
    neighbors: tuple[str, ...] = ()


class RobotLog:
    """Times as they come, in s of simulation time; what it gives counts from `start`, that of the mission. The length
    of a mission bounds the samples, the pace of an explorer the rest. What is no event is a note."""

    def __init__(self) -> None:
        self._samples: list[Sample] = []
        self._goals = GoalLog()
        self._auctions = AuctionLog()
        self._merges: list[Merge] = []
        self.poses: list[tuple[float, Pose]] = []  # where the robot believed to be, in its map, and when
        self._notes = NoteLog()
        self._former = Sample(0.0)  # counts of the starts before this one
        self._former_goals = 0

    def begin_anew(self, at: float) -> None:
        """The robot is started again, with another map: it drives nowhere, believes nothing and counts from zero."""
        self._goals.end(at, CANCELLED)
        believed = {one.partner: one.transform for one in self._merges}
        self._merges += [Merge(partner, at, None) for partner, place in believed.items() if place is not None]
        self._former = self._samples[-1] if self._samples else self._former
        self._former_goals = len(self._goals.goals)

    def take(self, sample: Sample, events: Iterable[Mapping[str, Any]]) -> None:
        # A clock that was wrong for one reading must not stop the series until the others have caught up.
        while self._samples and self._samples[-1].time > sample.time:
            self._samples.pop()
        if not self._samples or sample.time - self._samples[-1].time >= 0.5 * SERIES_PERIOD:
            sums = {name: getattr(sample, name) + getattr(self._former, name) for name in ("bytes", "frames", "bids")}
            self._samples.append(replace(sample, **sums))
        for event in events:
            try:
                self._happened(**event)
            except (KeyError, TypeError, ValueError) as error:
                text = f"an event that the monitor told is left out: {error!r}"
                self._notes.add(Note(sample.time, text=text, warning=True))

    def _happened(self, kind: str, at: float, **values: Any) -> None:
        if not _finite([at, *values.values()]):
            raise ValueError(f"{kind} with a number that is not finite")
        if kind == "goal":
            values["id"] += self._former_goals
            self._goals.begin(Goal(at, **values))
        elif kind == "goal_end":
            self._goals.end(at, **values)
        elif kind == "auction":
            self._auctions.begin(Auction(at, **values))
        elif kind == "auction_result":
            self._auctions.end(values["number"], at, values["unit"], [Offer(**offer) for offer in values["offers"]])
        elif kind == "answer":
            self._auctions.answer(values["number"], values["robot"], at)
        elif kind == "merge":
            place = values["transform"]
            self._merges.append(Merge(values["partner"], at, None if place is None else Pose(*place)))
        elif kind == "pose":
            self.poses.append((at, Pose(*values["place"])))
        elif kind == "note":
            self._notes.add(Note(at, **values))
        else:
            raise ValueError(f"{kind} is no kind of event")

    def goals(self, start: float) -> tuple[Goal, ...]:
        return tuple(
            replace(goal, set=_since(goal.set, start), end=None if goal.end is None else _since(goal.end, start))
            for goal in self._goals.goals
        )

    def auctions(self, start: float) -> tuple[Auction, ...]:
        return tuple(
            replace(
                one,
                at=_since(one.at, start),
                answered={robot: _since(at, start) for robot, at in one.answered.items()},
                decided=None if one.decided is None else _since(one.decided, start),
            )
            for one in self._auctions.auctions
        )

    def merges(self, start: float, robots: Sequence[str]) -> tuple[Merge, ...]:
        """Of transforms to these robots."""
        return tuple(replace(one, at=_since(one.at, start)) for one in self._merges if one.partner in robots)

    def notes(self, start: float, robot: str) -> tuple[Note, ...]:
        return tuple(replace(note, at=_since(note.at, start), robot=robot) for note in self._notes.notes)

    def samples_at(self, times: np.ndarray) -> list[Sample]:
        """What was told last at each of the times."""
        latest = np.searchsorted([sample.time for sample in self._samples], times, side="right") - 1
        return [self._samples[index] if index >= 0 else Sample(0.0) for index in latest]

    def series(self, start: float, motion: np.ndarray) -> RobotSeries:
        """`motion`: true, as in `mr_measures.motion`, times since the start. At each second what was told last."""
        if not motion.size:
            return RobotSeries()
        moments = np.arange(0.0, float(motion["time"][-1]) + 1e-9, SERIES_PERIOD)
        rows = np.minimum(np.searchsorted(motion["time"], moments), len(motion) - 1)
        samples = self.samples_at(motion["time"][rows] + start)
        columns: dict[str, Any] = {name: tuple(getattr(sample, name) for sample in samples) for name in TOLD}
        return RobotSeries(**{**_motion_columns(motion, rows), **columns})


def _finite(values: Iterable[Any]) -> bool:
    """Of all numbers in them, and in lists and mappings of them."""
    return all(_finite_within(value) for value in values)


def _finite_within(value: Any) -> bool:
    if isinstance(value, Mapping):
        return _finite(value.values())
    return _finite(value) if isinstance(value, list) else not isinstance(value, float) or math.isfinite(value)


def _since(at: float, start: float) -> float:
    return round(max(0.0, at - start), 4)


def _motion_columns(motion: np.ndarray, rows: np.ndarray) -> dict[str, tuple[float, ...]]:
    steps = np.diff(motion["time"], prepend=motion["time"][:1])
    way = np.hypot(np.diff(motion["x"], prepend=motion["x"][:1]), np.diff(motion["y"], prepend=motion["y"][:1]))
    columns = {
        **{name: motion[name] for name in ("time", "x", "y", "yaw")},
        "distance": np.cumsum(way),
        "stalled": np.cumsum(steps * (motion["stalled"] > 0)),
    }
    return {name: tuple(values[rows].astype(float).round(4).tolist()) for name, values in columns.items()}
