"""Where the other robots say they are, and which ground they are about to drive over."""

import math
from dataclasses import dataclass
from typing import Dict, List, Mapping, Tuple

import numpy as np

from mr_grid import Pose, is_place
from mr_robot import _navigation
from mr_robot.navigation.options import AT_REST, PROGRESS, REACH, STANDING, NavigationOptions, Scan

Point = Tuple[float, float]

# Unit vectors (12, 2) all around, for the rim of a robot.
CIRCLE = np.stack([np.cos(np.arange(12) * math.pi / 6.0), np.sin(np.arange(12) * math.pi / 6.0)], axis=1)


@dataclass(frozen=True)
class _Track:
    place: Point  # m, map frame
    at: float  # s
    velocity: Point  # m/s
    rest: Point  # m, where it has been
    rest_since: float  # s

    def after(self, seconds: float) -> Point:
        return (self.place[0] + seconds * self.velocity[0], self.place[1] + seconds * self.velocity[1])


class OtherRobots:
    """Hints: nothing depends on them being there or right."""

    def __init__(self, options: NavigationOptions, name: str) -> None:
        """`name`: of this robot, whose own position is no other's."""
        self._name = name
        self._tracks: Dict[str, _Track] = {}
        self._heard_at = -math.inf
        self._fastest = options.max_linear_velocity
        # s, when a robot is where it will be if it drives on: as long as motions look ahead
        self._soon = [share * options.horizon for share in (0.25, 0.5, 0.75, 1.0)]
        self._footprint = options.footprint
        self._radius, self._wall_margin = options.largest_robot_radius, options.obstacle_margin
        self._rim = round(options.largest_robot_radius - _navigation.TOUCHING, 3) * CIRCLE
        # m, from where on a robot will be nowhere near soon, with room for rounding.
        self._far = 2.0 * REACH + self._fastest * (STANDING + options.horizon)
        self._margins = (options.moving_margin, options.moving_reaction_time)

    def hear(self, positions: Mapping[str, Point], now: float) -> List[str]:
        """All that are known, map frame. The names of those whose position cannot be and is ignored."""
        usable = {name: place for name, place in positions.items() if is_place(*place)}
        self._tracks = {name: self._track(name, place, now) for name, place in usable.items() if name != self._name}
        self._heard_at = now
        return sorted(set(positions) - set(usable))

    def _track(self, name: str, place: Point, now: float) -> _Track:
        before = self._tracks.get(name)
        if before is None or now < before.at:
            return _Track(place, now, (0.0, 0.0), place, now)
        rests = math.dist(place, before.rest) < PROGRESS
        rest, since = (before.rest, before.rest_since) if rests else (place, now)
        seconds = now - before.at
        if place == before.place and seconds < STANDING:
            return before  # no news: positions of all robots come together
        if not 0.0 < seconds < STANDING:
            return _Track(place, now, (0.0, 0.0), rest, since)
        x, y = (place[0] - before.place[0]) / seconds, (place[1] - before.place[1]) / seconds
        share = min(1.0, self._fastest / max(math.hypot(x, y), 1e-9))
        return _Track(place, now, (share * x, share * y), rest, since)

    @property
    def places(self) -> List[Point]:
        """Where they said last that they are, however long ago."""
        return [track.place for track in self._tracks.values()]

    def lately(self, now: float) -> Mapping[str, Point]:
        """Where those are that said so lately."""
        known = self._tracks if now - self._heard_at < AT_REST else {}
        return {name: track.place for name, track in known.items()}

    def unseen(self, now: float, pose: Pose, scan: Scan) -> np.ndarray:
        """Rows (x, y, margin, reaction time), map frame: rims of robots where the laser is blind; of one with the right
        of way, whose name sorts earlier, also where it will be soon, so that one of two robots that drive towards the
        same place lets the other pass."""
        names = [
            name
            for name, place in self.lately(now).items()
            if math.dist(place, pose[:2]) < self._far and not self._is_here(place, pose)
        ]
        if not names:
            return np.empty((0, 4))
        places = np.array([place for name in names for place in self._ground_of(name, now)]).reshape(-1, 2)
        near = places[np.hypot(*(places - pose[:2]).T) < REACH]
        blind = near[scan.blind_to(pose.apply_inverse(near))] if len(near) else near
        rims = (blind[:, None, :] + self._rim[None, :, :]).reshape(-1, 2)
        return np.hstack([rims, np.tile(self._margins, (len(rims), 1))])

    def _is_here(self, place: Point, pose: Pose) -> bool:
        """Two bodies cannot be in one place: this is the robot itself under another name, or a wrong position."""
        return self._footprint.distance(*pose.inverse().apply_point(*place)) < 0.0

    def settle(self, obstacles: np.ndarray, now: float) -> np.ndarray:
        """Rows (x, y, margin, reaction time) in which robots at rest have the margin of walls, so that others find
        their way between those that are home."""
        places = [track.rest for track in self._tracks.values() if now - track.rest_since > AT_REST]
        for place in places:
            body = np.hypot(obstacles[:, 0] - place[0], obstacles[:, 1] - place[1]) < self._radius + self._margins[0]
            obstacles[body, 2] = np.minimum(obstacles[body, 2], self._wall_margin)
            obstacles[body, 3] = 0.0
        return obstacles

    def _ground_of(self, name: str, now: float) -> List[Point]:
        track = self._tracks[name]
        age = min(max(0.0, now - track.at), STANDING)
        soon = self._soon if name < self._name else ()
        return [track.place] + [track.after(age + seconds) for seconds in (0.0, *soon)]
