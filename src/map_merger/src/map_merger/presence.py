"""Whether a transform that the walls give also says where the other robot was seen.

Walls have copies and moving things may be anybody; that both agree is more than either. Something stood again and again
where, by the transform, the other robot drove at that time, and where by the own map nothing stands: then it was that
robot. Unless, in a building of copies, a third robot drove alike in the next copy: where one may have, the other robot
must have seen this one as well.
"""

from typing import NamedTuple, Tuple

import numpy as np

from mr_grid import Pose, values_at

from .meetings import Sightings
from .meetings.identity import is_empty, who_moves_alike, who_was_there
from .meetings.tracking import at_times
from .robot_size import RobotSize
from .surface import Landmarks

_ALIKE_M = 0.1
"""A laser sees surfaces, so the ways of robots that differ by less may be taken for one another."""
_BACK_M = 0.3
_REACH_M = 8.0
"""Farther away than where objects are told from one another: what stands at a given place is seen by few beams."""
_SAME_PLACE_M = 0.25
_FEWEST_POSES = 3
"""Of poses at which bodies would be in one another, whatever the exactness of the transform."""
FEWEST_SWEEPS = 8
SHORTEST_WAY_M = 0.4
"""What stands still may be a chair."""
LARGEST_EMPTY_SHARE = 0.1


class Presence(NamedTuple):
    """Own sweeps that show something where the other robot was, those that show nothing there, and the extent in m of
    the places at which something was seen."""

    there: int = 0
    empty: int = 0
    way: float = 0.0

    @property
    def confirms(self) -> bool:
        """True if the other robot drove where the transform says."""
        return (
            self.there >= FEWEST_SWEEPS
            and self.way >= SHORTEST_WAY_M
            and self.empty <= LARGEST_EMPTY_SHARE * self.there
        )


def is_refuted(sightings: Sightings, transform: Pose) -> bool:
    """True if by the transform (of the other robot's frame to the own one) both robots stood in the same place, or the
    own laser saw nothing where the other one was."""
    turn, shift = _between_tracks(sightings, transform)
    own, known = at_times(sightings.own, sightings.told[:, 0])
    apart = np.abs(turn * (sightings.told[:, 1:3] @ (1.0, 1j)) + shift - own)
    if int((known & (apart < _SAME_PLACE_M)).sum()) >= _FEWEST_POSES:
        return True
    told, known = at_times(sightings.told, sightings.sweeps.times)
    return is_empty(sightings.sweeps, turn * told + shift, known)


def presence_of(sightings: Sightings, viewer: Landmarks, transform: Pose, size: RobotSize) -> Presence:
    """What the own sweeps, in the map frame of `viewer`, show where the other robot was by `transform` (its frame to
    the own one). Where a further robot was that is placed says nothing."""
    sweeps = sightings.sweeps
    told, known = at_times(sightings.told, sweeps.times)
    turn, shift = _between_tracks(sightings, transform)
    places = turn * told + shift
    seen = sweeps.look(places, known, _REACH_M)
    there = seen.there.copy()
    there[there] = _far_from_walls(viewer, places[there], size.clearance)
    if there.any() and _may_be_another(sightings, transform, sweeps.times[there], places[there]):
        return Presence(0, int(seen.empty.sum()))
    return Presence(int(there.sum()), int(seen.empty.sum()), _extent(places[there]))


def _between_tracks(sightings: Sightings, transform: Pose) -> Tuple[complex, complex]:
    """Turn and shift from the frame of the other's track to that of the own one; where SLAM has jumped these are not
    the frames of the maps."""
    tracks = sightings.own_map.inverse().compose(transform).compose(sightings.told_map)
    return complex(np.exp(1j * tracks.yaw)), complex(tracks.x, tracks.y)


def _may_be_another(sightings: Sightings, transform: Pose, times: np.ndarray, places: np.ndarray) -> bool:
    placed = {
        name: (sightings.others[name], each) for name, each in sightings.placed.items() if name in sightings.others
    }
    if who_was_there(placed, times, places):
        return True
    unplaced = {name: track for name, track in sightings.others.items() if name not in placed}
    alike = who_moves_alike(unplaced, times, places, _ALIKE_M, sightings.sweeps)
    return bool(alike) and not _is_seen_back(sightings, transform)


def _is_seen_back(sightings: Sightings, transform: Pose) -> bool:
    """The other robot told of something again and again where, by the transform, the own one was."""
    turn, shift = _between_tracks(sightings, transform)
    count = 0
    for each in sightings.told_objects:
        own, known = at_times(sightings.own, each.samples[:, 0])
        seen = turn * (each.samples[:, 1] + 1j * each.samples[:, 2]) + shift
        count += int((known & (np.abs(seen - own) < _BACK_M)).sum())
    return count >= FEWEST_SWEEPS


def _far_from_walls(viewer: Landmarks, places: np.ndarray, clearance: float) -> np.ndarray:
    """Bool (n,): known, and nothing larger than a robot within `clearance` m, where the wall may have been seen."""
    known = values_at(viewer.known, viewer.info, np.column_stack([places.real, places.imag]), False)
    walls = viewer.surface.points[viewer.surface.solid] @ (1.0, 1j)
    far = known.copy()
    for index in np.flatnonzero(known):
        far[index] = not (np.abs(walls - places[index]) < clearance).any()
    return far


def _extent(places: np.ndarray) -> float:
    return float(np.hypot(np.ptp(places.real), np.ptp(places.imag))) if len(places) else 0.0
