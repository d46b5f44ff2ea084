"""The tables of the paper: map error, distance and exploration time, beside the published numbers."""

from __future__ import annotations

from typing import Callable, Mapping

from mr_experiments.common.statistics import Interval, Summary, mean_interval, summarise
from mr_experiments.report import paper
from mr_experiments.report.derived import present
from mr_experiments.report.record_set import count_outcomes
from mr_experiments.report.scope import ROBOTS, Scope
from mr_experiments.report.table import Cell, Column, Table
from mr_measures.record.mission_record import FAILED, FINISHED, UNFINISHED, MissionRecord


def map_error_table(scope: Scope) -> Table:
    """Table I."""
    rows: list[tuple[Cell, ...]] = []
    for robots in scope.teams:
        trials = scope.results(robots)
        errors = [error for trial in trials for error in trial.map_errors]
        # The maps of one mission depend on each other, so the interval rests on the missions' means.
        mission_means = [sum(trial.map_errors) / len(trial.map_errors) for trial in trials if trial.map_errors]
        sizes = summarise([abs(error) for error in errors])
        rows.append(
            (
                robots,
                len(errors),
                sum(len(trial.robots) for trial in trials) - len(errors),
                *_spread_cells(summarise(errors), mean_interval(mission_means)),
                *((None, None) if sizes is None else (sizes.mean, sizes.high)),
                *_paper_cells(scope, paper.MAP_ERROR, robots),
            )
        )
    return Table(
        "table1_map_error",
        "Table I: map error e in percent",
        "Explored free cells of each robot's own final global map against the reference value of the world, over "
        "all maps of all missions, those of unfinished ones included. Zero is best. |e| does not let errors of "
        "either sign cancel. The interval is the 95 % bootstrap interval of the mean.",
        (
            ROBOTS,
            Column("maps", "maps"),
            Column("maps_without_error", "maps without e"),
            *_spread_columns("e_percent", 2),
            Column("abs_e_percent_mean", "mean", 2, "|e|"),
            Column("abs_e_percent_q95", "0.95", 2, "|e|"),
            *_paper_columns(scope, "e_percent", 2),
        ),
        tuple(rows),
    )


def distance_table(scope: Scope) -> Table:
    """Table II a."""
    return _mission_table(
        scope,
        "table2a_distance",
        "Table II a: distance driven by the team in m",
        "Sum over the robots of a mission, each until it has declared its exploration finished, from ground truth.",
        "distance_m",
        lambda record: record.distance,
        paper.DISTANCE,
    )


def exploration_time_table(scope: Scope) -> Table:
    """Table II b."""
    return _mission_table(
        scope,
        "table2b_exploration_time",
        "Table II b: exploration time T in s",
        "From the start of the mission until the last robot has declared its exploration finished. Unfinished "
        "missions have no T: they are counted here and make the true mean larger than the one shown.",
        "exploration_time_s",
        lambda record: record.team.exploration_time,
        paper.EXPLORATION_TIME,
    )


def _mission_table(
    scope: Scope,
    name: str,
    title: str,
    explanation: str,
    quantity: str,
    value: Callable[[MissionRecord], float | None],
    published: Mapping[int, paper.Spread],
) -> Table:
    """Spread of one value per mission."""
    rows: list[tuple[Cell, ...]] = []
    for robots, members in scope.teams.items():
        values = present(value(record) for record in scope.results(robots))
        counts = count_outcomes(members)
        rows.append(
            (
                robots,
                counts[FINISHED],
                counts[UNFINISHED],
                counts[FAILED],
                *_spread_cells(summarise(values), mean_interval(values)),
                *_paper_cells(scope, published, robots),
            )
        )
    columns = (
        ROBOTS,
        Column("finished", "finished"),
        Column("unfinished", "unfinished"),
        Column("failed", "failed"),
        *_spread_columns(quantity, 1),
        *_paper_columns(scope, quantity, 0),
    )
    return Table(name, title, explanation, columns, tuple(rows))


def _spread_columns(quantity: str, digits: int) -> tuple[Column, ...]:
    labels = (("q05", "0.05"), ("mean", "mean"), ("q95", "0.95"), ("mean_low", "mean from"), ("mean_high", "to"))
    return tuple(Column(f"{quantity}_{suffix}", label, digits, "this set") for suffix, label in labels)


def _spread_cells(summary: Summary | None, interval: Interval | None) -> tuple[Cell, ...]:
    if summary is None:
        return (None,) * 5
    return summary.low, summary.mean, summary.high, *((interval.low, interval.high) if interval else (None, None))


def _paper_columns(scope: Scope, quantity: str, digits: int) -> tuple[Column, ...]:
    if not scope.beside_paper:
        return ()
    labels = (("q05", "0.05"), ("mean", "mean"), ("q95", "0.95"))
    return tuple(Column(f"paper_{quantity}_{suffix}", label, digits, "paper") for suffix, label in labels)


def _paper_cells(scope: Scope, published: Mapping[int, paper.Spread], robots: int) -> tuple[Cell, ...]:
    if not scope.beside_paper:
        return ()
    spread = published.get(robots)
    return (None, None, None) if spread is None else (spread.low, spread.mean, spread.high)
