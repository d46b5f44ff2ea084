"""Coverage over time against what no team could beat."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Mapping, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from mr_experiments.report import figure_style as style
from mr_experiments.report.derived import mean
from mr_experiments.report.figure_style import plt
from mr_experiments.report.figures import SAMPLES
from mr_experiments.report.scope import Scope
from mr_measures.lower_bound import LowerBound
from mr_measures.record.mission_record import MissionRecord

PANEL = (4.2, 3.1)  # inches
SINGLE = 6.0  # inches, width of a panel alone
MAXIMUM_COLUMNS = 2
LEGEND_ROW = 0.28  # inches
TOP = 1.04  # of the axis of coverage
DASHED = (0, (4, 2))


@dataclass(frozen=True)
class TeamBound:
    """Means over the trials of a team size: highest coverage (N,) at each time, least time in s to see everything."""

    coverage: np.ndarray
    completion: float


def team_bound(bound: LowerBound, trials: Sequence[MissionRecord], times: np.ndarray) -> TeamBound | None:
    """Of trials whose robots may start at different places; None without any robot."""
    teams = [tuple(robot.start for robot in trial.robots.values()) for trial in trials if trial.robots]
    if not teams:
        return None
    different = {team: (bound.coverage(team, times), bound.completion_time(team)) for team in set(teams)}
    coverages, completions = zip(*(different[team] for team in teams))
    return TeamBound(np.mean(coverages, axis=0), float(np.mean(completions)))


def coverage_figure(scope: Scope, bound: LowerBound | None) -> Figure | None:
    """One panel per team size; None without any coverage."""
    teams = {robots: _with_coverage(scope.results(robots)) for robots in scope.teams}
    teams = {robots: trials for robots, trials in teams.items() if trials}
    if not teams:
        return None
    times = np.linspace(0.0, _last_time(teams), SAMPLES)
    columns = min(MAXIMUM_COLUMNS, len(teams))
    rows = -(-len(teams) // columns)
    with plt.rc_context(style.STYLE):
        size = (PANEL[0] * columns if columns > 1 else SINGLE, PANEL[1] * rows + 0.5)
        figure, grid = plt.subplots(rows, columns, figsize=size, sharex=True, sharey=True, squeeze=False)
        for axes in grid.flat[len(teams) :]:
            axes.set_axis_off()
        for axes, (robots, trials) in zip(grid.flat, teams.items()):
            _draw_team(axes, robots, trials, times, team_bound(bound, trials, times) if bound else None)
            axes.set_ylabel("coverage" if axes in grid[:, 0] else "")
        for axes in grid[-1]:
            axes.set_xlabel("time in s")
        grid[0, 0].set_xlim(0.0, times[-1])
        grid[0, 0].set_ylim(0.0, TOP)
        _add_legend(figure, bound is not None)
    return figure


def _with_coverage(trials: Sequence[MissionRecord]) -> list[MissionRecord]:
    return [trial for trial in trials if trial.team.series.time]


def _last_time(teams: Mapping[int, Sequence[MissionRecord]]) -> float:
    """When the last finished mission ends; missions that never finish would hide the others."""
    trials = [trial for members in teams.values() for trial in members]
    ends = [trial.team.exploration_time for trial in trials if trial.team.exploration_time is not None]
    return max(ends or [trial.outcome.time for trial in trials]) or 1.0


def _draw_team(
    axes: Axes, robots: int, trials: Sequence[MissionRecord], times: np.ndarray, bound: TeamBound | None
) -> None:
    colour = style.team_colour(robots)
    curves = [np.interp(times, trial.team.series.time, trial.team.series.coverage) for trial in trials]
    low, high = np.quantile(curves, (0.05, 0.95), axis=0)
    axes.fill_between(times, low, high, color=colour, alpha=0.25, linewidth=0)
    axes.plot(times, np.mean(curves, axis=0), color=colour)
    title = [f"R = {robots}"]
    end = mean(trial.team.exploration_time for trial in trials)
    if end is not None:
        axes.axvline(end, color=colour, linewidth=1.3)
        title.append(f"mean T {end:.0f} s")
    if bound is not None:
        axes.fill_between(times, bound.coverage, TOP, color=style.INK, alpha=0.12, linewidth=0)
        axes.plot(times, bound.coverage, color=style.INK, linestyle=DASHED, linewidth=1.4)
        axes.axvline(bound.completion, color=style.INK, linestyle=":", linewidth=1.6)
        title.append(f"not all before {bound.completion:.0f} s")
    axes.set_title(", ".join(title), loc="left")


def _add_legend(figure: Figure, with_bound: bool) -> None:
    """Below the panels, in neutral colour because it holds for all of them."""
    entries: list[Artist] = [
        Line2D([], [], color=style.INK, label="mean of the missions"),
        Patch(facecolor=style.INK, alpha=0.25, label="0.05 to 0.95 of them"),
        Line2D([], [], color=style.INK, linewidth=1.3, label="mean T"),
    ]
    if with_bound:
        entries.append(Line2D([], [], color=style.INK, linestyle=DASHED, linewidth=1.4, label="no team sees more"))
        entries.append(Line2D([], [], color=style.INK, linestyle=":", linewidth=1.6, label="no team sees all before"))
    columns = 3 if figure.get_figwidth() > SINGLE else 2
    rows = -(-len(entries) // columns)
    share = rows * LEGEND_ROW / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0.0, share, 1.0, 1.0 - share))
    figure.legend(handles=entries, loc="lower center", ncol=columns)
