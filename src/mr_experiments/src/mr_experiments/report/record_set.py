"""Records of trials: read from a folder, checked once, grouped by what can be compared."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable, Iterable, Mapping, NoReturn, Sequence, TypeVar

import numpy as np

from mr_grid import Pose
from mr_sim.worlds import label_of

FORMAT = 1
STACK_RECORD = "record.json"  # in the output folder of a mission of the ROS stack
FINISHED, UNFINISHED, FAILED = "finished", "unfinished", "failed"
STATUSES = (FINISHED, UNFINISHED, FAILED)

_Key = TypeVar("_Key")


class RecordError(ValueError):
    """A record or a folder of records that cannot be used; the text names the file and what is wrong with it."""


@dataclass(frozen=True)
class Group:
    """Trials that differ in nothing but their seed."""

    world: str
    scenario: str
    strategy: int
    robots: int

    @property
    def chapter(self) -> Chapter:
        return Chapter(self.world, self.scenario, self.strategy)


@dataclass(frozen=True)
class Chapter:
    """Trials that differ in nothing but team size and seed: what one table or figure of the paper shows."""

    world: str
    scenario: str
    strategy: int

    @property
    def title(self) -> str:
        return f"{label_of(self.world)}, scenario {self.scenario}, strategy {self.strategy}"

    @property
    def slug(self) -> str:
        """Name for files and anchors."""
        return re.sub(r"[^\w.-]", "_", f"{label_of(self.world)}-{self.scenario}-{self.strategy}")


@dataclass(frozen=True)
class Merge:
    """One decision of a robot on the transform to another robot's map; `accepted` is false when it was revoked."""

    partner: str
    at: float
    accepted: bool
    right: bool


@dataclass(frozen=True)
class RobotRecord:
    """One robot of a trial. Lengths in m, times in s since the start of the mission."""

    name: str
    start: Pose  # true, in the world frame
    finished_at: float | None
    distance: float
    moving: float
    collisions: tuple[int, int]  # with walls, with robots
    map_error: float | None  # percent; None without a map or without a reference
    bytes_sent: int
    frames_sent: int
    packets_sent: int
    packets_failed: int
    merges: tuple[Merge, ...]


@dataclass(frozen=True)
class Progress:
    """What the team knew over time: three arrays (N,): s, m^2 of the union of all maps, share of reference cells."""

    time: np.ndarray
    explored: np.ndarray
    coverage: np.ndarray


@dataclass(frozen=True)
class Record:
    """One trial."""

    path: Path
    group: Group
    seed: int
    settings: Mapping[str, Any]  # everything asked for
    versions: Mapping[str, str]
    status: str
    reason: str
    time: float  # at which the mission ended
    exploration_time: float | None
    overlap: float | None
    progress: Progress
    robots: tuple[RobotRecord, ...]
    measured: Mapping[str, Any]
    merges_recorded: bool = True  # missions of the ROS stack have none

    @property
    def finished(self) -> bool:
        return self.status == FINISHED

    @property
    def failed(self) -> bool:
        return self.status == FAILED

    @property
    def distance(self) -> float:
        """Metres driven by all robots."""
        return sum(robot.distance for robot in self.robots)

    @property
    def map_errors(self) -> list[float]:
        """e in percent of every robot's map that has a reference."""
        return [robot.map_error for robot in self.robots if robot.map_error is not None]

    @property
    def final_coverage(self) -> float | None:
        return float(self.progress.coverage[-1]) if self.progress.coverage.size else None


@dataclass(frozen=True)
class RecordSet:
    """Records of one folder, in the order of group and seed."""

    folder: Path
    records: tuple[Record, ...] = field(repr=False)

    @property
    def groups(self) -> dict[Group, list[Record]]:
        return grouped(self.records, lambda record: record.group)

    @property
    def chapters(self) -> dict[Chapter, dict[int, list[Record]]]:
        """Records by chapter and team size."""
        chapters = grouped(self.records, lambda record: record.group.chapter)
        return {key: grouped(records, lambda record: record.group.robots) for key, records in chapters.items()}

    @property
    def counts(self) -> dict[str, int]:
        return count_outcomes(self.records)

    def mixed_settings(self) -> list[str]:
        """Sentences on what differs within a group although it should be equal: settings and versions."""
        sentences = []
        for group, records in self.groups.items():
            where = f"{group.chapter.title}, R = {group.robots}"
            for what, values in (
                ("setting", [r.settings for r in records]),
                ("version", [r.versions for r in records]),
            ):
                for name in sorted({key for value in values for key in value} - {"seed"}):
                    found = sorted({json.dumps(value.get(name), sort_keys=True) for value in values})
                    if len(found) > 1:
                        sentences.append(f"{where}: {what} {name} is not the same in all trials ({', '.join(found)})")
        return sentences


