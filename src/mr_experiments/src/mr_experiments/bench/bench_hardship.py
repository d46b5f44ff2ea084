"""Whether teams finish, and how much later, when the radio is bad, robots die, or the floor is huge."""

from __future__ import annotations

import math
from typing import Sequence

import numpy as np

from mr_experiments.bench.bench_merging import row
from mr_experiments.bench.mishaps import contacts, far_from_home
from mr_experiments.bench.rows import Row
from mr_experiments.trial.scenario import load_scenario
from mr_experiments.trial.trial import Trial
from mr_measures.record.mission_record import MissionRecord

FREE = "paper"  # error-free radio
SHORT_RANGE = "range8"
HARDSHIPS = (FREE, "loss30", SHORT_RANGE, "killed", "partition")
TEAM = 4
LARGE, LARGE_TEAMS = "large", (4, 8)
RANGE_BAR = 1.2  # mean T with a radio of 8 m over that with an error-free one
MEAN_COVERAGE_BAR, WORST_COVERAGE_BAR = 0.999, 0.995


def trials_of(names: Sequence[str], seeds: Sequence[int], large_seeds: Sequence[int]) -> list[Trial]:
    """Of these scenarios; the large floor has seeds of its own."""
    scenarios = {name: load_scenario(name) for name in names}
    return [
        scenario.trial(size, 7, seed)
        for name, scenario in scenarios.items()
        for size in (LARGE_TEAMS if name == LARGE else (TEAM,))
        for seed in (large_seeds if name == LARGE else seeds)
    ]


def table(records: Sequence[MissionRecord]) -> list[Row]:
    """The rows that the records suffice for."""
    groups: dict[tuple[str, int], list[MissionRecord]] = {}
    for record in records:
        groups.setdefault((record.asked.scenario, record.asked.robots), []).append(record)
    rows = [made for (name, size), group in groups.items() for made in _rows_of(f"{name}, R = {size}", group)]
    free, short = (groups.get((name, TEAM), []) for name in (FREE, SHORT_RANGE))
    return [*rows, *_range_row(free, short)]


def _rows_of(what: str, records: Sequence[MissionRecord]) -> list[Row]:
    finished = [record for record in records if record.finished]
    late = ", ".join(f"seed {record.asked.seed}: {record.outcome.reason}" for record in records if not record.finished)
    rows = [
        row(f"{what}: missions that finished", "all", len(finished), f"of {len(records)}",
            len(finished) == len(records), late)
    ]  # fmt: skip
    times = _times(finished)
    shares = [robot.map.coverage or 0.0 for record in records for robot in record.survivors.values()]
    if times:
        detail = f"{min(times):.0f} to {max(times):.0f} s"
        if len(times) > 1:
            error = 1.96 * float(np.std(times, ddof=1)) / math.sqrt(len(times))
            detail = f"+- {error:.1f} s (95 %), {detail}"
        rows.append(row(f"{what}: mean T", "-", float(np.mean(times)), "s", True, detail))
    if shares:
        mean, worst = float(np.mean(shares)), min(shares)
        rows.append(row(f"{what}: coverage, mean", f">= {MEAN_COVERAGE_BAR:g}", mean, "", mean >= MEAN_COVERAGE_BAR,
                        f"{len(shares)} maps"))  # fmt: skip
        rows.append(row(f"{what}: coverage, worst", f">= {WORST_COVERAGE_BAR:g}", worst, "",
                        worst >= WORST_COVERAGE_BAR, ""))  # fmt: skip
    away = sum(len(far_from_home(record)) for record in records)
    touched = sum(sum(contacts(record).values()) for record in records)
    rows.append(row(f"{what}: robots that did not get home", "0", away, "", not away, ""))
    rows.append(row(f"{what}: contacts", "0", touched, "", not touched, ""))
    return rows


def _times(records: Sequence[MissionRecord]) -> list[float]:
    """T in s of those that finished."""
    return [record.team.exploration_time for record in records if record.team.exploration_time is not None]


def _range_row(free: Sequence[MissionRecord], short: Sequence[MissionRecord]) -> list[Row]:
    """Of seeds that finished both ways."""
    times = [
        {record.asked.seed: record.team.exploration_time for record in records if record.team.exploration_time}
        for records in (free, short)
    ]
    seeds = [seed for seed in times[0] if seed in times[1]]
    if not seeds:
        return []
    value = sum(times[1][seed] for seed in seeds) / sum(times[0][seed] for seed in seeds)
    what = f"mean T with a radio of 8 m over an error-free one, R = {TEAM}"
    return [row(what, f"<= {RANGE_BAR:g}", value, "", value <= RANGE_BAR, f"{len(seeds)} seeds")]
