"""Does virtual time tell the truth? Missions of the whole ROS stack beside trials of the same kind in virtual time."""

from __future__ import annotations

import json
import statistics
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any, Iterable, Mapping, Sequence

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from mr_experiments.common.statistics import Ratio, mean_ratio, median_ratio
from mr_experiments.report.figure_style import INK, STYLE, team_colour, write_png
from mr_experiments.report.record_set import load_record
from mr_experiments.report.stack_missions import Attempt, read_attempts
from mr_measures.record.files import RecordError
from mr_measures.record.mission_record import FINISHED

LOW, HIGH = 0.85, 1.15  # of the ratio of exploration times: nearer than this is as good as equal
MINIMUM_MISSIONS = 12  # finished ones on either side, below which nothing is said


class Verdict(Enum):
    EQUIVALENT = "equivalent within +-15 %"
    DIFFERENT = "different"
    UNDECIDED = "undecided: more missions needed"
    TOO_FEW = "too few missions"


@dataclass(frozen=True)
class Runs:
    """All attempts of one team size on one side."""

    attempts: tuple[Attempt, ...]

    @property
    def times(self) -> tuple[float, ...]:
        """T in s of the missions that finished."""
        return tuple(one.time for one in self.attempts if one.status == FINISHED and one.time is not None)

    @property
    def errors(self) -> tuple[float, ...]:
        """In percent, of every map."""
        return tuple(error for one in self.attempts for error in one.errors)

    @property
    def not_finished(self) -> tuple[Attempt, ...]:
        return tuple(one for one in self.attempts if one.status != FINISHED)


@dataclass(frozen=True)
class Agreement:
    """Of one team size. Ratios: time in virtual time over that of the ROS stack."""

    robots: int
    stack: Runs
    virtual: Runs
    mean: Ratio | None
    median: Ratio | None
    verdict: Verdict
    error_within: bool | None  # the mean error in virtual time lies within the scatter of the stack's maps

    @property
    def holds(self) -> bool:
        return all(row["holds"] for row in rows_of(self))


def stack_runs(folder: Path) -> dict[int, Runs]:
    """By team size, from missions of `rosrun mr_launch team` below a folder. An attempt that left no sign of its team
    size counts for each. Raises RecordError."""
    attempts = read_attempts(folder)
    sizes = {one.robots for one in attempts if one.robots is not None}
    if not sizes:
        raise RecordError(f"{folder} holds no mission with a record: {_named(attempts)}")
    return {size: Runs(tuple(one for one in attempts if one.robots in (size, None))) for size in sorted(sizes)}


def virtual_runs(folder: Path) -> dict[int, Runs]:
    """By team size, from records of one world, scenario and strategy. Raises RecordError."""
    found: dict[int, list[Attempt]] = {}
    kinds: set[tuple[str, str, int]] = set()
    for path in sorted(folder.glob("*.json")):
        record = load_record(path)
        asked = record.asked
        kinds.add((asked.world, asked.scenario, asked.strategy))
        found.setdefault(asked.robots, []).append(Attempt.of(path.stem, record))
    if not found:
        raise RecordError(f"{folder} holds no records")
    if len(kinds) > 1:
        raise RecordError(f"{folder} holds records of several kinds: {sorted(kinds)}; keep each in a folder of its own")
    return {robots: Runs(tuple(attempts)) for robots, attempts in sorted(found.items())}


def agreements(stack: Mapping[int, Runs], virtual: Mapping[int, Runs]) -> list[Agreement]:
    """For the team sizes that both have. Raises RecordError if there is none, or if the worlds differ."""
    both = sorted(stack.keys() & virtual.keys())
    if not both:
        raise RecordError(f"no team size in common: ROS stack {sorted(stack)}, virtual time {sorted(virtual)}")
    worlds = {one.world for side in (stack, virtual) for runs in side.values() for one in runs.attempts} - {""}
    if len(worlds) > 1:
        raise RecordError(f"missions of different worlds are not compared: {', '.join(sorted(worlds))}")
    return [_agreement(robots, stack[robots], virtual[robots]) for robots in both]


