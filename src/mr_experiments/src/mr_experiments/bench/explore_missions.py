"""Missions in generated worlds that nothing was tuned on, and what is kept of each: a row in a file of JSON lines."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, Iterator, Mapping, Sequence

import numpy as np

from mr_experiments.bench.mishaps import contacts, far_from_home
from mr_experiments.trial.bound import bound_of
from mr_experiments.trial.trial import Trial
from mr_experiments.trial.trial_world import world_of
from mr_measures import lower_bound, truth, visibility
from mr_measures.record.mission_record import MissionRecord
from mr_measures.record.series import TeamSeries
from mr_plans import WORLD_KINDS, worlds
from mr_sim import world as simulation

KINDS = ("office", "equalrooms", "hall", "cave", "loop")
SHORTEST_M, LONGEST_M = 15, 50
DEPTHS = 0.5, 0.8  # of the length
SCENARIO, FAST_SCENARIO = "explore", "explore_fast"
OFFICE, OFFICE_TRIALS = "office26x15", 4
LIMIT = 3600.0  # s of virtual time
KNOWN = 0.99  # share of the reference cells after which a mission only finishes off


def world_name(seed: int, kinds: Sequence[str] = KINDS) -> str:
    """The kinds take turns; the size is drawn from the seed, in whole metres."""
    kind = kinds[seed % len(kinds)]
    random = np.random.default_rng([seed, 15])
    length = int(random.integers(SHORTEST_M, LONGEST_M + 1))
    depth = max(WORLD_KINDS[kind].shallowest, round(length * random.uniform(*DEPTHS)))
    return f"generated:{kind}:{seed}:{length:g}x{depth:g}"


def trials_of(seeds: Sequence[int], robots: Sequence[int], strategies: Sequence[int], limit: float) -> list[Trial]:
    """World by world, so that a part of them already compares team sizes and strategies."""
    return [
        Trial(world_name(seed), size, seed, SCENARIO, strategy, limit)
        for seed in seeds
        for strategy in strategies
        for size in robots
    ]


def fast_trials_of(seeds: Sequence[int], robots: Sequence[int], strategy: int, limit: float) -> list[Trial]:
    """Missions in fast mode of the worlds of these seeds, and some of the office in both modes."""
    worlds = [
        *((world_name(seed), seed, True) for seed in seeds),
        *((OFFICE, seed, fast) for seed in seeds[:OFFICE_TRIALS] for fast in (False, True)),
    ]
    return [
        Trial(world, size, seed, FAST_SCENARIO if fast else SCENARIO, strategy, limit, fast)
        for world, seed, fast in worlds
        for size in robots
    ]


@dataclass(frozen=True)
class MissionRow:
    """One mission. `time`: T in s, None if it did not finish. `known_at`: s until the team knew 99 % of what can be
    known, None if it never did. `first_end`: s until the first robot ended. `coverage`: of each robot's final map.
    `contacts`: of all robots; `not_home`: robots that were not at the end. `code`: that ran it. `fast`: in fast
    mode."""

    world: str
    robots: int
    strategy: int
    seed: int
    limit: float
    code: str
    status: str
    reason: str
    time: float | None
    known_at: float | None
    first_end: float | None
    coverage: tuple[float, ...]
    wrong_walls: tuple[float, ...]
    distance: float  # m, of all robots
    contacts: int
    not_home: int
    fast: bool = False

    @property
    def key(self) -> tuple:
        """What was asked for."""
        return self.world, self.robots, self.strategy, self.seed, self.limit, self.fast


def key_of(trial: Trial) -> tuple:
    """As `MissionRow.key`."""
    return trial.world, trial.robots, trial.strategy, trial.seed, trial.limit, trial.fast


def row_of(record: MissionRecord) -> MissionRow:
    """What is kept of the record of a trial."""
    asked, robots = record.asked, list(record.robots.values())
    ends = [robot.finished_at for robot in robots if robot.finished_at is not None]
    return MissionRow(
        asked.world, asked.robots, asked.strategy, asked.seed, asked.limit or LIMIT, record.code,
        record.outcome.status, record.outcome.reason, record.team.exploration_time,
        _known_at(record.team.series), min(ends, default=None),
        tuple(robot.map.coverage or 0.0 for robot in robots),
        tuple(robot.map.wrong_walls or 0.0 for robot in robots),
        round(sum(robot.distance for robot in robots), 2), sum(contacts(record).values()), len(far_from_home(record)),
        asked.fast,
    )  # fmt: skip


def _known_at(series: TeamSeries) -> float | None:
    """Between two samples in proportion."""
    times, shares = np.array(series.time), np.array(series.coverage)
    reached = np.flatnonzero(shares >= KNOWN)
    if not reached.size:
        return None
    last = int(reached[0])
    if last == 0:
        return float(times[0])
    return round(float(np.interp(KNOWN, shares[last - 1 : last + 1], times[last - 1 : last + 1])), 2)


def append(path: Path, row: Mapping[str, Any]) -> None:
    """Adds a line."""
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(row, separators=(",", ":")) + "\n")


def read_rows(path: Path) -> list[MissionRow]:
    """Those of the file, none if there is no file; a line cut off by a crash is passed over."""
    names = {field.name for field in fields(MissionRow)}
    rows = (line for line in _lines(path) if names == line.keys())
    return [
        MissionRow(**{**row, "coverage": tuple(row["coverage"]), "wrong_walls": tuple(row["wrong_walls"])})
        for row in rows
    ]


def _lines(path: Path) -> Iterator[dict[str, Any]]:
    if not path.exists():
        return
    for line in path.read_text(encoding="utf-8").splitlines():
        try:
            values = json.loads(line)
        except ValueError:
            continue
        if isinstance(values, dict):
            yield values


def as_json(row: MissionRow) -> dict[str, Any]:
    """Plain values."""
    return asdict(row)


# --- bounds -----------------------------------------------------------------------------------------------------------

Bounds = dict  # world, robots -> s


def read_bounds(path: Path) -> Bounds:
    """Those that were computed by the present code."""
    version = _bound_version()
    return {(line["world"], line["robots"]): line["bound"] for line in _lines(path) if line.get("version") == version}


def bounds_of(world: str, robots: Sequence[int]) -> list[dict[str, Any]]:
    """A line for each team size: the time in s before which no such team has seen everything. Takes many seconds."""
    simulated = world_of(Trial(world, max(robots), 0))
    bound = bound_of(simulated)
    starts = [simulated.pose(number) for number in range(max(robots))]
    return [
        {"world": world, "robots": size, "bound": round(bound.completion_time(starts[:size]), 2),
         "version": _bound_version()}
        for size in robots
    ]  # fmt: skip


def _bound_version() -> str:
    """Changes with the code that draws worlds or bounds them."""
    files = [Path(str(module.__file__)) for module in (lower_bound, truth, visibility)]
    files += sorted(Path(str(simulation.__file__)).parent.glob("world*.py"))
    files += sorted(Path(str(worlds.__file__)).parent.glob("*.py"))
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:12]
