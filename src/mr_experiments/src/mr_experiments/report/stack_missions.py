"""Missions of the whole ROS stack: which were begun, and what became of each."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mr_measures.record.files import STACK_RECORD, RecordError, read_record
from mr_measures.record.mission_record import FAILED, STACK, Asked, MissionRecord, Outcome
from mr_sim.world_names import name_of
from mr_sim.worlds import label_of

ATTEMPTS = "attempts.jsonl"
"""One row for each mission that was begun, written before it, so that none is lost, however it ends."""
NO_RECORD = "no record"  # it did not get as far as to write one
STRATEGY = 7  # of `rosrun mr_launch team`


@dataclass(frozen=True)
class Attempt:
    """A mission that was begun, in the ROS stack or in virtual time. What is not known of it is empty or None."""

    name: str
    world: str
    robots: int | None
    seed: int | None
    status: str  # of the record, or NO_RECORD
    time: float | None = None  # T in s
    errors: tuple[float, ...] = ()  # percent, of every map
    code: str = ""  # code_version
    commit: str = ""

    @classmethod
    def of(cls, name: str, record: MissionRecord, commit: str = "") -> Attempt:
        asked = record.asked
        return cls(
            name, label_of(asked.world), asked.robots, asked.seed, record.outcome.status, record.team.exploration_time,
            record.map_errors, record.code, commit,
        )  # fmt: skip


def begin_attempt(folder: Path, world: str, robots: int, seed: int, code: str, commit: str) -> Path:
    """Notes in a folder that a mission begins, and returns where its output belongs, where nothing is yet."""
    folder.mkdir(parents=True, exist_ok=True)
    begun = _begun(folder / ATTEMPTS)
    first = f"{label_of(world)}-{robots}-{seed}"
    names = (first if number == 1 else f"{first}.{number}" for number in range(1, len(begun) + 2))
    name = next(name for name in names if name not in begun and not (folder / name).exists())
    asked = {"world": world, "robots": robots, "seed": seed, "strategy": STRATEGY}
    with (folder / ATTEMPTS).open("a", encoding="utf-8") as file:
        file.write(json.dumps({"folder": name, **asked, "code": code, "commit": commit}) + "\n")
    return folder / name


def is_of_stack(folder: Path) -> bool:
    """Whether missions of the ROS stack were begun below it."""
    return any(next(folder.glob(f"**/{name}"), None) for name in (STACK_RECORD, ATTEMPTS))


def begun_missions(folder: Path) -> dict[Path, Mapping[str, Any]]:
    """The folder of every mission that was begun below a folder with what was noted of it: those noted there, and the
    output folders of `rosrun mr_launch team`. Raises RecordError if there is none."""
    notes = {path.parent / name: row for path in folder.glob(f"**/{ATTEMPTS}") for name, row in _begun(path).items()}
    recorded = {path.parent for path in folder.glob(f"**/{STACK_RECORD}")}
    begun = {path.parent for path in folder.glob("**/logs") if path.is_dir()}
    found = sorted(recorded | notes.keys() | begun)
    missions = [path for path in found if not any(parent in found for parent in path.parents)]
    if not missions:
        raise RecordError(f"{folder} holds no {STACK_RECORD} of rosrun mr_launch team")
    return {path: notes.get(path, {}) for path in missions}


def read_attempts(folder: Path) -> list[Attempt]:
    """Every mission that was begun below a folder. Raises RecordError if there is none or one cannot be read."""
    return [_attempt(path, path.relative_to(folder).as_posix(), note) for path, note in begun_missions(folder).items()]


def failed_by_note(note: Mapping[str, Any]) -> MissionRecord | None:
    """What is to be counted for a mission that left no record; None if too little was noted of it."""
    settings = {name: note.get(name) for name in ("world", "robots", "seed")}
    settings.update({name: note[name] for name in ("odometry",) if name in note})
    try:
        asked = Asked({**settings, "scenario": STACK, "strategy": note.get("strategy", STRATEGY)})
    except ValueError:
        return None
    asked = Asked({**asked.settings, "world": name_of(asked.world)})
    return MissionRecord(asked, Outcome(FAILED, 0.0, "it left no record"), versions={"code": str(note.get("code", ""))})


def _begun(path: Path) -> dict[str, Mapping[str, Any]]:
    """Rows of a file of attempts by the name of their folder; none if it is not there."""
    try:
        rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []
        return {str(row["folder"]): row for row in rows}
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise RecordError(f"{path} is no list of attempts: {error!r}") from None


def _attempt(path: Path, name: str, note: Mapping[str, Any]) -> Attempt:
    code, commit = str(note.get("code", "")), str(note.get("commit", ""))
    if (path / STACK_RECORD).exists():
        return Attempt.of(name, read_record(path / STACK_RECORD), commit)
    robots = note.get("robots") or len([place for place in path.glob("robot_*") if place.is_dir()]) or None
    world = label_of(str(note.get("world", "")))
    return Attempt(name, world, robots, note.get("seed"), NO_RECORD, code=code, commit=commit)
