"""What people and programs are told: notes, positions, status, figures. Nothing here decides."""

import math
from typing import List, Mapping, NamedTuple, Optional

from mr_grid import OccupancyGrid, Pose

from .alignment import Alignment
from .confidence import confidence_of
from .effects import Effect, Note, PublishPositions, PublishTrack
from .graph.team import Placement
from .grid import free_cells
from .options import Options
from .registration import Registration, Verdict
from .status import RobotPlacement
from .whereabouts import Whereabouts

POSITION_AGE_S = 30.0
MOST_MARKERS = 500


class LogFigures(NamedTuple):
    """What a line of periodical.log holds (contract 2.7)."""

    global_free: int
    local_free: int
    x: float
    y: float
    updates_sent: int
    transforms: int


def figures_of(
    merged: Optional[OccupancyGrid], local: Optional[OccupancyGrid], pose: Optional[Pose], updates: int, transforms: int
) -> LogFigures:
    """Figures for the log."""
    pose = pose or Pose()
    free = [0 if grid is None else int(free_cells(grid).sum()) for grid in (merged, local)]
    return LogFigures(free[0], free[1], pose.x, pose.y, updates, transforms)


def positions_of(
    options: Options, whereabouts: Whereabouts, transforms: Mapping[str, Pose], now: float
) -> PublishPositions:
    """Where everybody is, own frame."""
    longest = max(POSITION_AGE_S, 10.0 * options.seconds_send_position)
    return PublishPositions(whereabouts.places(transforms, now, longest))


def tracks_of(options: Options, whereabouts: Whereabouts, transforms: Mapping[str, Pose]) -> List[Effect]:
    """Where everybody has been, own frame."""
    effects: List[Effect] = [PublishTrack(options.robot_name, whereabouts.own_track.points()[-MOST_MARKERS:])]
    for name, transform in transforms.items():
        effects.append(PublishTrack(name, transform.apply(whereabouts.track(name).points()[-MOST_MARKERS:])))
    return effects


def news_of(robot: str, news: str, alignment: Alignment, result: Registration) -> List[Effect]:
    """What became of a registration, in words."""
    if news == "revoked":
        return [Note(f"transform to {robot} revoked: {alignment.reason}", warning=True)]
    if news in ("accepted", "moved"):
        verb = "is" if news == "accepted" else "moved to"
        wall = f"{result.evidence.matched:.1f} m of wall in both maps"
        seen = ", seen" if result.met else ""
        return [Note(f"transform to {robot} {verb} {described(alignment.transform)}, {wall}{seen}")]
    return []


def beyond_limits(robot: str, result: Registration) -> Optional[str]:
    """The warning about a transform that was found and refused for the limits; None if that was not so."""
    if result.verdict is not Verdict.BEYOND_LIMITS:
        return None
    return (
        f"transform to {robot} found ({described(result.transform)}) but refused by max_trans_robots or "
        f"max_rotation_robots; -1 lifts a limit"
    )


def placement_of(
    robot: str, placement: Optional[Placement], alignment: Alignment, why: str, age: float, octets: int
) -> RobotPlacement:
    """One robot of the status. why: the reason if it is not placed."""
    if placement is None:
        return RobotPlacement(robot, why, age=age, bytes_received=octets)
    belief = alignment.belief
    wall = 0.0 if belief is None else belief.evidence.matched
    via = placement.via[0] if placement.via else ""
    if via or belief is None:
        why = f"through {via}" if via else f"told by {robot}"
    else:
        why = "seen, " * belief.met + f"shared wall {wall:.1f} m"
    confidence = confidence_of(placement.covariance)
    return RobotPlacement(robot, why, placement.transform, via, placement.covariance, confidence, wall, age, octets)


def described(transform: Optional[Pose]) -> str:
    """A transform for people."""
    if transform is None:
        return "none"
    return f"x {transform.x:.2f} m, y {transform.y:.2f} m, {math.degrees(transform.yaw):.1f} deg"
