"""Further tables of a chapter: team work, merging, radio traffic and computing."""

from __future__ import annotations

from typing import Iterable, Sequence

from mr_experiments.common.statistics import summarise
from mr_experiments.report.derived import all_merged_at, balance, mean, merges_at_end, moving_share, present
from mr_experiments.report.scope import ROBOTS, Scope
from mr_experiments.report.table import Cell, Column, Table
from mr_measures.record.mission_record import MissionRecord


def team_table(scope: Scope) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for robots in scope.teams:
        trials = scope.results(robots)
        moving = summarise(present(moving_share(trial) for trial in trials))
        rows.append(
            (
                robots,
                mean(trial.final_coverage for trial in trials),
                mean(trial.team.overlap for trial in trials) if robots > 1 else None,
                mean(balance(trial) for trial in trials) if robots > 1 else None,
                *((moving.mean, moving.low) if moving else (None, None)),
                mean(_sum(robot.collisions.walls for robot in trial.robots.values()) for trial in trials),
                mean(_sum(robot.collisions.robots for robot in trial.robots.values()) for trial in trials),
            )
        )
    return Table(
        "team",
        "Team work",
        "Means over missions. Coverage: share of the reference cells that the team knows at the end. Overlap: "
        "what the robots explored themselves, summed, over the union, minus 1. Balance: longest distance of a "
        "robot over the mean of its team. Moving: share of the time with a task in which a robot moves. "
        "Collisions are counted per mission.",
        (
            ROBOTS,
            Column("coverage_mean", "coverage", 3),
            Column("overlap_mean", "overlap", 2),
            Column("balance_mean", "balance", 2),
            Column("moving_mean", "mean", 2, "moving"),
            Column("moving_q05", "0.05", 2, "moving"),
            Column("collisions_with_walls_mean", "walls", 2, "collisions with"),
            Column("collisions_with_robots_mean", "robots", 2, "collisions with"),
        ),
        tuple(rows),
    )


def _sum(values: Iterable[int]) -> float:
    return float(sum(values))


def merging_table(scope: Scope) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for robots in scope.teams:
        trials = scope.results(robots)
        merges = [merge for trial in trials for robot in trial.robots.values() for merge in robot.merges or ()]
        accepted = [merge for merge in merges if merge.accepted]
        ends = [merges_at_end(trial) for trial in trials]
        times = present(all_merged_at(trial) for trial in trials) if robots > 1 else []
        summary = summarise(times)
        rows.append(
            (
                robots,
                sum(merge.right is True for merge in accepted),
                sum(merge.right is False for merge in accepted),
                len(merges) - len(accepted),
                sum(right for right, _ in ends),
                sum(wrong for _, wrong in ends),
                robots * (robots - 1) * len(trials),
                len(times),
                *((summary.median, summary.high) if summary else (None, None)),
            )
        )
    return Table(
        "merging",
        "Merging",
        "Transforms to other robots' maps, against ground truth, summed over missions. A transform may be "
        "replaced by a better one or revoked, so more may be accepted than there are pairs. Complete: every robot "
        "holds a transform to every other one; the time is that of the first such moment, over the missions that "
        "have one.",
        (
            ROBOTS,
            Column("accepted_right", "right", group="accepted"),
            Column("accepted_wrong", "wrong", group="accepted"),
            Column("revoked", "revoked"),
            Column("end_right", "right", group="at the end"),
            Column("end_wrong", "wrong", group="at the end"),
            Column("end_possible", "possible", group="at the end"),
            Column("complete_missions", "missions", group="complete"),
            Column("complete_at_s_median", "median / s", 1, "complete"),
            Column("complete_at_s_q95", "0.95 / s", 1, "complete"),
        ),
        tuple(rows),
    )


def radio_table(scope: Scope) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for robots in scope.teams:
        trials = scope.results(robots)
        members = [(robot, trial.outcome.time) for trial in trials for robot in trial.robots.values()]
        volume = summarise([robot.sent("bytes_sent") / 1000.0 for robot, _ in members])
        sent = sum(robot.sent("packets_sent") for robot, _ in members)
        rows.append(
            (
                robots,
                *((volume.mean, volume.high) if volume else (None, None)),
                mean(robot.sent("bytes_sent") / 1000.0 / time if time > 0 else None for robot, time in members),
                mean(float(robot.sent("frames_sent")) for robot, _ in members),
                sent,
                sum(robot.sent("packets_failed") for robot, _ in members),
            )
        )
    return Table(
        "radio",
        "Radio traffic",
        "What each robot sends over a mission: every frame on the air counts, forwarded ones and acknowledgments "
        "included. Packets are summed over all robots and missions; failed ones were given up.",
        (
            ROBOTS,
            Column("kilobytes_per_robot_mean", "mean", 1, "kB per robot"),
            Column("kilobytes_per_robot_q95", "0.95", 1, "kB per robot"),
            Column("kilobytes_per_second_mean", "kB/s per robot", 2),
            Column("frames_per_robot_mean", "frames per robot", 0),
            Column("packets_sent", "sent", group="packets"),
            Column("packets_failed", "failed", group="packets"),
        ),
        tuple(rows),
    )


def computing_table(scope: Scope) -> Table:
    """Columns are the components that any record of the chapter names."""
    shares = {robots: _component_shares(scope.results(robots)) for robots in scope.teams}
    components = list(dict.fromkeys(name for share in shares.values() for name in share))
    rows: list[tuple[Cell, ...]] = []
    for robots in scope.teams:
        trials = scope.results(robots)
        factors = summarise(present(trial.measured.real_time_factor for trial in trials))
        rows.append(
            (
                robots,
                *((factors.median, factors.low) if factors else (None, None)),
                mean(trial.measured.cpu for trial in trials),
                *(shares[robots].get(name) for name in components),
            )
        )
    return Table(
        "computing",
        "Computing",
        "Real-time factor: virtual time over wall time. Components: CPU time in ms per second of virtual time, "
        "for the whole team. These figures are measured and differ from run to run and from machine to machine.",
        (
            ROBOTS,
            Column("real_time_factor_median", "median", 1, "real-time factor"),
            Column("real_time_factor_q05", "0.05", 1, "real-time factor"),
            Column("cpu_s_mean", "CPU / s per mission", 1),
            *(Column(f"cpu_ms_per_s_{name}", name.replace("_", " "), 1, "CPU in ms per s") for name in components),
        ),
        tuple(rows),
    )


def _component_shares(trials: Sequence[MissionRecord]) -> dict[str, float]:
    """CPU time by component in ms per second of virtual time."""
    total = sum(trial.outcome.time for trial in trials)
    used: dict[str, float] = {}
    for trial in trials:
        for name, seconds in trial.measured.cpu_by_component.items():
            used[name] = used.get(name, 0.0) + seconds
    return {name: 1000.0 * seconds / total for name, seconds in used.items()} if total > 0 else {}