def _agreement(robots: int, stack: Runs, virtual: Runs) -> Agreement:
    within = None
    if stack.errors and virtual.errors:
        within = min(stack.errors) <= statistics.mean(virtual.errors) <= max(stack.errors)
    mean, median = mean_ratio(virtual.times, stack.times), median_ratio(virtual.times, stack.times)
    return Agreement(robots, stack, virtual, mean, median, verdict_of(mean, stack, virtual), within)


def verdict_of(ratio: Ratio | None, stack: Runs, virtual: Runs) -> Verdict:
    """What the interval of the ratio shows: two one-sided tests, and the test for a difference that counts."""
    if ratio is None or min(len(stack.times), len(virtual.times)) < MINIMUM_MISSIONS:
        return Verdict.TOO_FEW
    if ratio.interval.low > LOW and ratio.interval.high < HIGH:
        return Verdict.EQUIVALENT
    outside = ratio.interval.high < LOW or ratio.interval.low > HIGH
    return Verdict.DIFFERENT if outside else Verdict.UNDECIDED


def notes_of(found: Sequence[Agreement]) -> list[str]:
    """What a reader must know of the two sides beside the figures."""
    stack, virtual = (sorted(codes) for codes in _codes(found))
    if stack == virtual and len(stack) == 1 and stack[0]:
        return []
    return [f"not shown to be of one code: ROS stack {_list(stack)}, virtual time {_list(virtual)}"]


def _codes(found: Sequence[Agreement]) -> tuple[set[str], set[str]]:
    sides = [entry.stack.attempts for entry in found], [entry.virtual.attempts for entry in found]
    stack, virtual = ({one.code for attempts in side for one in attempts} for side in sides)
    return stack, virtual


def _list(codes: Iterable[str]) -> str:
    return ", ".join(code or "unknown" for code in codes)


def agreement_figure(found: Sequence[Agreement]) -> Figure:
    """Every exploration time and every map error, ROS stack and virtual time side by side for each team size."""
    with plt.rc_context(STYLE):
        figure, (times, errors) = plt.subplots(1, 2, figsize=(9.0, 3.6))
        for place, entry in enumerate(found):
            for axes, name in ((times, "times"), (errors, "errors")):
                for offset, runs, marker in ((-0.16, entry.stack, "o"), (0.16, entry.virtual, "D")):
                    values = getattr(runs, name)
                    style = {"color": team_colour(entry.robots), "alpha": 0.65, "markersize": 5}
                    axes.plot([place + offset] * len(values), values, marker, **style)
                    if values:
                        middle = statistics.median(values)
                        axes.hlines(middle, place + offset - 0.11, place + offset + 0.11, color=INK, linewidth=1.4)
        for axes, label in ((times, "exploration time in s"), (errors, "map error e in %")):
            axes.set_xticks(range(len(found)), [f"R = {entry.robots}" for entry in found])
            axes.set_ylabel(label)
            axes.set_xlim(-0.5, len(found) - 0.5)
        times.set_ylim(bottom=0.0)
        times.set_title("left: ROS stack (circles), right: virtual time (diamonds)", loc="left")
        errors.set_title("bars: medians", loc="left")
    return figure


def write_agreement(found: Sequence[Agreement], out: Path) -> list[Path]:
    """agreement.json, to which this comparison is added behind the former ones, and a figure. Raises RecordError if
    what is there is no such file."""
    out.mkdir(parents=True, exist_ok=True)
    path = out / "agreement.json"
    former, now = read_comparisons(path), comparison_of(found)
    comparisons = former if former and former[-1] == now else [*former, now]
    path.write_text(json.dumps({"comparisons": comparisons}, indent=1) + "\n", encoding="utf-8")
    write_png(agreement_figure(found), out / "agreement.png")
    return [path, out / "agreement.png"]


def read_comparisons(path: Path) -> list[dict[str, Any]]:
    """Of an agreement.json, oldest first; none if it is not there. Raises RecordError."""
    try:
        document = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {"comparisons": []}
        comparisons = document["comparisons"]
        if not isinstance(comparisons, list):
            raise TypeError("comparisons is no list")
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise RecordError(f"{path} holds no comparisons ({error!r}); move it away or choose another --out") from None
    return comparisons


