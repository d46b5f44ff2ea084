"""The record of one mission, whichever host ran it. Lengths in m, times in s since the start of the mission."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from mr_measures.map_picture import Picture
from mr_measures.record.json_form import Key, Written
from mr_measures.record.robot_record import RobotRecord
from mr_measures.record.series import TeamSeries

SPARSE = Written.UNLESS_DEFAULT
SCHEMA = 2
"""Version of the form in which records are written."""
READABLE = (1, SCHEMA)
"""Versions that are read; others are refused. What 1 does not say has a default."""
STACK = "ros_stack"
"""Scenario of missions of the ROS stack."""
BIAS = "bias"
"""Odometry that errs by one share for the whole mission."""
FINISHED, UNFINISHED, FAILED = STATUSES = ("finished", "unfinished", "failed")


@dataclass(frozen=True)
class Asked:
    """What was asked for; `settings`: all of it, with whatever the host has beside what is named here."""

    settings: Annotated[Mapping[str, Any], Written.AS_WHOLE]

    def __post_init__(self) -> None:
        for name in ("world", "scenario"):
            if not (isinstance(self.settings.get(name), str) and self.settings[name]):
                raise ValueError(f"{name} is missing or no text")
        for name, least in (("robots", 1), ("seed", None), ("strategy", None)):
            value = self.settings.get(name)
            if type(value) is not int or (least is not None and value < least):
                raise ValueError(f"{name} must be a whole number{'' if least is None else f' from {least} on'}")

    @property
    def world(self) -> str:
        return str(self.settings["world"])

    @property
    def scenario(self) -> str:
        return str(self.settings["scenario"])

    @property
    def robots(self) -> int:
        return int(self.settings["robots"])

    @property
    def seed(self) -> int:
        return int(self.settings["seed"])

    @property
    def strategy(self) -> int:
        return int(self.settings["strategy"])

    @property
    def odometry(self) -> str:
        """How it errs; records that do not say it are of the constant bias."""
        return str(self.settings.get("odometry", BIAS))

    @property
    def limit(self) -> float | None:
        return self.settings.get("limit")

    @property
    def fast(self) -> bool:
        return bool(self.settings.get("fast", False))


@dataclass(frozen=True)
class Outcome:
    """`status`: one of STATUSES; `time`: at which the mission ended; `reason`: why it did not finish."""

    status: str
    time: float
    reason: str = ""
    traceback: Annotated[str, SPARSE] = ""

    def __post_init__(self) -> None:
        if self.status not in STATUSES:
            raise ValueError(f"status is {self.status!r}, not one of {', '.join(STATUSES)}")


@dataclass(frozen=True)
class Team:
    """`exploration_time`: T, None unless the mission finished; `overlap`: between robots; `trace`: a hash of all frames
    and their times."""

    exploration_time: float | None = None
    overlap: float | None = None
    series: TeamSeries = field(default_factory=TeamSeries)
    trace: Annotated[str, SPARSE] = ""


@dataclass(frozen=True)
class RobotMaps:
    """Last maps of a robot."""

    merged: Annotated[Picture | None, Key("global"), SPARSE] = None
    local: Annotated[Picture | None, SPARSE] = None


@dataclass(frozen=True)
class Snapshot:
    """The global map of a robot on the way."""

    time: float
    robot: str
    png: str
    resolution: float
    origin: tuple[float, float]

    @classmethod
    def of(cls, time: float, robot: str, picture: Picture) -> Snapshot:
        return cls(time, robot, picture.png, picture.resolution, picture.origin)

    @property
    def picture(self) -> Picture:
        return Picture(self.png, self.resolution, self.origin)


@dataclass(frozen=True)
class Note:
    """What a robot's node would have logged, or its host."""

    at: float
    robot: str = ""
    text: str = ""
    warning: bool = False


@dataclass(frozen=True)
class Measured:
    """About the computer: the only part that differs between two runs. Wall and processor time in s; None: unknown.
    `cpu_by_host`: where each robot has processes of its own, processor time by robot and process."""

    wall: float | None = None
    cpu: float | None = None
    real_time_factor: float | None = None
    cpu_by_component: Mapping[str, float] = field(default_factory=dict)
    host: Annotated[str, SPARSE] = ""
    started: Annotated[str, SPARSE] = ""
    cpu_by_host: Annotated[Mapping[str, Mapping[str, float]], SPARSE] = field(default_factory=dict)


@dataclass(frozen=True)
class MissionRecord:
    """`asked`, in JSON `trial`: every setting of the mission; `versions`: of what it depends on; `robots`, `maps`: by
    the robots' names; `restarts`: how often which node of which robot or base was started again."""

    asked: Annotated[Asked, Key("trial")]
    outcome: Outcome
    team: Team = field(default_factory=Team)
    robots: Mapping[str, RobotRecord] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    maps: Mapping[str, RobotMaps] = field(default_factory=dict)
    snapshots: tuple[Snapshot, ...] = ()
    notes: tuple[Note, ...] = ()
    measured: Annotated[Measured, SPARSE] = field(default_factory=Measured)
    restarts: Annotated[Mapping[str, Mapping[str, int]], SPARSE] = field(default_factory=dict)

    def __post_init__(self) -> None:
        status, time = self.outcome.status, self.team.exploration_time
        if (time is None) == (status == FINISHED):
            raise ValueError(f"outcome.status is {status}, but team.exploration_time is {time}")
        if len(self.robots) != self.asked.robots and status != FAILED:
            raise ValueError(f"robots: it has {len(self.robots)} robots, but the trial asked for {self.asked.robots}")

    @property
    def finished(self) -> bool:
        return self.outcome.status == FINISHED

    @property
    def failed(self) -> bool:
        return self.outcome.status == FAILED

    @property
    def code(self) -> str:
        """That made it; empty if it does not say."""
        return self.versions.get("code", "")

    @property
    def survivors(self) -> dict[str, RobotRecord]:
        """Robots that did not die."""
        return {name: robot for name, robot in self.robots.items() if robot.died_at is None}

    @property
    def distance(self) -> float:
        """Of all robots."""
        return sum(robot.distance for robot in self.robots.values())

    @property
    def final_coverage(self) -> float | None:
        """What the team knew together at the end."""
        return self.team.series.coverage[-1] if self.team.series.coverage else None

    @property
    def merges_recorded(self) -> bool:
        """Whether the host saw what robots believed of each other."""
        return not self.robots or any(robot.merges is not None for robot in self.robots.values())

    @property
    def merges_judged(self) -> bool:
        """Whether it is known which of them were right."""
        entries = [merge for robot in self.robots.values() for merge in robot.merges or () if merge.accepted]
        return self.merges_recorded and all(merge.right is not None for merge in entries)

    @property
    def packets_by_hops(self) -> dict[int, int]:
        """Packets that all robots received, by the number of hops they took."""
        total: dict[int, int] = {}
        for robot in self.robots.values():
            for hops, count in enumerate(robot.radio.get("packets_received_by_hops", ()), start=1):
                total[hops] = total.get(hops, 0) + count
        return {hops: count for hops, count in sorted(total.items()) if count}

    @property
    def map_errors(self) -> tuple[float, ...]:
        """Percent, of every robot's map that has a reference."""
        return tuple(robot.map.error for robot in self.robots.values() if robot.map.error is not None)
