"""Records of missions, read from a folder and grouped by what can be compared."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Callable, Iterable, Mapping, TypeVar

from mr_experiments.report.stack_missions import begun_missions, failed_by_note, is_of_stack
from mr_measures.record.files import STACK_RECORD, RecordError, read_record
from mr_measures.record.mission_record import BIAS, STATUSES, Asked, MissionRecord
from mr_sim.world_names import name_of, told_here
from mr_sim.worlds import label_of

_Key = TypeVar("_Key")

MOST_TOLD = 5  # of the values of a setting that differs


@dataclass(frozen=True)
class Group:
    """Trials that differ in nothing but their seed."""

    world: str
    scenario: str
    strategy: int
    robots: int
    odometry: str = BIAS

    @classmethod
    def of(cls, record: MissionRecord) -> Group:
        asked = record.asked
        return cls(asked.world, asked.scenario, asked.strategy, asked.robots, asked.odometry)

    @property
    def chapter(self) -> Chapter:
        return Chapter(self.world, self.scenario, self.strategy, self.odometry)


@dataclass(frozen=True)
class Chapter:
    """Trials that differ in nothing but team size and seed: what one table or figure of the paper shows."""

    world: str
    scenario: str
    strategy: int
    odometry: str = BIAS

    @property
    def title(self) -> str:
        odometry = "" if self.odometry == BIAS else f", odometry {self.odometry}"
        return f"{self._label}, scenario {self.scenario}, strategy {self.strategy}{odometry}"

    @property
    def _label(self) -> str:
        """Files in two folders may have one name."""
        world = told_here(self.world)
        return world if "/" in world else label_of(world)

    @property
    def slug(self) -> str:
        """Name for files and anchors."""
        odometry = "" if self.odometry == BIAS else f"-{self.odometry}"
        return re.sub(r"[^\w.-]", "_", f"{self._label}-{self.scenario}-{self.strategy}{odometry}")


@dataclass(frozen=True)
class RecordSet:
    """Records of one folder, in the order of group and seed. `lost`: missions that were begun and of which nothing is
    known, not even what was asked for."""

    folder: Path
    records: tuple[MissionRecord, ...] = field(repr=False)
    lost: tuple[str, ...] = ()

    @property
    def groups(self) -> dict[Group, list[MissionRecord]]:
        return grouped(self.records, Group.of)

    @property
    def chapters(self) -> dict[Chapter, dict[int, list[MissionRecord]]]:
        """Records by chapter and team size."""
        chapters = grouped(self.records, lambda record: Group.of(record).chapter)
        return {key: grouped(records, lambda record: record.asked.robots) for key, records in chapters.items()}

    @property
    def counts(self) -> dict[str, int]:
        return count_outcomes(self.records)

    def mixed_settings(self) -> list[str]:
        """Sentences on what differs within a group although it should be equal: settings and versions."""
        sentences = []
        for group, records in self.groups.items():
            where = f"{group.chapter.title}, R = {group.robots}"
            for what, values in (
                ("setting", [r.asked.settings for r in records]),
                ("version", [r.versions for r in records]),
            ):
                for name in sorted({key for value in values for key in value} - {"seed"}):
                    # What is noted of an attempt without a record says little.
                    shared = [_comparable(name, value[name]) for value in values if name in value]
                    found = sorted({json.dumps(value, sort_keys=True) for value in shared})
                    if len(found) > 1:
                        told = ", ".join(found[:MOST_TOLD]) + ", ..." * (len(found) > MOST_TOLD)
                        sentences.append(f"{where}: {what} {name} is not the same in all trials ({told})")
        return sentences


def _comparable(name: str, value: Any) -> Any:
    """Of a setting, what is the same for all trials of a scenario: when robots die it draws from the seed."""
    return len(value) if name == "deaths" and isinstance(value, Mapping) else value


def grouped(records: Iterable[MissionRecord], key: Callable[[MissionRecord], _Key]) -> dict[_Key, list[MissionRecord]]:
    """Records by key, in the order in which the keys come."""
    groups: dict[_Key, list[MissionRecord]] = {}
    for record in records:
        groups.setdefault(key(record), []).append(record)
    return groups


def count_outcomes(records: Iterable[MissionRecord]) -> dict[str, int]:
    """Number of trials by status; each status has an entry."""
    found = [record.outcome.status for record in records]
    return {status: found.count(status) for status in STATUSES}


def load_records(folder: str | Path) -> RecordSet:
    """Every `*.json` of a folder, or every mission of the ROS stack that was begun below it; one without a record has
    failed. Raises RecordError for no records, a broken one or one that is there twice."""
    folder = Path(folder)
    if not folder.is_dir():
        raise RecordError(f"{folder} is no folder; give the folder into which the trials were written")
    if is_of_stack(folder):
        refuse_both_kinds(folder)
        found = _of_stack(folder)
    else:
        found = {path: load_record(path) for path in sorted(folder.glob("*.json"))}
    if not found:
        raise RecordError(
            f"{folder} holds no records (*.json) and no missions of rosrun mr_launch team ({STACK_RECORD})"
        )
    records = {path: record for path, record in found.items() if record is not None}
    refuse_doubles(records)
    lost = tuple(str(path) for path, record in found.items() if record is None)
    return RecordSet(folder, tuple(sorted(records.values(), key=_order)), lost)


def refuse_both_kinds(folder: Path) -> None:
    """Of a folder with missions of the ROS stack below it. Raises RecordError if it holds others as well."""
    others = [path for path in sorted(folder.glob("*.json")) if path.name != STACK_RECORD and _holds_record(path)]
    if others:
        raise RecordError(
            f"{folder} holds records of trials, as {others[0].name}, and missions of the ROS stack below it: they do "
            "not count together; move one kind to a folder of its own"
        )


def _holds_record(path: Path) -> bool:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return is_record(document)


def is_record(document: Any) -> bool:
    """Whether a JSON document is meant for the record of a mission."""
    return isinstance(document, Mapping) and "trial" in document


def _of_stack(folder: Path) -> dict[Path, MissionRecord | None]:
    """None for a mission of which nothing is known."""
    found: dict[Path, MissionRecord | None] = {}
    for path, note in begun_missions(folder).items():
        record = path / STACK_RECORD
        if record.exists():
            found[record] = load_record(record)
        else:
            found[path] = failed_by_note(note)
    return found


def load_record(path: Path) -> MissionRecord:
    """Without its snapshots, which are large, and with the one name of its world. Raises RecordError."""
    try:
        record = read_record(path)
    except RecordError as error:
        text = f"{error}; take it out of the folder, which is to hold whole records and nothing else"
        raise RecordError(text) from None
    asked = Asked({**record.asked.settings, "world": name_of(record.asked.world)})
    return replace(record, asked=asked, snapshots=())


def _order(record: MissionRecord) -> tuple[str, str, int, int, int]:
    asked = record.asked
    return asked.world, asked.scenario, asked.strategy, asked.robots, asked.seed


def refuse_doubles(records: Mapping[Path, MissionRecord]) -> None:
    """A mission that failed may have been tried again. Raises RecordError."""
    seen: dict[tuple[Group, int], Path] = {}
    for path, record in records.items():
        if record.failed:
            continue
        other = seen.setdefault((Group.of(record), record.asked.seed), path)
        if other != path:
            raise RecordError(f"{path} and {other} record the same trial; remove one of them")
