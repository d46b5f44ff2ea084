"""Figures 4 and 5 of the paper: progress by area, and when the robots finish."""

from __future__ import annotations

from typing import Sequence, Tuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mr_experiments.report import figure_style as style
from mr_experiments.report import paper
from mr_experiments.report.derived import mean
from mr_experiments.report.figure_style import plt
from mr_experiments.report.scope import Scope
from mr_experiments.report.time_axis import TimeAxis
from mr_measures.record.mission_record import MissionRecord

Curve = Tuple[np.ndarray, np.ndarray]  # times (N,) in s, values (N,)

SIZE = (8.4, 4.6)  # inches
SAMPLES = 250  # of a curve


def common_times(trials: Sequence[MissionRecord]) -> np.ndarray:
    """Times (N,) from 0 to the end of the longest mission that has a series."""
    return np.linspace(0.0, max(trial.team.series.time[-1] for trial in trials), SAMPLES)


def reference_area(scope: Scope) -> float | None:
    """Median final explored area (m^2) of the missions of one robot, or of all if there are none of one robot."""
    trials = scope.results(1) if 1 in scope.teams else []
    trials = trials or [trial for robots in scope.teams for trial in scope.results(robots)]
    areas = [trial.team.series.explored[-1] for trial in trials if trial.team.series.explored]
    return float(np.median(areas)) if areas else None


def mean_progress(trials: Sequence[MissionRecord], area: float) -> Curve | None:
    """Explored area over `area` (m^2), mean over the missions; None without any."""
    trials = [trial for trial in trials if trial.team.series.time]
    if not trials:
        return None
    times = common_times(trials)
    # Beyond its end a mission keeps its last value.
    shares = [np.interp(times, trial.team.series.time, trial.team.series.explored) / area for trial in trials]
    return times, np.mean(shares, axis=0)


def finishing_curve(records: Sequence[MissionRecord], robots: int) -> Curve:
    """Share of the robots that have finished by each time; those that never do keep it below 1."""
    members = [robot for record in records for robot in record.robots.values()]
    times = np.sort([robot.finished_at for robot in members if robot.finished_at is not None])
    share = np.arange(1, len(times) + 1) / (robots * len(records))
    return np.concatenate([[0.0], times]), np.concatenate([[0.0], share])


def progress_figure(scope: Scope) -> Figure | None:
    """Fig. 4; None without any explored area."""
    area = reference_area(scope)
    if area is None or area <= 0.0:
        return None
    curves = {robots: mean_progress(scope.results(robots), area) for robots in scope.teams}
    return _team_figure(
        scope,
        {robots: curve for robots, curve in curves.items() if curve is not None},
        "mean explored area, normalised",
        paper.PROGRESS_MARKS,
        steps=False,
    )


def finishing_figure(scope: Scope) -> Figure | None:
    """Fig. 5; None if all trials failed."""
    curves = {robots: finishing_curve(scope.results(robots), robots) for robots in scope.teams if scope.results(robots)}
    if not curves:
        return None
    return _team_figure(scope, curves, "share of robots that have finished", paper.FINISHING_MARKS, steps=True)


def _team_figure(
    scope: Scope, curves: dict[int, Curve], label: str, marks: Sequence[paper.Mark], steps: bool
) -> Figure:
    """One curve and one vertical line at the mean T per team size, with the paper's marks where they belong."""
    published = paper.EXPLORATION_TIME if scope.beside_paper else {}
    marks = [mark for mark in marks if scope.beside_paper and mark.robots in curves]
    axis = _time_axis(scope, curves, [published[r].mean for r in curves if r in published])
    with plt.rc_context(style.STYLE):
        figure, axes = plt.subplots(figsize=SIZE)
        for robots, (times, values) in curves.items():
            colour, dash = style.team_colour(robots), style.team_dash(robots)
            times, values = np.append(times, axis.end), np.append(values, values[-1])
            axes.plot(times, values, color=colour, linestyle=dash, drawstyle="steps-post" if steps else "default")
            _vertical(axes, mean(record.team.exploration_time for record in scope.teams[robots]), colour, "-")
            _vertical(axes, published[robots].mean if robots in published else None, colour, ":")
        for mark in marks:
            axes.plot(mark.time, mark.value, "o", color=style.team_colour(mark.robots), mfc="none", mew=1.8, ms=7)
        axes.axhline(1.0, color=style.INK, linewidth=0.8, alpha=0.5, zorder=0)
        axes.set_ylim(0.0, max(1.05, 1.05 * max(values.max() for _, values in curves.values())))
        axes.set_ylabel(label)
        axis.apply(axes)
        _add_legend(axes, list(curves), bool(published), bool(marks))
    return figure


def _time_axis(scope: Scope, curves: dict[int, Curve], published: Sequence[float]) -> TimeAxis:
    """Missions that finish are shown in detail; unfinished ones and the paper's numbers may lie far behind them."""
    ends = [record.team.exploration_time for records in scope.teams.values() for record in records]
    last = max((float(times[-1]) for times, _ in curves.values()), default=0.0)
    detail = max((end for end in ends if end is not None), default=last) or 1.0
    return TimeAxis.showing(1.04 * detail, 1.04 * max([last, detail, *published]))


def _vertical(axes: Axes, time: float | None, colour: str, dash: str) -> None:
    if time is not None:
        axes.axvline(time, color=colour, linestyle=dash, linewidth=1.3 if dash == "-" else 2.0, alpha=0.9, zorder=1)


def _add_legend(axes: Axes, teams: Sequence[int], published: bool, marks: bool) -> None:
    entries = [
        Line2D([], [], color=style.team_colour(robots), linestyle=style.team_dash(robots), label=f"R = {robots}")
        for robots in teams
    ]
    entries.append(Line2D([], [], color=style.INK, linewidth=1.3, label="mean T"))
    if published:
        entries.append(Line2D([], [], color=style.INK, linewidth=2.0, linestyle=":", label="mean T in the paper"))
    if marks:
        circle = {"marker": "o", "markerfacecolor": "none", "markeredgewidth": 1.8}
        entries.append(Line2D([], [], color=style.INK, linestyle="", label="quoted in the paper", **circle))
    columns = len(entries) if len(entries) <= 5 else 4
    axes.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, -0.15), ncol=columns)
