"""The record of a mission that begins, and the settings that every record of it names."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Mapping

from mr_launch.plan import Plan
from mr_measures.record.mission_record import FAILED, STACK, Asked, MissionRecord, Outcome

NO_END = "the runner was ended before it could write what became of the mission, or it still runs"


def write_begun(plan: Plan) -> None:
    """The record of a mission that begins; whoever counts missions finds it, however this one ends."""
    from mr_launch.world import project_worlds  # what these need is slow to import
    from mr_measures.record.files import STACK_RECORD, write_record
    from mr_measures.record.versions import versions

    write_record(begun_record(plan, versions("mr_launch", project_worlds())), Path(plan.out) / STACK_RECORD)


def begun_record(plan: Plan, versions: Mapping[str, str]) -> MissionRecord:
    """Of a mission that has only been asked for: what is left of it if its runner does not come to its end."""
    return MissionRecord(Asked(asked_settings(plan)), Outcome(FAILED, 0.0, NO_END), versions=versions)


def asked_settings(plan: Plan) -> dict[str, Any]:
    """Settings, and worlds, have the names that they have in virtual time."""
    from mr_sim.world_names import name_of

    options = plan.options
    return {
        "world": name_of(options.world),
        "robots": len(plan.robots),
        "seed": options.seed,
        "scenario": STACK,
        "strategy": options.strategy,
        "limit": options.duration,
        "time_limit": options.time_limit,
        "distance_limit": options.distance_limit,
        "fast": False,
        "radio": {
            "range": options.range,
            "loss": options.loss,
            "wall_attenuation": options.wall_attenuation,
            "sealed": not options.open,
        },
        "known_poses": options.initial_poses,
        "starts": [list(robot.start) for robot in plan.robots] if options.starts else [],
        "topology": options.topology,
        "base": None if plan.base is None else list(plan.base.start[:2]),
        "odometry": options.odometry,
        "slam": options.slam,
        "navigation": options.navigation,
        "real_time_factor": options.rtf,
        "isolation": plan.isolation,
        "respawn": options.respawn,
        "bag": options.bag,
    }
