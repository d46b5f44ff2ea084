"""The record of a trial, made from its mission."""

from __future__ import annotations

import math
import platform
import time
import traceback
from dataclasses import replace
from typing import Callable

import cv2

from mr_experiments.common.allocation import keep_freed_memory
from mr_experiments.host.mission import Mission
from mr_experiments.host.robot import Robot
from mr_experiments.trial.trial import Trial, TrialError
from mr_grid import Pose
from mr_measures.figures import overlap_between_robots
from mr_measures.map_picture import picture_of
from mr_measures.record.mission_record import (
    FAILED,
    FINISHED,
    UNFINISHED,
    Asked,
    Measured,
    MissionRecord,
    Outcome,
    RobotMaps,
    Team,
)
from mr_measures.record.parts import error_or_reason, map_figures_of, motion_of
from mr_measures.record.robot_record import MapFigures, RobotRecord
from mr_measures.record.versions import versions
from mr_measures.reference import VIRTUAL_TIME
from mr_sim.world_folders import world_folders
from mr_sim.worlds import find_world

SLAM = "ours"  # its name in the references of maps
NO_SLAM = "the reference is of maps that SLAM made"


def run_trial(
    trial: Trial, snapshot_period: float = math.inf, progress: Callable[[float], None] = lambda _: None
) -> MissionRecord:
    """The record of the trial. An engine that crashes makes a record of a failed trial; only a trial that cannot be
    run at all raises TrialError. `progress` is told the virtual time."""
    cv2.setNumThreads(1)  # so that every run takes the same steps, and a pool its own cores only
    keep_freed_memory()
    begun, cpu = time.time(), time.process_time()
    mission = Mission(trial, snapshot_period)
    failure: tuple[str, str] | None = None
    try:
        mission.run(progress=progress)
    except TrialError:
        raise
    except Exception as error:
        failure = f"{type(error).__name__}: {error}", traceback.format_exc()
    record = record_of(mission, failure)
    wall = time.time() - begun
    measured = Measured(
        round(wall, 3),
        round(time.process_time() - cpu, 3),
        round(mission.now / wall, 3) if wall > 0.0 else None,
        {name: round(spent, 3) for name, spent in mission.stopwatch.seconds().items()},
        platform.node(),
        time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(begun)),
    )
    return replace(record, measured=measured)


def record_of(mission: Mission, failure: tuple[str, str] | None) -> MissionRecord:
    """All but what was measured about the computer. `failure`: reason and traceback."""
    recorder = mission.recorder
    if mission.begun_at is not None:
        recorder.cover(mission.since_start)
    robots = {robot.name: _robot_part(mission, robot) for robot in mission.robots}
    status = FAILED if failure else FINISHED if mission.finished else UNFINISHED
    reason, trace = failure or (_unfinished(mission) if status == UNFINISHED else "", "")
    times = [part.finished_at for part in robots.values() if part.finished_at is not None]
    return MissionRecord(
        Asked(mission.trial.to_json()),
        Outcome(status, round(mission.since_start, 3), reason, trace),
        Team(
            max(times) if status == FINISHED and times else None,
            round(overlap_between_robots(recorder.known_cells()), 5),
            recorder.team_series,
            mission.radio.trace,
        ),
        robots,
        own_versions(),
        {robot.name: _maps(mission, robot) for robot in mission.robots},
        tuple(recorder.snapshots),
        tuple(recorder.notes.notes),
    )


def _unfinished(mission: Mission) -> str:
    if all(log.died_at is not None for log in mission.recorder.logs):
        return "no robot lives to the end"
    late = [
        robot
        for robot, log in zip(mission.robots, mission.recorder.logs)
        if robot.explorer.agent.finished_at is None and log.died_at is None
    ]
    states = "; ".join(f"{robot.name}: {robot.explorer.agent.text}" for robot in late)
    return f"limit of {mission.trial.limit:g} s reached: {states}"


def _robot_part(mission: Mission, robot: Robot) -> RobotRecord:
    recorder, log, agent = mission.recorder, mission.recorder.logs[robot.index], robot.explorer.agent
    begun = mission.begun_at or 0.0
    finished = None if agent.finished_at is None else round(agent.finished_at - begun, 3)
    end = finished if finished is not None else log.died_at if log.died_at is not None else mission.since_start
    motion = motion_of(recorder.records(robot.index), mission.trial.joins.get(robot.index, 0.0), end)
    return RobotRecord(
        start=Pose(*(round(value, 5) for value in recorder.starts[robot.index])),
        distance=motion.distance,
        moving=motion.moving,
        finished_at=finished,
        died_at=log.died_at,
        state=agent.state.name.lower(),
        stalled=motion.stalled,
        collisions=motion.collisions,
        map=_map_figures(mission, robot),
        radio=mission.radio.statistics(robot.own_radio.index),
        counters={
            "bids": robot.explorer.bids,
            "auctions_completed": agent.counters.auctions_completed,
            "auctions_uncompleted": agent.counters.auctions_uncompleted,
            "goals": agent.counters.goals,
            "goals_reached": agent.counters.goals_reached,
            "goals_failed": agent.counters.goals_failed,
            "unreachable_frontiers": agent.mission.unreachable_count(),
        },
        goals=tuple(log.goals.goals),
        auctions=tuple(log.auctions.auctions),
        merges=tuple(recorder.merges.entries[robot.name]),
        series=log.series,
    )


def _map_figures(mission: Mission, robot: Robot) -> MapFigures:
    grid, start = mission.recorder.logs[robot.index].global_map, mission.recorder.starts[robot.index]
    if grid is None:
        return MapFigures()
    if mission.trial.fast:
        return map_figures_of(grid, mission.recorder.truth, start, None, NO_SLAM)
    error, reason = error_or_reason(find_world(mission.trial.world), grid, SLAM, VIRTUAL_TIME)
    return map_figures_of(grid, mission.recorder.truth, start, error, reason)


def _maps(mission: Mission, robot: Robot) -> RobotMaps:
    merged, local = mission.recorder.logs[robot.index].global_map, robot.local_map
    return RobotMaps(None if merged is None else picture_of(merged), None if local is None else picture_of(local))


def own_versions() -> dict[str, str]:
    """Of what a record depends on."""
    return versions("mr_experiments", world_folders())
