"""The tables of a report, computed from records.

Failed trials (an engine or a node crashed) have no result and enter the counts only. Unfinished trials enter every
table except the exploration time, which they do not have; their number stands beside it.
"""

from __future__ import annotations

import statistics

from mr_experiments.report.paper_tables import distance_table, exploration_time_table, map_error_table
from mr_experiments.report.record_set import Group, RecordSet, count_outcomes
from mr_experiments.report.scope import Scope
from mr_experiments.report.table import Cell, Column, Table
from mr_experiments.report.team_tables import computing_table, merging_table, radio_table, team_table
from mr_measures.record.mission_record import FAILED, FINISHED, UNFINISHED, MissionRecord


def chapter_tables(scope: Scope) -> list[Table]:
    """All tables of a chapter in the order of the report."""
    return [
        map_error_table(scope),
        distance_table(scope),
        exploration_time_table(scope),
        team_table(scope),
        *([merging_table(scope)] if scope.merges_judged else []),
        radio_table(scope),
        computing_table(scope),
    ]


def outcome_table(records: RecordSet) -> Table:
    rows = []
    for group, members in records.groups.items():
        counts = count_outcomes(members)
        rows.append(
            (*_group_cells(group), len(members), *(counts[status] for status in (FINISHED, UNFINISHED, FAILED)))
        )
    return Table(
        "outcomes",
        "Outcomes",
        "Unfinished: the mission reached its limit of time before every robot had declared its exploration "
        "finished. Failed: an engine or a node crashed, or the mission left no record. Nothing is left out of these "
        "counts.",
        (
            *_GROUP_COLUMNS,
            Column("trials", "trials"),
            Column("finished", "finished"),
            Column("unfinished", "unfinished"),
            Column("failed", "failed"),
        ),
        tuple(rows),
    )


def trouble_table(records: RecordSet) -> Table:
    """Every trial that did not finish, with its seed and reason."""
    rows = [
        (*_group_cells(Group.of(record)), record.asked.seed, outcome.status, outcome.time, outcome.reason)
        for record, outcome in ((record, record.outcome) for record in records.records)
        if not record.finished
    ]
    return Table(
        "not_finished",
        "Trials that did not finish",
        "Each can be repeated with its seed.",
        (
            *_GROUP_COLUMNS,
            Column("seed", "seed"),
            Column("status", "outcome", text=True),
            Column("time_s", "at / s", 1),
            Column("reason", "reason", text=True),
        ),
        tuple(rows),
    )


def trials_table(records: RecordSet) -> Table:
    """One row for each trial, for computing of one's own."""
    return Table(
        "trials",
        "Trials",
        "Distance, bytes and collisions are those of all robots together, the map error is the mean of their maps; "
        "merges count accepted transforms.",
        (
            *_GROUP_COLUMNS,
            Column("seed", "seed"),
            Column("status", "outcome", text=True),
            Column("exploration_time_s", "T / s", 1),
            Column("distance_m", "distance / m", 1),
            Column("map_error_percent", "e / %", 3),
            Column("overlap", "overlap", 3),
            Column("collisions", "collisions"),
            Column("merges", "merges"),
            Column("wrong_merges", "wrong"),
            Column("bytes_sent", "bytes"),
        ),
        tuple(_trial_row(record) for record in records.records),
    )


def _trial_row(record: MissionRecord) -> tuple[Cell, ...]:
    errors = record.map_errors
    merges = [merge for robot in record.robots.values() for merge in robot.merges or () if merge.accepted]
    return (
        *_group_cells(Group.of(record)),
        record.asked.seed,
        record.outcome.status,
        record.team.exploration_time,
        sum(robot.distance for robot in record.robots.values()),
        statistics.mean(errors) if errors else None,
        record.team.overlap,
        sum(robot.collisions.total for robot in record.robots.values()),
        len(merges) if record.merges_judged else None,
        sum(merge.right is False for merge in merges) if record.merges_judged else None,
        sum(robot.sent("bytes_sent") for robot in record.robots.values()),
    )


_GROUP_COLUMNS = (
    Column("world", "world", text=True),
    Column("scenario", "scenario", text=True),
    Column("strategy", "strategy", text=True),
    Column("odometry", "odometry", text=True),
    Column("robots", "R"),
)


def _group_cells(group: Group) -> tuple[Cell, ...]:
    return group.world, group.scenario, str(group.strategy), group.odometry, group.robots
