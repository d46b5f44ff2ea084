"""Missions of the whole ROS stack: which were begun, and what became of each."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping

from mr_measures.record.files import RecordError
from mr_measures.record.mission_record import FINISHED, UNFINISHED
from mr_sim.worlds import label_of

ATTEMPTS = "attempts.jsonl"
"""One row for each mission that was begun, written before it, so that none is lost, however it ends."""
NO_SUMMARY = "no summary"  # it crashed, hung or was stopped


@dataclass(frozen=True)
class Attempt:
    """A mission that was begun, in the ROS stack or in virtual time. What is not known of it is empty or None."""

    name: str
    world: str
    robots: int | None
    seed: int | None
    status: str  # FINISHED, UNFINISHED, NO_SUMMARY or, in virtual time, FAILED
    time: float | None = None  # T in s
    errors: tuple[float, ...] = ()  # percent, of every map
    code: str = ""  # code_version
    commit: str = ""


def begin_attempt(folder: Path, world: str, robots: int, seed: int, code: str, commit: str) -> Path:
    """Notes in a folder that a mission begins, and returns where its output belongs, where nothing is yet."""
    folder.mkdir(parents=True, exist_ok=True)
    begun = _begun(folder / ATTEMPTS)
    label = label_of(world)
    first = f"{label}-{robots}-{seed}"
    names = (first if number == 1 else f"{first}.{number}" for number in range(1, len(begun) + 2))
    name = next(name for name in names if name not in begun and not (folder / name).exists())
    row = {"folder": name, "world": label, "robots": robots, "seed": seed, "code": code, "commit": commit}
    with (folder / ATTEMPTS).open("a", encoding="utf-8") as file:
        file.write(json.dumps(row) + "\n")
    return folder / name


def read_attempts(folder: Path) -> list[Attempt]:
    """Every mission that was begun below a folder: those noted there, the output folders of `rosrun mr_launch team`
    with a summary.json, and those without one. Raises RecordError if there is none or one cannot be read."""
    notes = {path.parent / name: row for path in folder.glob(f"**/{ATTEMPTS}") for name, row in _begun(path).items()}
    with_summary = {path.parent for path in folder.glob("**/summary.json")}
    begun = {path.parent for path in folder.glob("**/logs") if path.is_dir()}
    found = sorted(with_summary | notes.keys() | begun)
    missions = [path for path in found if not any(parent in found for parent in path.parents)]
    if not missions:
        raise RecordError(f"{folder} holds no summary.json of rosrun mr_launch team")
    return [_attempt(path, path.relative_to(folder).as_posix(), notes.get(path, {})) for path in missions]


def _begun(path: Path) -> dict[str, Mapping[str, Any]]:
    """Rows of a file of attempts by the name of their folder; none if it is not there."""
    try:
        rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []
        return {str(row["folder"]): row for row in rows}
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise RecordError(f"{path} is no list of attempts: {error!r}") from None


def _attempt(path: Path, name: str, note: Mapping[str, Any]) -> Attempt:
    code, commit = str(note.get("code", "")), str(note.get("commit", ""))
    if not (path / "summary.json").exists():
        robots = note.get("robots") or len([place for place in path.glob("robot_*") if place.is_dir()]) or None
        return Attempt(name, str(note.get("world", "")), robots, note.get("seed"), NO_SUMMARY, code=code, commit=commit)
    try:
        summary = json.loads((path / "summary.json").read_text(encoding="utf-8"))
        time = summary["team"]["exploration_time"]
        errors = [robot.get("map_error") for robot in summary["robots"].values()]
        return Attempt(
            name, Path(summary.get("world", "")).stem, len(summary["robots"]), summary.get("options", {}).get("seed"),
            UNFINISHED if time is None else FINISHED, time, tuple(error for error in errors if error is not None),
            code, commit,
        )  # fmt: skip
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise RecordError(f"{path / 'summary.json'} is no summary of a mission: {error!r}") from None
