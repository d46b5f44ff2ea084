"""Two record sets compared, trial by trial: what changed, how sure that is, and whether it is for the better."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, Iterable, Iterator, Sequence, Tuple

from mr_experiments.common.statistics import MINIMUM_PAIRS, Difference, compare_pairs
from mr_experiments.report.derived import mean, moving_share
from mr_experiments.report.record_set import Group, RecordSet
from mr_experiments.report.table import SIGNIFICANT, Cell, Column, Table
from mr_measures.record.files import RecordError
from mr_measures.record.mission_record import MissionRecord

KEYS = ("world", "scenario", "strategy", "robots")  # of a group; trials of a group are paired by seed
ACROSS = ("world", "scenario", "strategy")  # keys that may differ between the two sets

GroupKey = Tuple[object, ...]


@dataclass(frozen=True)
class Metric:
    name: str
    label: str
    lower_is_better: bool
    value: Callable[[MissionRecord], float | None]


METRICS = (
    Metric("finished", "finished, share", False, lambda record: float(record.finished)),
    Metric("exploration_time_s", "exploration time T in s", True, lambda record: record.team.exploration_time),
    Metric("distance_m", "distance in m", True, lambda record: record.distance),
    Metric("abs_map_error_percent", "|map error e| in %", True, lambda record: _map_error(record)),
    Metric("coverage", "coverage at the end", False, lambda record: record.final_coverage),
    Metric("kilobytes", "radio traffic in kB", True, lambda record: _kilobytes(record)),
    Metric("moving", "moving, share of time", False, lambda record: moving_share(record)),
    Metric("overlap", "overlap of robots", True, lambda record: _overlap(record)),
)


def _map_error(record: MissionRecord) -> float | None:
    return mean(abs(error) for error in record.map_errors)


def _kilobytes(record: MissionRecord) -> float | None:
    return sum(robot.sent("bytes_sent") for robot in record.robots.values()) / 1000.0


def _overlap(record: MissionRecord) -> float | None:
    return record.team.overlap if record.asked.robots > 1 else None


@dataclass(frozen=True)
class Row:
    """One metric in one group: means over the pairs that have it in both sets, and their difference."""

    group: GroupKey
    metric: Metric
    candidate: float | None
    baseline: float | None
    difference: Difference


@dataclass(frozen=True)
class Comparison:
    """Candidate against baseline. `keys` names the parts of a group."""

    candidate: RecordSet
    baseline: RecordSet
    keys: tuple[str, ...]
    rows: tuple[Row, ...]
    pairs: int
    only_candidate: int
    only_baseline: int
    notes: tuple[str, ...]  # what else differs between the trials of a pair than should


def compare_sets(candidate: RecordSet, baseline: RecordSet, across: Sequence[str] = ()) -> Comparison:
    """Pair the trials and compare every metric in every group.

    `across`: keys that may differ, of ACROSS. Raises RecordError when nothing can be paired or when a trial has more
    than one partner.
    """
    keys = tuple(key for key in KEYS if key not in across)
    first, second = _by_key(candidate, keys), _by_key(baseline, keys)
    common = [key for key in first if key in second]
    if not common:
        raise RecordError(
            f"no trial of {candidate.folder} has a partner in {baseline.folder} with equal {', '.join(keys)} and seed"
            f"{_what_differs(first, second, keys)}"
        )
    groups: dict[GroupKey, list[tuple[MissionRecord, MissionRecord]]] = {}
    for key in common:
        groups.setdefault(key[:-1], []).append((first[key], second[key]))
    rows = [_compare(group, metric, pairs) for group, pairs in groups.items() for metric in METRICS]
    rows = [row for row in rows if row.difference.pairs]
    return Comparison(
        candidate,
        baseline,
        keys,
        tuple(rows),
        len(common),
        len(first) - len(common),
        len(second) - len(common),
        (_codes(candidate, baseline), *_unequal_settings([(first[key], second[key]) for key in common], across)),
    )


def _what_differs(first: Iterable[GroupKey], second: Iterable[GroupKey], keys: Sequence[str]) -> str:
    """Between the first trials of two sets, in words."""
    for one, other in zip(first, second):
        differ = [f"{name} {a!r} and {b!r}" for name, a, b in zip((*keys, "seed"), one, other) if a != b]
        return f": their first ones have {', '.join(differ)}"
    return ""


def _codes(candidate: RecordSet, baseline: RecordSet) -> str:
    """Who compares a change has to see that there was one."""
    made_by = [sorted({record.code or "unknown" for record in records.records}) for records in (candidate, baseline)]
    one, other = (" and ".join(codes) for codes in made_by)
    if one == other:
        return f"Comparison: both sets were made by the code {one}"
    return f"Comparison: this set was made by the code {one}, the other one by {other}"


def _unequal_settings(pairs: Sequence[tuple[MissionRecord, MissionRecord]], across: Sequence[str]) -> Iterator[str]:
    """Sentences on settings that differ between the trials of pairs, beside those that come with `across`."""
    if "scenario" in across:  # which is a name for settings
        return
    wanted = {"seed", *across, *(("starts",) if "world" in across else ())}
    names = sorted({name for pair in pairs for record in pair for name in record.asked.settings} - wanted)
    for name in names:
        unequal = sum(first.asked.settings.get(name) != second.asked.settings.get(name) for first, second in pairs)
        if unequal:
            yield f"Comparison: setting {name} differs between the two trials of {unequal} of {len(pairs)} pairs"


def _by_key(records: RecordSet, keys: Sequence[str]) -> dict[GroupKey, MissionRecord]:
    found: dict[GroupKey, MissionRecord] = {}
    for record in records.records:
        key = (*(getattr(Group.of(record), name) for name in keys), record.asked.seed)
        if key in found:
            raise RecordError(f"two records of {records.folder} would both be paired with one of seed {key[-1]}")
        found[key] = record
    return found


def _compare(group: GroupKey, metric: Metric, pairs: Sequence[tuple[MissionRecord, MissionRecord]]) -> Row:
    values = []
    for first, second in pairs:
        # A crash says nothing about a metric but that the mission did not finish.
        if metric.name != "finished" and (first.failed or second.failed):
            continue
        one, other = metric.value(first), metric.value(second)
        if one is not None and other is not None:
            values.append((one, other))
    candidate, baseline = [one for one, _ in values], [other for _, other in values]
    difference = compare_pairs(candidate, baseline, metric.lower_is_better)
    return Row(group, metric, mean(candidate), mean(baseline), difference)


def comparison_table(comparison: Comparison) -> Table:
    rows: list[tuple[Cell, ...]] = [
        (
            *(str(part) for part in row.group),
            row.metric.label,
            row.difference.pairs,
            row.candidate,
            row.baseline,
            row.difference.mean,
            *_bounds(row.difference),
            row.difference.verdict_text,
        )
        for row in comparison.rows
    ]
    return Table("comparison", "Comparison", explanation(comparison), _columns(comparison.keys), tuple(rows))


def _columns(keys: Sequence[str]) -> tuple[Column, ...]:
    labels = {"robots": "R"}
    return (
        *(Column(key, labels.get(key, key), text=True) for key in keys),
        Column("metric", "metric", text=True),
        Column("pairs", "pairs"),
        Column("candidate_mean", "this set", SIGNIFICANT, "mean"),
        Column("baseline_mean", "other set", SIGNIFICANT, "mean"),
        Column("difference_mean", "mean", SIGNIFICANT, "difference"),
        Column("difference_low", "from", SIGNIFICANT, "difference"),
        Column("difference_high", "to", SIGNIFICANT, "difference"),
        Column("verdict", "verdict", text=True),
    )


def _bounds(difference: Difference) -> tuple[Cell, Cell]:
    interval = difference.interval
    return (interval.low, interval.high) if interval else (None, None)


def explanation(comparison: Comparison) -> str:
    return (
        f"This set against the other one: {comparison.pairs} pairs of trials with equal {', '.join(comparison.keys)} "
        f"and seed; {comparison.only_candidate} trials of this set and {comparison.only_baseline} of the other have "
        "no partner. A metric uses the pairs that have it in both sets; times, for instance, only those that finished "
        "in both. Difference: this set minus the other one, with the 95 % bootstrap interval of its mean. A row is "
        f"better or worse when its interval excludes zero and it has at least {MINIMUM_PAIRS} pairs of its own; with "
        "fewer even differences of one sign are no evidence. Of twenty verdicts on "
        "metrics that did not change, about one is wrong." + "".join(f" {note}." for note in comparison.notes)
    )
