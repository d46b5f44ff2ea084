"""The record of a trial: made from a mission, written as one JSON file."""

from __future__ import annotations

import json
import math
import os
import platform
import sys
import time
import traceback
from pathlib import Path
from typing import Any, Callable

import cv2
import numpy as np
import scipy

from mr_experiments.common.allocation import keep_freed_memory
from mr_experiments.common.code_version import code_version
from mr_experiments.common.ros_packages import version_of
from mr_experiments.host.mission import Mission
from mr_experiments.host.robot import Robot
from mr_experiments.trial.trial import Trial, TrialError
from mr_measures.figures import (
    collisions,
    coverage,
    explored_free_cells,
    moving_share,
    overlap_between_robots,
    wrong_walls,
)
from mr_measures.map_picture import picture_of
from mr_measures.occupancy import occupancy_of
from mr_measures.reference import VIRTUAL_TIME, MapReferenceError, error_of_map
from mr_sim.worlds import find_world

FORMAT = 1
SLAM = "ours"  # its name in the references of maps


def run_trial(
    trial: Trial, snapshot_period: float = math.inf, progress: Callable[[float], None] = lambda _: None
) -> dict[str, Any]:
    """The record of the trial. An engine that crashes makes a record of a failed trial; only a trial that cannot be
    run at all raises TrialError. `progress` is told the virtual time."""
    cv2.setNumThreads(1)  # so that every run takes the same steps, and a pool its own cores only
    keep_freed_memory()
    begun, cpu = time.time(), time.process_time()
    mission = Mission(trial, snapshot_period)
    failure = None
    try:
        mission.run(progress=progress)
    except TrialError:
        raise
    except Exception as error:
        failure = {"reason": f"{type(error).__name__}: {error}", "traceback": traceback.format_exc()}
    record = record_of(mission, failure)
    wall = time.time() - begun
    record["measured"] = {
        "wall": round(wall, 3),
        "cpu": round(time.process_time() - cpu, 3),
        "real_time_factor": round(mission.now / wall, 3) if wall > 0.0 else None,
        "cpu_by_component": {name: round(spent, 3) for name, spent in mission.stopwatch.seconds().items()},
        "host": platform.node(),
        "started": time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(begun)),
    }
    return record


def record_of(mission: Mission, failure: dict[str, str] | None) -> dict[str, Any]:
    """All but what was measured about the computer."""
    recorder = mission.recorder
    if mission.begun_at is not None:
        recorder.cover(mission.since_start)
    robots = {robot.name: _robot_part(mission, robot) for robot in mission.robots}
    status = "failed" if failure else "finished" if mission.finished else "unfinished"
    reason = failure["reason"] if failure else _unfinished(mission) if status == "unfinished" else ""
    outcome = {"status": status, "reason": reason, "time": round(mission.since_start, 3)}
    if failure:
        outcome["traceback"] = failure["traceback"]
    times = [part["finished_at"] for part in robots.values() if part["finished_at"] is not None]
    return {
        "format": FORMAT,
        "trial": mission.trial.to_json(),
        "versions": versions(),
        "outcome": outcome,
        "team": {
            "exploration_time": max(times) if status == "finished" and times else None,
            "overlap": round(overlap_between_robots(recorder.known_cells()), 5),
            "series": recorder.team,
            "trace": mission.radio.trace,
        },
        "robots": robots,
        "maps": {robot.name: _maps(mission, robot) for robot in mission.robots},
        "snapshots": recorder.snapshots,
        "notes": recorder.notes,
    }


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


def _robot_part(mission: Mission, robot: Robot) -> dict[str, Any]:
    recorder, log, agent = mission.recorder, mission.recorder.logs[robot.index], robot.explorer.agent
    begun = mission.begun_at or 0.0
    finished = None if agent.finished_at is None else round(agent.finished_at - begun, 3)
    truth = recorder.records(robot.index)
    begin = mission.trial.joins.get(robot.index, 0.0)
    end = finished if finished is not None else log.died_at if log.died_at is not None else mission.since_start
    task = truth[truth["time"] <= end] if len(truth) else truth
    hits = collisions(truth) if len(truth) else None
    return {
        "start": [round(value, 5) for value in recorder.starts[robot.index]],
        "finished_at": finished,
        "died_at": log.died_at,
        "state": agent.state.name.lower(),
        "distance": round(float(np.hypot(np.diff(task["x"]), np.diff(task["y"])).sum()), 4) if len(task) else 0.0,
        "moving": round(moving_share(truth, begin, max(begin, end)), 5) if len(truth) else 0.0,
        "stalled": round(log.stalled, 3),
        "collisions": {
            "walls": hits.with_walls if hits else 0,
            "robots": hits.with_robots if hits else 0,
            "times": [round(time, 3) for time in hits.times] if hits else [],
        },
        "map": _map_figures(mission, robot),
        "radio": mission.radio.statistics(robot.own_radio.index),
        "counters": {
            "bids": robot.explorer.bids,
            "auctions_completed": agent.counters.auctions_completed,
            "auctions_uncompleted": agent.counters.auctions_uncompleted,
            "goals": agent.counters.goals,
            "goals_reached": agent.counters.goals_reached,
            "goals_failed": agent.counters.goals_failed,
        },
        "goals": log.goals,
        "auctions": log.auctions,
        "merges": recorder.merges.entries[robot.name],
        "series": log.series,
    }


def _map_figures(mission: Mission, robot: Robot) -> dict[str, Any]:
    grid, start = mission.recorder.logs[robot.index].global_map, mission.recorder.starts[robot.index]
    if grid is None:
        return {}
    occupancy, truth = grid, mission.recorder.truth
    try:
        if mission.trial.fast:
            raise MapReferenceError("the reference is of maps that SLAM made")
        error, why = error_of_map(find_world(mission.trial.world), occupancy, SLAM, VIRTUAL_TIME)
    except MapReferenceError as fault:
        error, why = None, str(fault)
    return {
        "free_cells": explored_free_cells(occupancy),
        "error": None if error is None else round(error, 4),
        "error_reason": why,
        "coverage": round(coverage(truth, occupancy, start), 5),
        "wrong_walls": round(wrong_walls(truth, occupancy, start), 5),
    }


def _maps(mission: Mission, robot: Robot) -> dict[str, Any]:
    grid = mission.recorder.logs[robot.index].global_map
    maps = {} if grid is None else {"global": picture_of(grid)}
    if robot.local_map is not None:
        maps["local"] = picture_of(occupancy_of(robot.local_map))
    return maps


def versions() -> dict[str, str]:
    """Of what a record depends on."""
    return {
        "mr_experiments": version_of("mr_experiments"),
        "code": code_version(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "opencv": cv2.__version__,
        "byteorder": sys.byteorder,
    }


def write_record(record: dict[str, Any], path: Path) -> None:
    """Whole or not at all."""
    partial = path.with_suffix(".partial")
    partial.write_text(json.dumps(record, separators=(",", ":"), allow_nan=False) + "\n", encoding="utf-8")
    os.replace(partial, path)
