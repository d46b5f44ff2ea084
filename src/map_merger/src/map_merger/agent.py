"""The agent of one robot: local map, messages and time in, effects out. It knows no ROS, clock, thread or socket."""

import math
from collections import deque
from typing import Deque, Dict, Iterable, List, NamedTuple, Optional, Sequence, Set, Tuple

import numpy as np

from . import fusion
from .alignment import Job, LandmarkCache, Member, Versioned
from .effects import (
    GROUP_PREFIX,
    AskNeighbors,
    BroadcastTransforms,
    Effect,
    Note,
    Place,
    PublishMap,
    PublishPositions,
    PublishTrack,
    Purpose,
    Register,
    Send,
)
from .exchange import Exchange
from .grid import Grid, GridInfo
from .messages import Anchor, Boot, Payload, Position, Request, Tile
from .options import Options
from .peer import HeardPose, Peer, Track
from .registration import Limits, Prior, Registration, Verdict
from .sighting import LONGEST_LAG_S, LONGEST_MAP_LAG_S, Sighting, View, moved, nowhere, view_of
from .timer import Timer
from .transform import FARTHEST_M, Transform, rotation_between

NEIGHBOR_QUESTION_S = 5.0
"""Seconds after the start at which the neighbours are asked for (contract 2.4)."""
TRANSFORM_PERIOD_S = 0.5
SHORTEST_PUBLISH_S = 1.0
"""New local maps are passed on at once, but not more often than this."""
SHORTEST_VIEW_S = 1.0
"""Another robot's map, which comes in parts, is looked at this often for the own robot."""
POSITION_AGE_S = 30.0
BASE_LOST_S = 60.0
"""A base station that has merged nothing takes another reference when the present one is lost, or without map, for so
long."""
MOST_MARKERS = 500
MOST_POSES = 32
"""Own poses of the last seconds that are kept."""


class NoTransform(LookupError):
    """A point cannot be transformed; the text says why."""


class LogFigures(NamedTuple):
    """What a line of periodical.log holds (contract 2.7)."""

    global_free: int
    local_free: int
    x: float
    y: float
    updates_sent: int
    transforms: int


