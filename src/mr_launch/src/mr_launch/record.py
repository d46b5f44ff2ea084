"""record.json: a mission of the ROS stack as `mr_measures.record` has it, so that reports, replays and comparisons take
it like one in virtual time. What the runner does not know is absent: goals, auctions, whether transforms are
right."""

from __future__ import annotations

from typing import Any, Mapping, Sequence

import numpy as np

from mr_grid import OccupancyGrid, Pose
from mr_launch.mission import Outcome
from mr_launch.plan import Plan, RobotPlan
from mr_launch.reports import RobotReport
from mr_launch.truth import Track, Truth
from mr_measures.knowledge import overlap_of, team_series
from mr_measures.map_picture import picture_of
from mr_measures.record import mission_record as schema
from mr_measures.record.mission_record import (
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
from mr_measures.record.robot_record import MapFigures, Merge, RobotRecord
from mr_measures.record.series import RobotSeries

SCENARIO = "ros_stack"
SERIES_PERIOD = 1.0  # s


def mission_record(
    plan: Plan,
    summary: Mapping[str, Any],
    outcome: Outcome,
    truth: Truth,
    grids: Mapping[str, OccupancyGrid],
    figures: Mapping[str, MapFigures],
    merges: Mapping[str, tuple[Merge, ...] | None],
    known: Mapping[str, np.ndarray],
) -> MissionRecord:
    """`summary`: as in summary.json; `grids`, `figures`: of the robots' global maps; `known`: since when each own map
    has known each reference cell, s of simulation time."""
    team = summary["team"]
    status = UNFINISHED if team["exploration_time"] is None else FINISHED
    return MissionRecord(
        Asked(_asked(plan)),
        schema.Outcome(status, round(max(0.0, outcome.end - outcome.start), 3), outcome.reason),
        _team(team["exploration_time"], known, plan, outcome),
        {
            robot.name: _robot(
                robot,
                summary["robots"][robot.name],
                outcome,
                truth.tracks[robot.name],
                figures[robot.name],
                merges[robot.name],
            )
            for robot in plan.robots
        },
        maps={name: RobotMaps(picture_of(grid)) for name, grid in grids.items()},
        notes=tuple(Note(0.0, "", note, True) for note in outcome.notes),
        measured=_measured(team, outcome.end - outcome.start),
    )


def _team(time: float | None, known: Mapping[str, np.ndarray], plan: Plan, outcome: Outcome) -> Team:
    """`time`: T. Without what one of the robots knew nothing is said of what they knew together."""
    if any(robot.name not in known for robot in plan.robots):
        return Team(time)
    since = [known[robot.name] for robot in plan.robots]
    return Team(time, overlap_of(since, outcome.end), team_series(since, outcome.start, outcome.end))


def merges_of(report: RobotReport, start: float, robots: Sequence[str]) -> tuple[Merge, ...] | None:
    """Transforms to robots of the team; `start`: of the mission, s of simulation time."""
    if report.merges is None:
        return None
    return tuple(
        Merge(
            entry["with"],
            round(max(0.0, entry["at"] - start), 3),
            None if entry["transform"] is None else Pose(*entry["transform"]),
        )
        for entry in report.merges
        if entry["with"] in robots
    )


def _measured(team: Mapping[str, Any], duration: float) -> Measured:
    """`duration`: s of simulation. Processor seconds of each kind of node, of all robots together."""
    factor = team["real_time_factor"]
    wall = duration / factor if factor else duration
    spent: dict[str, float] = {}
    for shares in team.get("cpu", {}).values():
        for node, share in shares.items():
            spent[node] = round(spent.get(node, 0.0) + share * wall, 3)
    return Measured(round(wall, 3), round(sum(spent.values()), 3), factor, spent)


def _asked(plan: Plan) -> dict[str, Any]:
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


def _robot(
    robot: RobotPlan,
    summary: Mapping[str, Any],
    outcome: Outcome,
    track: Track,
    figures: MapFigures,
    merges: tuple[Merge, ...] | None,
) -> RobotRecord:
    records = track.records(outcome.start, outcome.end).copy()
    records["time"] -= outcome.start
    finished_at = summary["time"]
    motion = motion_of(records, 0.0, outcome.end - outcome.start if finished_at is None else finished_at)
    return RobotRecord(
        start=Pose(*(round(value, 5) for value in robot.start)),
        distance=motion.distance,
        moving=motion.moving,
        finished_at=finished_at,
        state=summary["state"],
        stalled=motion.stalled,
        collisions=motion.collisions,
        map=figures,
        radio={name: value for name, value in summary["radio"].items() if isinstance(value, int)},
        counters={"goals_reached": summary["goals_reached"], "auctions_completed": summary["auctions"]},
        merges=merges,
        series=_series(records),
    )


def _series(records: np.ndarray) -> RobotSeries:
    """True motion once per second; `records`: times in s since the start of the mission."""
    if not records.size:
        return RobotSeries()
    chosen = np.searchsorted(records["time"], np.arange(0.0, float(records["time"][-1]) + 1e-9, SERIES_PERIOD))
    steps = np.hypot(np.diff(records["x"]), np.diff(records["y"]))
    rows, way = records[chosen], np.concatenate([[0.0], np.cumsum(steps)])[chosen]
    columns = {**{name: rows[name] for name in ("time", "x", "y", "yaw")}, "distance": way}
    return RobotSeries(**{name: tuple(values.round(4).tolist()) for name, values in columns.items()})
