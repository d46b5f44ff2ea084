"""record.json: a mission of the ROS stack as `mr_measures.record` has it, so that reports, replays and comparisons take
it like one in virtual time. What the runner does not know is absent: maps on the way, and a hash of all frames."""

from __future__ import annotations

import platform
import time
from dataclasses import dataclass, replace
from typing import Mapping, Sequence

import numpy as np

from mr_grid import OccupancyGrid, Pose
from mr_launch.begun import asked_settings
from mr_launch.judging import Judge, Witness
from mr_launch.mission import Outcome
from mr_launch.plan import Plan, RobotPlan
from mr_launch.reports import RobotReport
from mr_launch.robot_log import RobotLog
from mr_launch.truth import Track
from mr_measures.knowledge import overlap_of, team_series
from mr_measures.map_picture import picture_of
from mr_measures.record import mission_record as schema
from mr_measures.record.logs import NoteLog
from mr_measures.record.mission_record import (
    FAILED,
    FINISHED,
    UNFINISHED,
    Asked,
    Measured,
    MissionRecord,
    Note,
    RobotMaps,
    Team,
)
from mr_measures.record.parts import motion_of
from mr_measures.record.robot_record import MapFigures, RobotRecord
from mr_measures.record.series import RobotSeries, TeamSeries

MAP_IS_LOST = {"slam", "roslaunch"}  # if one of them ends: that of its robot
Processors = Mapping[str, Mapping[str, float]]  # shares of a core by robot and process


@dataclass(frozen=True)
class Course:
    """What is known of one robot at the end. `known`: since when its own map has known each reference cell, s of
    simulation time; None where nobody looked."""

    plan: RobotPlan
    report: RobotReport
    log: RobotLog
    track: Track
    figures: MapFigures
    merged: OccupancyGrid | None = None
    own: OccupancyGrid | None = None
    known: np.ndarray | None = None


@dataclass(frozen=True)
class Seen:
    """What the runner has seen. `courses`: of all robots, in the plan's order; `base`: what the base station told, if
    there is one; `reference`: (N, 2) the reference cells, m, world frame, None if nobody computed them."""

    courses: Sequence[Course]
    base: RobotLog | None = None
    reference: np.ndarray | None = None


@dataclass(frozen=True)
class Ran:
    """How it ran on the computer. `begun`: s since the epoch."""

    begun: float
    cpu: Processors
    real_time_factor: float | None


def mission_record(
    plan: Plan,
    outcome: Outcome,
    seen: Seen,
    ran: Ran,
    versions: Mapping[str, str],
) -> MissionRecord:
    courses, judge = seen.courses, _judge_of(seen, outcome)
    robots = {course.plan.name: _robot(course, outcome, plan, judge) for course in courses}
    ends = [robot.finished_at for robot in robots.values()]
    complete = bool(ends) and None not in ends and not outcome.failed
    exploration_time = max(end for end in ends if end is not None) if complete else None
    status = FAILED if outcome.failed else FINISHED if complete else UNFINISHED
    duration = max(0.0, outcome.end - outcome.start)
    return MissionRecord(
        Asked(asked_settings(plan)),
        schema.Outcome(status, round(duration, 3), outcome.reason),
        _team(exploration_time, robots, seen, outcome),
        robots,
        versions,
        maps={course.plan.name: _maps(course) for course in courses if course.merged is not None},
        notes=_notes(plan, seen, outcome),
        restarts={name: dict(counts) for name, counts in outcome.restarts.items() if counts},
        measured=_measured(ran, duration),
    )


def _judge_of(seen: Seen, outcome: Outcome) -> Judge:
    """Of robots whose map was lost on the way, with SLAM or with all of them, there is no witness."""
    witnesses = {
        course.plan.name: Witness(course.plan.start, course.log.poses, course.track.at, course.known)
        for course in seen.courses
        if course.known is not None and not MAP_IS_LOST & outcome.restarts.get(course.plan.name, {}).keys()
    }
    nowhere = np.zeros((0, 2))
    return Judge(nowhere, {}) if seen.reference is None else Judge(seen.reference, witnesses)