def grouped(records: Iterable[Record], key: Callable[[Record], _Key]) -> dict[_Key, list[Record]]:
    """Records by key, in the order in which the keys come."""
    groups: dict[_Key, list[Record]] = {}
    for record in records:
        groups.setdefault(key(record), []).append(record)
    return groups


def count_outcomes(records: Iterable[Record]) -> dict[str, int]:
    """Number of trials by status; each status has an entry."""
    found = [record.status for record in records]
    return {status: found.count(status) for status in STATUSES}


def load_records(folder: str | Path) -> RecordSet:
    """Every `*.json` of a folder, or the `record.json` of every mission of the ROS stack below it. Raises RecordError
    for no records, a broken one or one that is there twice."""
    folder = Path(folder)
    if not folder.is_dir():
        raise RecordError(f"{folder} is no folder; give the folder into which the trials were written")
    missions = sorted(folder.glob(f"**/{STACK_RECORD}"))
    paths = missions or sorted(folder.glob("*.json"))
    if not paths:
        raise RecordError(
            f"{folder} holds no records (*.json) and no missions of rosrun mr_launch team ({STACK_RECORD})"
        )
    records = [load_record(path) for path in paths]
    _refuse_doubles(records)
    return RecordSet(folder, tuple(sorted(records, key=_order)))


def _order(record: Record) -> tuple[str, str, int, int, int]:
    group = record.group
    return group.world, group.scenario, group.strategy, group.robots, record.seed


def _refuse_doubles(records: Sequence[Record]) -> None:
    seen: dict[tuple[Group, int], Path] = {}
    for record in records:
        other = seen.setdefault((record.group, record.seed), record.path)
        if other != record.path:
            raise RecordError(f"{record.path} and {other} record the same trial; remove one of them")


def load_record(path: Path) -> Record:
    """One record, without its maps. Raises RecordError."""
    reader = _Reader(path, read_document(path))
    group = Group(
        world=reader.text("trial", "world"),
        scenario=reader.text("trial", "scenario"),
        strategy=reader.whole("trial", "strategy"),
        robots=reader.whole("trial", "robots", least=1),
    )
    status = reader.text("outcome", "status")
    if status not in STATUSES:
        reader.fail(f"outcome.status is {status!r}, not one of {', '.join(STATUSES)}")
    robots = tuple(_read_robot(reader, name) for name in reader.mapping("robots"))
    if len(robots) != group.robots and status != FAILED:
        reader.fail(f"it has {len(robots)} robots, but the trial asked for {group.robots}")
    exploration_time = reader.number_or_none("team", "exploration_time")
    if (exploration_time is None) == (status == FINISHED):
        reader.fail(f"outcome.status is {status}, but team.exploration_time is {exploration_time}")
    return Record(
        path=path,
        group=group,
        seed=reader.whole("trial", "seed"),
        settings=reader.mapping("trial"),
        versions=reader.mapping("versions"),
        status=status,
        reason=str(reader.get("outcome", "reason", default="")),
        time=reader.number("outcome", "time"),
        exploration_time=exploration_time,
        overlap=reader.number_or_none("team", "overlap"),
        progress=_read_progress(reader),
        robots=robots,
        measured=reader.mapping("measured"),
        merges_recorded=not robots or any(reader.get("robots", robot.name, "merges") is not None for robot in robots),
    )


