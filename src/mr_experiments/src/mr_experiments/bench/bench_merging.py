"""How soon teams know where their members are, in missions in virtual time. Rows as the other benchmarks'."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Callable, Mapping, Sequence

from scipy import stats

from mr_experiments.bench.merge_times import all_settled_at, classes_of_pairs, known_at, quantile
from mr_experiments.bench.rows import Row, row_of
from mr_experiments.sweep.trial_process import record_path
from mr_experiments.trial.scenario import load_scenario
from mr_experiments.trial.trial import Trial
from mr_measures.record.files import read_record
from mr_measures.record.mission_record import MissionRecord

MEDIAN_BAR, HIGH_BAR = 10.0, 20.0  # s after the start until all transforms are right, and at the 0.95 quantile
TURTLEBOT_BAR = 40.0  # s, the median of robots that see 57 degrees
SPEEDUP_BAR = 0.6  # T of four robots over that of one, where all rooms are equal
KNOWN_BAR = 0.6  # share of the area that is known when robots from anywhere have all transforms
COST_BAR = 15.0  # ms of processor time per s of virtual time for all robots' merging and registration
COST_SEEDS = 5


@dataclass(frozen=True)
class Request:
    """What is asked for on the command line."""

    seeds: Sequence[int]
    until: float  # s after which missions that are only to meet end


@dataclass(frozen=True)
class Part:
    """Missions of one kind and the rows that their records, by team size, make."""

    name: str
    trials: Callable[[Request], list[Trial]]
    rows: Callable[[Mapping[int, Sequence[MissionRecord]]], list[Row]]


def row(what: str, bar: str, value: float, unit: str, holds: bool, detail: str) -> Row:
    return row_of(what, bar, round(value, 3), unit, holds, detail)


def records_of(trials: Sequence[Trial], folder: Path) -> dict[int, list[MissionRecord]]:
    """The records of the trials by team size."""
    found: dict[int, list[MissionRecord]] = {}
    for trial in trials:
        found.setdefault(trial.robots, []).append(read_record(record_path(folder, trial)))
    return found


# --- robots that start side by side -----------------------------------------------------------------------------------


def _meeting(scenario: str, bars: Sequence[tuple[float, float]], patience: float = 1.0) -> Part:
    """`bars`: share of the missions and s. `patience`: of `until`."""

    def trials(request: Request) -> list[Trial]:
        chosen = load_scenario(scenario)
        return [
            replace(chosen.trial(robots, 7, seed), limit=patience * request.until)
            for seed in request.seeds
            for robots in (2, 4)
        ]

    def rows(records: Mapping[int, Sequence[MissionRecord]]) -> list[Row]:
        return [made for robots, of_size in records.items() for made in _meeting_rows(scenario, robots, of_size, bars)]

    return Part(scenario, trials, rows)


def _meeting_rows(
    scenario: str, robots: int, records: Sequence[MissionRecord], bars: Sequence[tuple[float, float]]
) -> list[Row]:
    times = [_settled(record) for record in records]
    detail = f"{_seeds(records)}; {_spread(times, 's')}; {_never(times)}"
    return [
        row(
            f"{scenario}, R = {robots}: all transforms right, {'median' if share == 0.5 else f'{share:g} quantile'}",
            f"<= {bar:g} s", quantile(times, share), "s", quantile(times, share) <= bar, detail,
        )
        for share, bar in bars
    ]  # fmt: skip


# --- whole missions ---------------------------------------------------------------------------------------------------


def _equal_trials(request: Request) -> list[Trial]:
    scenario = load_scenario("equal_rooms")
    return [scenario.trial(robots, 7, seed) for seed in request.seeds for robots in (1, 4)]


def _equal_rows(records: Mapping[int, Sequence[MissionRecord]]) -> list[Row]:
    one, four = ([_duration(record) for record in records[robots]] for robots in (1, 4))
    merged = sum(math.isfinite(_settled(record)) for record in records[4])
    ratio = quantile(four, 0.5) / quantile(one, 0.5)
    ratio = math.inf if math.isnan(ratio) else ratio
    detail = (
        f"{_seeds(records[4])}; medians {quantile(four, 0.5):.1f} s and {quantile(one, 0.5):.1f} s; overlap "
        f"{quantile([_overlap(record) for record in records[4]], 0.5):.2f}; "
        f"{merged} of {len(four)} missions merged"
    )
    holds = ratio <= SPEEDUP_BAR and merged == len(four)
    return [row("equal_rooms: T of four robots over T of one", f"<= {SPEEDUP_BAR:g}", ratio, "", holds, detail)]


def _unknown_trials(request: Request) -> list[Trial]:
    scenario = load_scenario("unknown_poses")
    return [scenario.trial(robots, 7, seed) for seed in request.seeds for robots in (2, 4)]


def _unknown_rows(records: Mapping[int, Sequence[MissionRecord]]) -> list[Row]:
    rows = []
    for robots, of_size in records.items():
        shares = [known_at(record, _settled(record)) for record in of_size]
        value, what = quantile(shares, 0.5), f"unknown_poses, R = {robots}"
        times = [_settled(record) for record in of_size]
        never = sum(map(math.isinf, shares)) / len(shares)
        detail = f"{_seeds(of_size)}; {_spread(times, 's')}"
        rows += [
            row(f"{what}: known when all transforms are right, median", f"<= {KNOWN_BAR:g} of the area", value,
                "of the area", value <= KNOWN_BAR, detail),
            row(f"{what}: missions that never merge", "aim 0", never, "of the missions", never == 0.0, detail),
        ]  # fmt: skip
    return rows


def _cost_trials(request: Request) -> list[Trial]:
    scenario = load_scenario("paper")
    return [scenario.trial(3, 7, seed) for seed in request.seeds[:COST_SEEDS]]


def _cost_rows(records: Mapping[int, Sequence[MissionRecord]]) -> list[Row]:
    costs = [_cost(record) for record in records[3]]
    value = quantile(costs, 0.5)
    detail = f"{_seeds(records[3])}; {_spread(costs, 'ms')}; all three robots together"
    what = "merging and registration, R = 3, per virtual second, median"
    return [row(what, f"<= {COST_BAR:g} ms", value, "ms", value <= COST_BAR, detail)]


def _cost(record: MissionRecord) -> float:
    measured = record.measured.cpu_by_component
    spent = measured.get("merging", math.inf) + measured.get("registration", 0.0)
    return 1000.0 * spent / record.outcome.time if record.outcome.time else math.inf


SIDE_BY_SIDE = ((0.5, MEDIAN_BAR), (0.95, HIGH_BAR))
PARTS = {
    "paper": _meeting("paper", SIDE_BY_SIDE),
    "equal_rooms": _meeting("equal_rooms", SIDE_BY_SIDE),
    "narrow": _meeting("narrow", SIDE_BY_SIDE),
    "radio": _meeting("radio", SIDE_BY_SIDE),
    "turtlebot": _meeting("turtlebot", ((0.5, TURTLEBOT_BAR),), patience=2.0),
    "equal_whole": Part("equal_whole", _equal_trials, _equal_rows),
    "unknown_poses": Part("unknown_poses", _unknown_trials, _unknown_rows),
    "cost": Part("cost", _cost_trials, _cost_rows),
}


def wrong_row(records: Sequence[MissionRecord]) -> Row:
    """Of all missions together. A pair is two robots of one mission, in whatever direction they were wrong."""
    counts = Counter(kind for record in records for kind in classes_of_pairs(record))
    pairs, wrong = sum(counts.values()), counts["wrong"]
    bound = 100.0 * float(stats.beta.ppf(0.95, wrong + 1, pairs - wrong)) if pairs > wrong else 100.0
    seeds = sorted({f"{r.asked.scenario} R{r.asked.robots} s{r.asked.seed}" for r in records
                    if "wrong" in classes_of_pairs(r)})  # fmt: skip
    detail = (
        f"of {pairs} pairs ({counts['right']} right, {counts['imprecise']} imprecise, {counts['none']} without); "
        f"at most {bound:.2f} % at 95 % confidence" + (f"; {', '.join(seeds)}" if seeds else "")
    )
    return row("pairs that believed a wrong transform", "0", float(wrong), "pairs", wrong == 0 and pairs > 0, detail)


def _settled(record: MissionRecord) -> float:
    """Of a mission that failed: never."""
    return math.inf if record.failed else all_settled_at(record)


def _duration(record: MissionRecord) -> float:
    time = record.team.exploration_time
    return math.inf if time is None else time


def _overlap(record: MissionRecord) -> float:
    return math.inf if record.team.overlap is None else record.team.overlap


def _seeds(records: Sequence[MissionRecord]) -> str:
    seeds = [record.asked.seed for record in records]
    failed = sum(record.failed for record in records)
    return f"seeds {min(seeds)} to {max(seeds)}" + (f", {failed} failed" if failed else "")


def _spread(values: Sequence[float], unit: str) -> str:
    finite = [value for value in values if math.isfinite(value)]
    return f"{min(finite):.1f} to {max(finite):.1f} {unit}" if finite else "no value"


def _never(times: Sequence[float]) -> str:
    return f"{sum(map(math.isinf, times))} of {len(times)} missions without"