def _robot(course: Course, outcome: Outcome, plan: Plan, judge: Judge) -> RobotRecord:
    report, log, start = course.report, course.log, outcome.start
    finished_at = None
    if report.exploration_finished:
        finished_at = round(report.exploration_time + report.start_time - start, 3)
    records = course.track.records(start, outcome.end).copy()
    records["time"] -= start
    motion = motion_of(records, 0.0, outcome.end - start if finished_at is None else finished_at)
    merges = log.merges(start, [robot.name for robot in plan.robots])
    return RobotRecord(
        start=Pose(*(round(value, 5) for value in course.plan.start)),
        distance=motion.distance,
        moving=motion.moving,
        finished_at=finished_at,
        state=report.state_name,
        stalled=motion.stalled,
        collisions=motion.collisions,
        map=course.figures,
        radio=report.radio,
        counters={
            "bids": report.bids,
            "auctions_completed": report.auctions,
            "auctions_uncompleted": report.auctions_uncompleted,
            "goals": report.goals,
            "goals_reached": report.goals_reached,
            "goals_failed": report.goals_failed,
            "unreachable_frontiers": report.unreachable,
        },
        goals=log.goals(start),
        auctions=log.auctions(start),
        merges=judge.judge(course.plan.name, merges, start) if report.sees_merges else None,
        series=log.series(start, records),
    )


def _team(exploration_time: float | None, robots: Mapping[str, RobotRecord], seen: Seen, outcome: Outcome) -> Team:
    """Without what one of the robots knew nothing is said of what they knew together."""
    since = [course.known for course in seen.courses if course.known is not None]
    if not since or len(since) < len(seen.courses):
        return Team(exploration_time)
    series = _with_sums(team_series(since, outcome.start, outcome.end), [robot.series for robot in robots.values()])
    if seen.base is not None and series.bytes:
        series = _with_base(series, seen.base, outcome.start)
    return Team(exploration_time, overlap_of(since, outcome.end), series)


def _with_base(team: TeamSeries, base: RobotLog, start: float) -> TeamSeries:
    """With what the base station has sent by its times."""
    told = base.samples_at(start + np.array(team.time))
    return replace(
        team,
        bytes=tuple(total + sample.bytes for total, sample in zip(team.bytes, told)),
        frames=tuple(total + sample.frames for total, sample in zip(team.frames, told)),
    )


def _with_sums(team: TeamSeries, robots: Sequence[RobotSeries]) -> TeamSeries:
    """With what all robots together have driven and sent by its times."""
    if not all(robot.time for robot in robots):
        return team
    sums = {}
    for name in ("distance", "bytes", "frames"):
        columns = [(np.array(robot.time), np.array(getattr(robot, name))) for robot in robots]
        total = sum(
            column[np.maximum(np.searchsorted(times, team.time, side="right") - 1, 0)] for times, column in columns
        )
        sums[name] = tuple(np.asarray(total).round(4).tolist())
    return TeamSeries(team.time, team.explored, team.coverage, **sums)


def _maps(course: Course) -> RobotMaps:
    merged, own = course.merged, course.own
    return RobotMaps(None if merged is None else picture_of(merged), None if own is None else picture_of(own))


def _notes(plan: Plan, seen: Seen, outcome: Outcome) -> tuple[Note, ...]:
    """Those of the runner, then those of all robots and of the base by time."""
    log = NoteLog()
    told = [note for course in seen.courses for note in course.log.notes(outcome.start, course.plan.name)]
    if seen.base is not None and plan.base is not None:
        told += seen.base.notes(outcome.start, plan.base.name)
    for note in [*(Note(0.0, "", text, True) for text in outcome.notes), *sorted(told, key=lambda note: note.at)]:
        log.add(note)
    return tuple(log.notes)


def _measured(ran: Ran, duration: float) -> Measured:
    """`duration`: s of simulation. Processor seconds of each kind of node, of all robots together and of each."""
    factor = ran.real_time_factor
    wall = duration / factor if factor else duration
    by_host = {
        host: {process: round(share * wall, 3) for process, share in shares.items()} for host, shares in ran.cpu.items()
    }
    spent: dict[str, float] = {}
    for processes in by_host.values():
        for process, seconds in processes.items():
            spent[process] = round(spent.get(process, 0.0) + seconds, 3)
    rounded = None if factor is None else round(factor, 3)
    started = time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(ran.begun))
    cpu = round(sum(spent.values()), 3)
    return Measured(round(wall, 3), cpu, rounded, spent, platform.node(), started, by_host)