def read_document(path: Path) -> dict[str, Any]:
    """The whole JSON document of a record, maps included. Raises RecordError unless its format is known."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise RecordError(f"{path} cannot be read as JSON: {error}") from None
    if not isinstance(document, dict) or "format" not in document:
        raise RecordError(f"{path} is no record of a trial: it has no format number")
    if document["format"] != FORMAT:
        raise RecordError(f"{path} has format {document['format']!r}; this version reads format {FORMAT}")
    return document


def _read_robot(reader: _Reader, name: str) -> RobotRecord:
    def count(*keys: str) -> int:
        return reader.whole("robots", name, *keys, default=0, least=0)

    start = reader.numbers("robots", name, "start")
    if start.shape != (3,):
        reader.fail(f"robots.{name}.start must be x, y, yaw")
    return RobotRecord(
        name=name,
        start=Pose(*start.tolist()),
        finished_at=reader.number_or_none("robots", name, "finished_at"),
        distance=reader.number("robots", name, "distance"),
        moving=reader.number("robots", name, "moving"),
        collisions=(count("collisions", "walls"), count("collisions", "robots")),
        map_error=reader.number_or_none("robots", name, "map", "error"),
        bytes_sent=count("radio", "bytes_sent"),
        frames_sent=count("radio", "frames_sent"),
        packets_sent=count("radio", "packets_sent"),
        packets_failed=count("radio", "packets_failed"),
        merges=tuple(_read_merge(reader, name, entry) for entry in reader.entries("robots", name, "merges")),
    )


def _read_merge(reader: _Reader, robot: str, entry: Any) -> Merge:
    try:
        return Merge(str(entry["with"]), float(entry["at"]), entry["transform"] is not None, bool(entry.get("right")))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        reader.fail(f"robots.{robot}.merges has an entry that is not understood ({error!r})")


def _read_progress(reader: _Reader) -> Progress:
    names = ("time", "explored", "coverage")
    time, explored, coverage = (reader.numbers("team", "series", name) for name in names)
    if not time.shape == explored.shape == coverage.shape:
        reader.fail("team.series.time, explored and coverage differ in length")
    if (np.diff(time) < 0.0).any():
        reader.fail("team.series.time goes back")
    return Progress(time, explored, coverage)


class _Reader:
    """Checked access to one document. A key that is absent or null reads as the default."""

    def __init__(self, path: Path, document: Mapping[str, Any]) -> None:
        self.path = path
        self.document = document

    def fail(self, message: str) -> NoReturn:
        raise RecordError(f"{self.path}: {message}")

    def get(self, *keys: str, default: Any = None) -> Any:
        value: Any = self.document
        for key in keys:
            if not isinstance(value, Mapping):
                return default
            value = value.get(key)
        return default if value is None else value

    def mapping(self, *keys: str) -> Mapping[str, Any]:
        value = self.get(*keys, default={})
        if not isinstance(value, Mapping):
            self.fail(f"{'.'.join(keys)} must be an object")
        return value

    def entries(self, *keys: str) -> Sequence[Any]:
        value = self.get(*keys, default=[])
        if not isinstance(value, list):
            self.fail(f"{'.'.join(keys)} must be a list")
        return value

    def text(self, *keys: str) -> str:
        value = self.get(*keys)
        if not isinstance(value, str) or not value:
            self.fail(f"{'.'.join(keys)} is missing or no text")
        return value

    def number_or_none(self, *keys: str) -> float | None:
        value = self.get(*keys)
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            self.fail(f"{'.'.join(keys)} must be a finite number, not {value!r}")
        return float(value)

    def number(self, *keys: str) -> float:
        value = self.number_or_none(*keys)
        if value is None:
            self.fail(f"{'.'.join(keys)} is missing")
        return value

    def whole(self, *keys: str, default: int | None = None, least: float = -math.inf) -> int:
        value = self.get(*keys, default=default)
        if isinstance(value, bool) or not isinstance(value, int) or value < least:
            self.fail(f"{'.'.join(keys)} must be a whole number{'' if least == -math.inf else f' from {least} on'}")
        return value

    def numbers(self, *keys: str) -> np.ndarray:
        """Array (N,); empty where nothing is recorded."""
        try:
            values = np.array(self.get(*keys, default=[]), dtype=float)
        except (TypeError, ValueError):
            self.fail(f"{'.'.join(keys)} must be a list of numbers")
        if values.ndim != 1 or not np.isfinite(values).all():
            self.fail(f"{'.'.join(keys)} must be a list of finite numbers")
        return values