class Agent:
    """One robot's map merger. Every `on_...` call and `tick` takes the present time in seconds; then collect
    `effects()`."""

    def __init__(self, options: Options, boot: Boot) -> None:
        """`boot` names this run (see messages.Boot)."""
        self._options = options
        self.name = options.robot_name
        self.exchange = Exchange(options, boot)
        """The own map's way to others and theirs to here; for reading."""
        self._peers: Dict[str, Peer] = {}
        self._effects: List[Effect] = []
        self._local: Optional[Grid] = None
        self._local_version = 0
        self._global: Optional[Grid] = None
        self._base: Optional[str] = None
        self._base_lost: Optional[float] = None
        self._own_pose: Optional[Transform] = None
        self._own_track = Track()
        self._own_poses: Deque[Tuple[float, Transform]] = deque(maxlen=MOST_POSES)
        self._view: Optional[View] = None
        self._view_time = -math.inf
        self._layers: Dict[str, Tuple[tuple, Optional[fusion.Layer]]] = {}
        self._cache = LandmarkCache()
        self._registering = False
        self._sends = 0
        self._position_outstanding = False
        self._warned: Set[Tuple[str, str]] = set()
        self._changed_local, self._changed_foreign = False, False
        self._asked_neighbors = False
        self._publish_timer = Timer(options.seconds_pub_timer, options.seconds_pub_timer)
        self._local_timer = Timer(SHORTEST_PUBLISH_S)
        self._position_timer = Timer(options.seconds_send_position)
        self._transform_timer = Timer(TRANSFORM_PERIOD_S)
        self._question_timer = Timer(NEIGHBOR_QUESTION_S, NEIGHBOR_QUESTION_S)

    # What comes in

    def on_local_map(self, grid: Grid, now: float) -> None:
        """The local SLAM map changed. Ignored in base station mode."""
        if not self._options.has_local_map:
            return
        if self.exchange.on_local_map(grid):
            self._set_local(grid, now)

    def on_local_pose(self, pose: Transform, now: float) -> None:
        """The robot's pose in its map frame."""
        self._own_pose = pose
        self._own_track.add(pose.x, pose.y, now)
        self._own_poses.append((now, pose))

    def on_robot(self, name: str, now: float, returned: bool = False) -> None:
        """A robot is there. `returned`: the radio announced it anew (new_robot), so what was sent last may be lost."""
        self.exchange.on_robot(name, now, returned)
        self._peer(name)

    def on_robot_lost(self, name: str, now: float) -> None:
        """The radio lost the robot. Its map and transform stay."""
        self.exchange.on_robot_lost(name)

    def on_anchor(self, anchor: Anchor, now: float) -> None:
        """A robot announced its anchor."""
        self.exchange.on_anchor(anchor, now)
        self._follow(anchor.robot, now)

    def on_tile(self, tile: Tile, now: float) -> None:
        """Map cells of another robot arrived."""
        self.exchange.on_tile(tile, now)
        self._follow(tile.robot, now)

    def on_request(self, request: Request, now: float) -> None:
        """A robot asks for updates: none listed = everything, first one -1 = ignore (contract 2.4)."""
        self.exchange.on_request(request, now)

    def on_position(self, position: Position, now: float) -> None:
        """A robot told its pose."""
        peer = self._peer(position.robot)
        if peer is None or not self._options.exchange_position:
            return
        self.exchange.on_heard(peer.name)
        peer.position = HeardPose(position.pose, now)
        peer.track.add(position.pose.x, position.pose.y, now)
        self._look_for(peer, now)

    def on_sent(
        self,
        send: Send,
        delivered: bool,
        now: float,
        too_large: Optional[Tile] = None,
        undelivered: Sequence[Payload] = (),
    ) -> None:
        """The host finished a Send; see `Exchange.on_sent`."""
        if send.purpose is Purpose.POSITION:
            self._position_outstanding = False
        else:
            self.exchange.on_sent(send, delivered, now, too_large, undelivered)

    def on_registered(self, effect: Register, result: Registration, now: float) -> None:
        """The host finished a registration."""
        self._registering = False
        peer = self._peers.get(effect.job.robot)
        if peer is None or peer.generation != effect.generation:
            return
        before = peer.alignment.transform
        news = peer.alignment.finished(result)
        if news:
            # They have served, and if they misled they would do so again.
            peer.forget_sightings()
        if peer.alignment.transform != before:
            self._changed_foreign = True
        if news == "accepted":
            self._note(
                f"transform to {peer.name}: {_described(peer.alignment.transform)}, "
                f"{result.evidence.matched:.1f} m of wall in both maps"
            )
        elif news == "revoked":
            self._warn(f"transform to {peer.name} revoked: {result.verdict.value}")
        if result.verdict is Verdict.BEYOND_LIMITS:
            self._warn_once(
                "limits",
                peer.name,
                f"transform to {peer.name} found ({_described(result.transform)}) but refused by max_trans_robots or "
                f"max_rotation_robots; -1 lifts a limit",
            )

    # What goes out

    def tick(self, now: float) -> None:
        """Does what is due."""
        if not self._asked_neighbors and self._question_timer.fires(now):
            self._asked_neighbors = True
            self._effects.append(AskNeighbors())
        self.exchange.tick(now)
        if self._options.exchange_position and self._position_timer.fires(now):
            self._send_position(now)
        for name in self.exchange.robots():
            self._follow(name, now)
        if self._base is not None:
            self._reconsider_base(self._base, now)
        self._start_registration(now)
        self._publish(now)
        if self._transform_timer.fires(now):
            self._broadcast()

    def effects(self) -> List[Effect]:
        """What is to be done since the last call."""
        effects, self._effects = self.exchange.effects() + self._effects, []
        return effects

    # What others ask

    @property
    def local_map(self) -> Optional[Grid]:
        """The local map, in base station mode that of the adopted robot."""
        return self._local

    @property
    def global_map(self) -> Optional[Grid]:
        """The global map as published last."""
        return self._global

    def transforms(self) -> Dict[str, Transform]:
        """Believed transforms of the others' map frames to the own one."""
        return {
            name: peer.alignment.transform
            for name, peer in sorted(self._peers.items())
            if peer.alignment.transform is not None
        }

    def verdict(self, robot: str) -> str:
        """Why there is (no) transform to the robot."""
        return self._peers[robot].alignment.verdict.value if robot in self._peers else "robot not known"

    def transform_point(self, robot: str, x: float, y: float) -> Tuple[float, float]:
        """A point of the robot's map frame in the own one, metres. NoTransform while the transform is not known."""
        if not (abs(x) <= FARTHEST_M and abs(y) <= FARTHEST_M):
            raise NoTransform(f"point ({x:g}, {y:g}) is not finite or farther than {FARTHEST_M:g} m away")
        if robot in (self.name, self._base):
            return x, y
        if robot not in self._peers:
            raise NoTransform(f"no transform to {robot or 'the empty name'}: this robot is not known")
        transform = self._peers[robot].alignment.transform
        if transform is None:
            raise NoTransform(f"no transform to {robot} yet: {self.verdict(robot)}")
        return transform.apply_point(x, y)

    def log_figures(self) -> LogFigures:
        """Figures for the log."""
        pose = self._own_pose or Transform()
        return LogFigures(
            0 if self._global is None else int(self._global.free.sum()),
            0 if self._local is None else int(self._local.free.sum()),
            pose.x,
            pose.y,
            self.exchange.updates,
            len(self.transforms()),
        )

    # Robots

    def _peer(self, name: str) -> Optional[Peer]:
        if not self.exchange.meet(name):
            return None
        if name not in self._peers:
            self._peers[name] = Peer(name)
        return self._peers[name]

    def _follow(self, name: str, now: float) -> None:
        """Takes over what changed in the map of a robot."""
        peer, run, version = self._peer(name), self.exchange.run_of(name), self.exchange.version_of(name)
        if peer is None or version == peer.version:
            return
        peer.version = version
        self._changed_foreign = True
        if run != peer.run:
            if peer.run:
                peer.restart()
                if name == self._base:
                    self._forget_frame()
            peer.run = run
        self._adopt_base(peer, now)

    def _send_position(self, now: float) -> None:
        if self._own_pose is not None and self._options.has_local_map and not self._position_outstanding:
            self._sends += 1
            self._position_outstanding = True
            position = Position(self.name, self._own_pose)
            self._effects.append(Send(self._sends, Purpose.POSITION, GROUP_PREFIX + self.name, (position,)))
        places = tuple(self._places(now))
        self._effects.append(PublishPositions(places))
        self._effects.append(PublishTrack(self.name, self._own_track.points()[-MOST_MARKERS:]))
        for name, transform in self._transforms_with_base().items():
            self._effects.append(PublishTrack(name, transform.apply(self._peers[name].track.points()[-MOST_MARKERS:])))

    # Base station

    def _adopt_base(self, peer: Peer, now: float) -> None:
        if self._options.has_local_map:
            return
        grid = self.exchange.map_of(peer.name)
        if self._base is None and grid is not None:
            self._base = peer.name
            self._note(f"base station: the map of {peer.name} is the reference")
        if self._base == peer.name and grid is not None:
            self._set_local(grid, now)

    def _reconsider_base(self, base: str, now: float) -> None:
        if self.transforms() or (self.exchange.present(base) and self.exchange.map_of(base) is not None):
            self._base_lost = None
            return
        if self._base_lost is None or now < self._base_lost:
            self._base_lost = now
        others = [name for name in self.exchange.robots() if name != base and self.exchange.present(name)]
        others = [name for name in others if self.exchange.map_of(name) is not None]
        if others and now - self._base_lost >= BASE_LOST_S:
            self._note(f"base station: {base}, whose map was the reference, is lost")
            self._base, self._base_lost = None, None
            self._forget_frame()
            self._adopt_base(self._peers[others[0]], now)

    def _forget_frame(self) -> None:
        """The reference robot has a new frame, so no transform into the former one and nothing drawn in it holds."""
        for peer in self._peers.values():
            peer.forget_transform()
        self._local, self._global, self._view, self._layers = None, None, None, {}

    def _transforms_with_base(self) -> Dict[str, Transform]:
        transforms = self.transforms()
        if self._base is not None:
            transforms[self._base] = Transform()
        return transforms

    def _set_local(self, grid: Grid, now: float) -> None:
        self._local = grid
        self._local_version += 1
        self._changed_local = True
        self._view, self._view_time = None, now
        for peer in self._peers.values():
            self._look_for(peer, now)

    # Sightings

    def _look_for(self, peer: Peer, now: float) -> None:
        """Keeps what the local map shows while it is known where the other robot is."""
        position = peer.position
        if position is None or peer.alignment.transform is not None or self._local is None:
            return
        if max(abs(now - position.heard), abs(now - self._view_time)) <= LONGEST_LAG_S:
            self._view = self._view or view_of(self._local, self._viewer())
            peer.seen.add(Sighting(self._view, position.pose.x, position.pose.y, now))

    def _viewer(self) -> Optional[Transform]:
        """Pose of the robot whose map is the local one."""
        if self._base is None:
            return self._own_pose
        position = self._peers[self._base].position
        return None if position is None else position.pose

    def _look_through(self, peer: Peer, grid: Grid, now: float) -> None:
        """Keeps what the other robot's map shows together with the places where the own robot was just before."""
        soon = 0.0 <= now - peer.viewed_at < SHORTEST_VIEW_S
        if soon or peer.viewed == self.exchange.version_of(peer.name) or peer.alignment.transform is not None:
            return
        peer.viewed, peer.viewed_at = self.exchange.version_of(peer.name), now
        view = view_of(grid, None if peer.position is None else peer.position.pose)
        for time, pose in self._own_poses:
            if 0.0 <= now - time <= LONGEST_MAP_LAG_S:
                peer.saw.add(Sighting(view, pose.x, pose.y, now))

    # Registration

    def _start_registration(self, now: float) -> None:
        if self._registering or self._local is None:
            return
        target = Versioned((self.name, self._local_version), self._local)
        for peer in sorted(self._peers.values(), key=lambda peer: peer.alignment.started_before(now)):
            grid = self.exchange.map_of(peer.name)
            if grid is None or peer.name == self._base:
                continue
            self._look_through(peer, grid, now)
            period: float = self._options.seconds_pub_timer
            if peer.alignment.transform is not None:
                period = self._options.seconds_recompute_transform
                if period < 0:
                    continue
            source = self._versioned(peer, grid)
            if peer.alignment.due(now, target, source):
                peer.alignment.started(now, target, source, period)
                self._registering = True
                self._effects.append(Register(self._job(peer, target, source), peer.generation))
                return

    def _versioned(self, peer: Peer, grid: Grid) -> Versioned:
        return Versioned((peer.name, peer.generation, self.exchange.version_of(peer.name)), grid)

    def _job(self, peer: Peer, target: Versioned, source: Versioned) -> Job:
        team = tuple(
            Member(self._versioned(other, grid), other.alignment.transform)
            for other, grid in ((other, self.exchange.map_of(other.name)) for _, other in sorted(self._peers.items()))
            if other is not peer and grid is not None and other.alignment.transform is not None
        )
        return Job(
            peer.name,
            target,
            source,
            team,
            peer.alignment.transform,
            self._prior(peer.name),
            self._limits(target.grid.info),
            self._options.registration,
            self._cache,
            self._own_track.timed_points(),
            peer.track.timed_points(),
            *self._others(peer),
            peer.seen.all(),
            peer.saw.all(),
        )

    def _others(self, peer: Peer) -> Tuple[np.ndarray, bool]:
        """Where and when robots were that may be taken for the peer, in the own frame, (n, 3); False if not of all.

        Who has neither map nor position, like a base station, does not drive about.
        """
        others = [
            other
            for other in self._peers.values()
            if other.name not in (peer.name, self._base)
            and (other.position is not None or self.exchange.map_of(other.name) is not None)
        ]
        tracks = [
            moved(other.track.timed_points(), other.alignment.proposed)
            for other in others
            if other.position is not None and other.alignment.proposed is not None
        ]
        return np.concatenate([nowhere(), *tracks]), len(tracks) == len(others)

    def _prior(self, robot: str) -> Optional[Prior]:
        poses = self._options.initial_poses
        own = self._base or self.name
        if own in poses and robot in poses:
            return Prior(poses[own].inverse().compose(poses[robot]))
        return None

    def _limits(self, info: GridInfo) -> Limits:
        cells, degrees = self._options.max_trans_robots, self._options.max_rotation_robots
        return Limits(
            math.inf if cells < 0 else cells * info.resolution, math.inf if degrees < 0 else math.radians(degrees)
        )

    # Publishing

    def _publish(self, now: float) -> None:
        if self._local is None:
            return
        due = self._publish_timer.fires(now)
        if (self._changed_local and self._local_timer.fires(now)) or (due and self._changed_foreign):
            self._changed_local, self._changed_foreign = False, False
            self._global = self._fused(self._local)
            self._effects.append(PublishMap(self._global))

    def _fused(self, local: Grid) -> Grid:
        transforms = self.transforms()
        self._layers = {name: layer for name, layer in self._layers.items() if name in transforms}
        order = sorted(transforms, key=lambda robot: -self._peers[robot].alignment.evidence.matched)
        layers = {name: self._layer(self._peers[name], transforms[name], local) for name in order}
        fitting = fusion.fitting(local, [layer for layer in layers.values() if layer is not None])
        for name, layer in layers.items():
            if self.exchange.map_of(name) is not None and not any(layer is each for each in fitting):
                self._warn_once(
                    "drawing",
                    name,
                    f"map of {name} not drawn: with it the global map would have more than "
                    f"{fusion.MOST_GLOBAL_CELLS} cells",
                )
        return fusion.fused(local, fitting)

    def _layer(self, peer: Peer, transform: Transform, local: Grid) -> Optional[fusion.Layer]:
        grid = self.exchange.map_of(peer.name)
        if grid is None:
            return None
        lattice = (local.info.resolution, local.info.origin)
        key: tuple = (peer.generation, self.exchange.version_of(peer.name), lattice)
        if peer.name in self._layers:
            (*known, drawn_at), layer = self._layers[peer.name]
            if tuple(known) == key and _nearly(drawn_at, transform):
                return layer
        layer = fusion.resampled(fusion.without_robots(grid, self._robots_seen_by(peer)), transform, local)
        self._layers[peer.name] = ((*key, transform), layer)
        return layer

    def _robots_seen_by(self, peer: Peer) -> np.ndarray:
        """Where other robots than the peer have been, in the peer's frame, shape (n, 2)."""
        transforms = self._transforms_with_base()
        back = transforms[peer.name].inverse()
        places = [back.apply(self._own_track.points())]
        for name, transform in transforms.items():
            if name != peer.name:
                places.append(back.compose(transform).apply(self._peers[name].track.points()))
        return np.concatenate(places)

    def _places(self, now: float) -> Iterable[Place]:
        longest = max(POSITION_AGE_S, 10.0 * self._options.seconds_send_position)
        for name, transform in sorted(self._transforms_with_base().items()):
            position = self._peers[name].position
            if position is not None and abs(now - position.heard) <= longest:
                yield Place(name, *transform.apply_point(position.pose.x, position.pose.y))

    def _broadcast(self) -> None:
        transforms = self._transforms_with_base()
        if transforms:
            self._effects.append(BroadcastTransforms(tuple(sorted(transforms.items()))))

    def _note(self, text: str) -> None:
        self._effects.append(Note(text))

    def _warn(self, text: str) -> None:
        self._effects.append(Note(text, warning=True))

    def _warn_once(self, subject: str, robot: str, text: str) -> None:
        """One warning for each subject and robot."""
        if (subject, robot) not in self._warned:
            self._warned.add((subject, robot))
            self._warn(text)


def _nearly(first: Transform, second: Transform) -> bool:
    """True if redrawing a layer would hardly move a cell."""
    return math.hypot(first.x - second.x, first.y - second.y) < 0.005 and rotation_between(
        first, second
    ) < math.radians(0.03)


def _described(transform: Optional[Transform]) -> str:
    if transform is None:
        return "none"
    return f"x {transform.x:.2f} m, y {transform.y:.2f} m, {math.degrees(transform.yaw):.1f} deg"
