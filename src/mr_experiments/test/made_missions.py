"""Mission records for tests of what reads them: finished, unless something else is said."""

from mr_grid import Pose
from mr_measures.record.mission_record import FINISHED, Asked, MissionRecord, Outcome, Team
from mr_measures.record.robot_record import RobotRecord


def made_robot(**changes):
    return RobotRecord(**{"start": Pose(1.0, 2.0, 0.0), "distance": 1.0, "moving": 0.8, **changes})


def made_mission(robots, status=FINISHED, time=100.0, reason="", settings=(), series=None, overlap=None, **parts):
    """`robots`: a list; `time`: T, or of the end if it did not finish; `settings`: that differ from the usual."""
    asked = {"world": "w", "robots": len(robots), "seed": 1, "scenario": "paper", "strategy": 7, "limit": 900.0}
    team = Team(time if status == FINISHED else None, overlap, **({"series": series} if series else {}))
    return MissionRecord(
        Asked({**asked, **dict(settings)}),
        Outcome(status, time, reason),
        team,
        {f"robot_{number}": robot for number, robot in enumerate(robots)},
        **parts,
    )
