"""Does virtual time tell the truth? Missions of the whole ROS stack beside trials of the same kind in virtual time."""

from __future__ import annotations

import json
import statistics
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping, Sequence

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from mr_experiments.figure_style import INK, STYLE, team_colour, write_png
from mr_experiments.record_set import RecordError, read_document

TOLERANCE = 0.15  # of the median exploration time


@dataclass(frozen=True)
class Runs:
    """What one team size came to: exploration times in s, map errors in percent of every map, missions not finished."""

    times: tuple[float, ...]
    errors: tuple[float, ...]
    unfinished: int


@dataclass(frozen=True)
class Agreement:
    """Of one team size. `ratio`: median time in virtual time over that of the ROS stack."""

    robots: int
    stack: Runs
    virtual: Runs
    ratio: float | None
    error_within: bool | None  # the mean error in virtual time lies within the scatter of the stack's maps

    @property
    def holds(self) -> bool:
        all_finished = not self.stack.unfinished and not self.virtual.unfinished
        near = self.ratio is not None and abs(self.ratio - 1.0) <= TOLERANCE
        return all_finished and near and bool(self.error_within)


def stack_runs(folder: Path) -> dict[int, Runs]:
    """By team size, from the summary.json files of `rosrun mr_launch team` below a folder."""
    found: dict[int, list[Mapping[str, Any]]] = {}
    for path in sorted(folder.glob("**/summary.json")):
        try:
            summary = json.loads(path.read_text(encoding="utf-8"))
            found.setdefault(len(summary["robots"]), []).append(summary)
            summary["team"]["exploration_time"]
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise RecordError(f"{path} is no summary of a mission: {error!r}") from None
    if not found:
        raise RecordError(f"{folder} holds no summary.json of rosrun mr_launch team")
    return {
        robots: Runs(
            tuple(s["team"]["exploration_time"] for s in summaries if s["team"]["exploration_time"] is not None),
            tuple(r["map_error"] for s in summaries for r in s["robots"].values() if r.get("map_error") is not None),
            sum(s["team"]["exploration_time"] is None for s in summaries),
        )
        for robots, summaries in found.items()
    }


def virtual_runs(folder: Path) -> dict[int, Runs]:
    """By team size, from records of one world, scenario and strategy."""
    found: dict[int, list[Mapping[str, Any]]] = {}
    kinds: set[tuple[Any, ...]] = set()
    for path in sorted(folder.glob("*.json")):
        record = read_document(path)
        try:
            kinds.add(tuple(record["trial"][key] for key in ("world", "scenario", "strategy")))
            found.setdefault(int(record["trial"]["robots"]), []).append(record)
            record["team"]["exploration_time"], record["outcome"]["status"], record["robots"].values()
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise RecordError(f"{path} is no record of a trial: {error!r}") from None
    if not found:
        raise RecordError(f"{folder} holds no records")
    if len(kinds) > 1:
        raise RecordError(f"{folder} holds records of several kinds: {sorted(kinds)}; keep each in a folder of its own")
    return {
        robots: Runs(
            tuple(r["team"]["exploration_time"] for r in records if r["outcome"]["status"] == "finished"),
            tuple(
                robot["map"]["error"]
                for record in records
                for robot in record["robots"].values()
                if robot["map"].get("error") is not None
            ),
            sum(record["outcome"]["status"] != "finished" for record in records),
        )
        for robots, records in found.items()
    }


def agreements(stack: Mapping[int, Runs], virtual: Mapping[int, Runs]) -> list[Agreement]:
    """For the team sizes that both have. Raises RecordError if there is none."""
    both = sorted(stack.keys() & virtual.keys())
    if not both:
        raise RecordError(f"no team size in common: ROS stack {sorted(stack)}, virtual time {sorted(virtual)}")
    return [_agreement(robots, stack[robots], virtual[robots]) for robots in both]


def _agreement(robots: int, stack: Runs, virtual: Runs) -> Agreement:
    ratio = None
    if stack.times and virtual.times:
        ratio = statistics.median(virtual.times) / statistics.median(stack.times)
    within = None
    if stack.errors and virtual.errors:
        within = min(stack.errors) <= statistics.mean(virtual.errors) <= max(stack.errors)
    return Agreement(robots, stack, virtual, ratio, within)


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
    """rows.json in the form of the benchmarks, and a figure."""
    out.mkdir(parents=True, exist_ok=True)
    rows = [row for entry in found for row in rows_of(entry)]
    (out / "agreement.json").write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    write_png(agreement_figure(found), out / "agreement.png")
    return [out / "agreement.json", out / "agreement.png"]


def rows_of(entry: Agreement) -> list[dict[str, Any]]:
    """{what, bar, value, unit, holds, detail}."""
    team = f"{entry.robots} robot" + ("s" if entry.robots > 1 else "")
    ratio = None if entry.ratio is None else round(entry.ratio, 4)
    counts = f"{len(entry.stack.times)} missions of the ROS stack, {len(entry.virtual.times)} in virtual time"
    unfinished = f"not finished: {entry.stack.unfinished} and {entry.virtual.unfinished}"
    mean = round(statistics.mean(entry.virtual.errors), 3) if entry.virtual.errors else None
    scatter = f"{min(entry.stack.errors):+.2f} to {max(entry.stack.errors):+.2f} %" if entry.stack.errors else "none"
    return [
        {
            "what": f"{team}: median exploration time, virtual time over ROS stack", "bar": "1 +- 0.15", "value": ratio,
            "unit": "", "holds": ratio is not None and abs(ratio - 1.0) <= TOLERANCE,
            "detail": f"{_median(entry.virtual.times)} over {_median(entry.stack.times)}; {counts}; {unfinished}",
        },
        {
            "what": f"{team}: mean map error in virtual time within the ROS stack's maps", "bar": scatter,
            "value": mean, "unit": "%", "holds": bool(entry.error_within),
            "detail": f"{len(entry.stack.errors)} and {len(entry.virtual.errors)} maps",
        },
    ]  # fmt: skip


def _median(values: Sequence[float]) -> str:
    return f"{statistics.median(values):.1f} s" if values else "-"