def comparison_of(found: Sequence[Agreement]) -> dict[str, Any]:
    """Everything that it was made from, without a date: the same missions give the same."""
    stack, virtual = (sorted(codes) for codes in _codes(found))
    commits = {one.commit for entry in found for one in entry.stack.attempts} - {""}
    return {
        "codes": {"stack": stack, "virtual": virtual},
        "commits": sorted(commits),
        "notes": notes_of(found),
        "teams": [
            {
                "robots": entry.robots,
                "verdict": entry.verdict.value,
                "mean_ratio": _ratio_json(entry.mean),
                "median_ratio": _ratio_json(entry.median),
                "stack": [_attempt_json(one) for one in entry.stack.attempts],
                "virtual": [_attempt_json(one) for one in entry.virtual.attempts],
            }
            for entry in found
        ],
        "rows": [row for entry in found for row in rows_of(entry)],
    }


def _ratio_json(ratio: Ratio | None) -> list[float] | None:
    """Value and interval."""
    return None if ratio is None else [round(x, 4) for x in (ratio.value, ratio.interval.low, ratio.interval.high)]


def _attempt_json(one: Attempt) -> dict[str, Any]:
    names = {"name": one.name, "seed": one.seed, "status": one.status}
    return {**names, "time": one.time, "map_errors": list(one.errors)}


def rows_of(entry: Agreement) -> list[dict[str, Any]]:
    """{what, bar, value, unit, holds, detail}."""
    team = f"{entry.robots} robot" + ("s" if entry.robots > 1 else "")
    mean = round(statistics.mean(entry.virtual.errors), 3) if entry.virtual.errors else None
    scatter = f"{min(entry.stack.errors):+.2f} to {max(entry.stack.errors):+.2f} %" if entry.stack.errors else "none"
    lost = [*entry.stack.not_finished, *entry.virtual.not_finished]
    return [
        {
            "what": f"{team}: mean exploration time, virtual time over ROS stack",
            "bar": f"95 % interval within {LOW} to {HIGH}",
            "value": None if entry.mean is None else round(entry.mean.value, 4),
            "unit": "", "holds": entry.verdict is Verdict.EQUIVALENT, "detail": _ratio_detail(entry),
        },
        {
            "what": f"{team}: attempts that did not finish", "bar": "0", "value": len(lost), "unit": "missions",
            "holds": not lost,
            "detail": f"of {len(entry.stack.attempts)} of the ROS stack, {len(entry.virtual.attempts)} in virtual time"
            + (f": {_named(lost)}" if lost else ""),
        },
        {
            "what": f"{team}: mean map error in virtual time within the ROS stack's maps", "bar": scatter,
            "value": mean, "unit": "%", "holds": bool(entry.error_within),
            "detail": f"{len(entry.stack.errors)} and {len(entry.virtual.errors)} maps",
        },
    ]  # fmt: skip


def _ratio_detail(entry: Agreement) -> str:
    verdict = entry.verdict.value
    if entry.verdict is Verdict.TOO_FEW:
        verdict += f", {MINIMUM_MISSIONS} on either side are needed"
    return (
        f"{verdict}; mean {_ratio_text(entry.mean)}, median {_ratio_text(entry.median)}: "
        f"{_median(entry.virtual.times)} over {_median(entry.stack.times)}; "
        f"{len(entry.stack.times)} missions of the ROS stack, {len(entry.virtual.times)} in virtual time"
    )


def _ratio_text(ratio: Ratio | None) -> str:
    if ratio is None:
        return "-"
    return f"{ratio.value:.3f} ({ratio.interval.low:.3f} to {ratio.interval.high:.3f})"


def _named(attempts: Iterable[Attempt]) -> str:
    return ", ".join(f"{one.name} ({one.status})" for one in attempts)


def _median(values: Sequence[float]) -> str:
    return f"{statistics.median(values):.1f} s" if values else "-"
