"""record.json: a mission of the ROS stack in the form of the records of `mr_experiments`, so that its reports, replays
and comparisons take both. What the runner does not know is absent: goals, auctions, transforms, what the team knew over
time."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np

from mr_grid import OccupancyGrid
from mr_launch.mission import Outcome
from mr_launch.plan import Plan, RobotPlan
from mr_launch.truth import Track, Truth

FORMAT = 1
SCENARIO = "ros_stack"
SERIES_PERIOD = 1.0  # s


def mission_record(
    plan: Plan, summary: Mapping[str, Any], outcome: Outcome, truth: Truth, grids: Mapping[str, OccupancyGrid]
) -> dict[str, Any]:
    """`summary`: as in summary.json. Times in s since the start of the mission."""
    from mr_measures.map_picture import picture_of

    team = summary["team"]
    pictures = {name: {"global": picture_of(grid)} for name, grid in grids.items()}
    return {
        "format": FORMAT,
        "trial": _trial(plan),
        "versions": {},
        "outcome": {
            "status": "unfinished" if team["exploration_time"] is None else "finished",
            "reason": outcome.reason,
            "time": round(max(0.0, outcome.end - outcome.start), 3),
        },
        "team": {"exploration_time": team["exploration_time"], "overlap": None, "series": {}},
        "robots": {
            robot.name: _robot(robot, summary["robots"][robot.name], outcome, truth.tracks[robot.name])
            for robot in plan.robots
        },
        "maps": {robot.name: pictures.get(robot.name, {}) for robot in plan.robots},
        "snapshots": [],
        "notes": [{"at": 0.0, "robot": "", "text": note, "warning": True} for note in outcome.notes],
        "measured": _measured(team, outcome.end - outcome.start),
    }


def _measured(team: Mapping[str, Any], duration: float) -> dict[str, Any]:
    """`duration`: s of simulation. Processor seconds of each kind of node, of all robots together."""
    factor = team["real_time_factor"]
    wall = duration / factor if factor else duration
    spent: dict[str, float] = {}
    for shares in team.get("cpu", {}).values():
        for node, share in shares.items():
            spent[node] = round(spent.get(node, 0.0) + share * wall, 3)
    return {
        "wall": round(wall, 3),
        "cpu": round(sum(spent.values()), 3),
        "real_time_factor": factor,
        "cpu_by_component": spent,
    }


def _trial(plan: Plan) -> dict[str, Any]:
    options = plan.options
    return {
        "world": options.world,
        "robots": len(plan.robots),
        "seed": options.seed,
        "scenario": SCENARIO,
        "strategy": options.strategy,
        "limit": options.duration,
        "fast": False,
        "radio": {"range": options.range, "loss": options.loss, "wall_attenuation": options.wall_attenuation},
        "odometry": options.odometry,
        "topology": options.topology,
        "slam": options.slam,
        "navigation": options.navigation,
        "real_time_factor": options.rtf,
    }


def _robot(robot: RobotPlan, summary: Mapping[str, Any], outcome: Outcome, track: Track) -> dict[str, Any]:
    from mr_measures.figures import collisions, distance_driven

    finished_at = summary["time"]
    until = outcome.end if finished_at is None else outcome.start + finished_at
    records = track.records(outcome.start, outcome.end)
    hits = collisions(records)
    figures = {"free_cells": "free_cells", "error": "map_error", "error_reason": "map_error_reason",
               "coverage": "coverage", "wrong_walls": "wrong_walls"}  # fmt: skip
    return {
        "start": [round(value, 5) for value in robot.start],
        "finished_at": finished_at,
        "died_at": None,
        "state": summary["state"],
        "distance": round(distance_driven(track.records(outcome.start, until)), 4),
        "moving": summary["moving"],
        "stalled": summary["stalled_time"],
        "collisions": {
            "walls": hits.with_walls,
            "robots": hits.with_robots,
            "times": [round(time - outcome.start, 3) for time in hits.times],
        },
        "map": {name: summary[key] for name, key in figures.items() if key in summary},
        "radio": {name: value for name, value in summary["radio"].items() if isinstance(value, int)},
        "counters": {"goals_reached": summary["goals_reached"], "auctions_completed": summary["auctions"]},
        "series": _series(records, outcome.start),
    }


def _series(records: np.ndarray, start: float) -> dict[str, list[float]]:
    """True motion once per second."""
    if not records.size:
        return {}
    chosen = np.searchsorted(records["time"], np.arange(start, float(records["time"][-1]) + 1e-9, SERIES_PERIOD))
    steps = np.hypot(np.diff(records["x"]), np.diff(records["y"]))
    way = np.concatenate([[0.0], np.cumsum(steps)])
    rows = records[chosen]
    columns = {
        "time": rows["time"] - start,
        "x": rows["x"],
        "y": rows["y"],
        "yaw": rows["yaw"],
        "distance": way[chosen],
    }
    return {name: [round(float(value), 4) for value in values] for name, values in columns.items()}
