"""The agent of one robot: local map, messages and time in, effects out. It knows no ROS, clock, thread or socket."""

import math
from collections import deque
from typing import Deque, Dict, Iterable, List, NamedTuple, Optional, Set, Tuple

import numpy as np

from . import fusion
from .effects import (
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
    SaveDebugImages,
    Send,
)
from .exchange import MOST_MAP_CELLS, MapSender
from .grid import Grid, GridError, GridInfo, empty_grid
from .job import Job, LandmarkCache, Member, Versioned
from .messages import Anchor, Boot, Payload, Position, Request, Tile
from .options import Options
from .peer import HeardPose, Peer, Retry, Track
from .registration import Limits, Prior, Registration, Verdict
from .sighting import LONGEST_LAG_S, LONGEST_MAP_LAG_S, Sighting, View, moved, nowhere, view_of
from .transform import FARTHEST_M, Transform, rotation_between

MOST_ROBOTS = 64
MOST_STORED_CELLS = 40_000_000
"""Cells of the maps of all other robots together (200 MB); what goes beyond is not taken."""
NEIGHBOR_QUESTION_S = 5.0
"""Seconds after the start at which the neighbours are asked for (contract 2.4)."""
TRANSFORM_PERIOD_S = 0.5
SHORTEST_PUBLISH_S = 1.0
"""New local maps are passed on at once, but not more often than this."""
SHORTEST_VIEW_S = 1.0
"""Another robot's map, which comes in parts, is looked at this often for the own robot."""
POSITION_AGE_S = 30.0
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


class _Timer:
    """Fires at most once per period; a clock that jumps back restarts it."""

    def __init__(self, period: float, first: float = 0.0) -> None:
        self.period = period
        self._due: Optional[float] = None
        self._first = first

    def fires(self, now: float) -> bool:
        if self._due is None or self._due - now > self.period + self._first + 1.0:
            self._due = now + self._first
        if now < self._due:
            return False
        self._due = now + self.period
        return True


class Agent:
    """One robot's map merger. Every `on_...` call and `tick` takes the present time in seconds; then collect
    `effects()`."""

    def __init__(self, options: Options, boot: Boot) -> None:
        """`boot` names this run (see messages.Boot)."""
        self._options = options
        self.name = options.robot_name
        self._sender = MapSender(self.name, options.split_size if options.splitted else None, boot)
        self._peers: Dict[str, Peer] = {}
        self._effects: List[Effect] = []
        self._local: Optional[Grid] = None
        self._local_version = 0
        self._global: Optional[Grid] = None
        self._base: Optional[str] = None
        self._own_pose: Optional[Transform] = None
        self._own_track = Track()
        self._own_poses: Deque[Tuple[float, Transform]] = deque(maxlen=MOST_POSES)
        self._view: Optional[View] = None
        self._view_time = -math.inf
        self._layers: Dict[str, Tuple[tuple, Optional[fusion.Layer]]] = {}
        self._cache = LandmarkCache()
        self._registering = False
        self._sends = 0
        self._outstanding: Set[Purpose] = set()
        self._undelivered: Set[int] = set()
        self._announced = False
        self._resend = Retry(float(options.seconds_send_timer), 60.0)
        self._warned: Set[Tuple[str, str]] = set()
        self._sent_before: Optional[Grid] = None
        self._changed_local, self._changed_foreign = False, False
        self._asked_neighbors = False
        self._publish_timer = _Timer(options.seconds_pub_timer, options.seconds_pub_timer)
        self._local_timer = _Timer(SHORTEST_PUBLISH_S)
        self._send_timer = _Timer(options.seconds_send_timer)
        self._position_timer = _Timer(options.seconds_send_position)
        self._anchor_timer = _Timer(options.seconds_meta_timer, options.seconds_meta_timer)
        self._transform_timer = _Timer(TRANSFORM_PERIOD_S)
        self._repair_timer = _Timer(1.0)
        self._question_timer = _Timer(NEIGHBOR_QUESTION_S, NEIGHBOR_QUESTION_S)

    # What comes in

    def on_local_map(self, grid: Grid, now: float) -> None:
        """The local SLAM map changed. Ignored in base station mode."""
        if not self._options.has_local_map:
            return
        try:
            self._sender.set_map(grid)
        except GridError as error:
            self._warn(f"local map ignored: {error}")
            return
        self._set_local(grid, now)

    def on_local_pose(self, pose: Transform, now: float) -> None:
        """The robot's pose in its map frame."""
        self._own_pose = pose
        self._own_track.add(pose.x, pose.y, now)
        self._own_poses.append((now, pose))

    def on_robot(self, name: str, now: float, returned: bool = False) -> None:
        """A robot is there. `returned`: the radio announced it anew (new_robot), so what was sent last may be lost."""
        known = name in self._peers
        peer = self._peer(name)
        if peer is None:
            return
        was_present, peer.present = peer.present, True
        if known and (returned or not was_present):
            peer.retry.progress()
            self._answer(peer, self._sender.last())

    def on_robot_lost(self, name: str, now: float) -> None:
        """The radio lost the robot. Its map and transform stay."""
        if name in self._peers:
            self._peers[name].present = False

    def on_anchor(self, anchor: Anchor, now: float) -> None:
        """A robot announced its anchor."""
        peer = self._peer(anchor.robot)
        if peer is None:
            return
        if peer.map.set_anchor(anchor, self._room_for(peer)):
            peer.restart()
            self._note(f"{peer.name} restarted: its former map and transform are dropped")
            if peer.name == self._base:
                self._forget_frame()
        peer.retry.progress()
        self._changed_foreign = True
        self._adopt_base(peer, now)

    def on_tile(self, tile: Tile, now: float) -> None:
        """Map cells of another robot arrived."""
        peer = self._peer(tile.robot)
        if peer is None:
            return
        try:
            changed = peer.map.add(tile, self._room_for(peer))
        except GridError as error:
            self._warn(f"map update of {peer.name} ignored: {error}")
            return
        peer.retry.progress()
        if changed:
            self._changed_foreign = True
            self._adopt_base(peer, now)

    def on_request(self, request: Request, now: float) -> None:
        """A robot asks for updates: none listed = everything, first one -1 = ignore (contract 2.4)."""
        peer = self._peer(request.robot)
        if peer is None or (request.numbers and request.numbers[0] == -1):
            return
        self._answer(
            peer,
            self._sender.again(request.numbers) if request.numbers else self._sender.everything(),
            always=not request.numbers,
        )

    def on_position(self, position: Position, now: float) -> None:
        """A robot told its pose."""
        peer = self._peer(position.robot)
        if peer is None or not self._options.exchange_position:
            return
        peer.position = HeardPose(position.pose, now)
        peer.track.add(position.pose.x, position.pose.y, now)
        self._look_for(peer, now)

    def on_sent(self, send: Send, delivered: bool, now: float, too_large: Optional[Tile] = None) -> None:
        """The host finished a Send. `too_large`: the tile that the radio refused for its size."""
        if too_large is not None:
            self._halve(too_large)
        if send.purpose in (Purpose.ANSWER, Purpose.REQUEST):
            peer = self._peers.get(send.destination)
            if peer is not None and send.purpose is Purpose.ANSWER:
                peer.answering = False
            return
        self._outstanding.discard(send.purpose)
        if send.purpose is Purpose.CHANGES:
            numbers = [number for payload in send.payloads if isinstance(payload, Tile) for number in payload.numbers]
            if delivered:
                self._announced = True
                self._undelivered.difference_update(numbers)
                self._resend.progress()
            else:
                self._undelivered.update(numbers)

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
        if self._options.has_local_map and self._send_timer.fires(now):
            self._send_changes(now)
        if self._anchor_timer.fires(now):
            self._send_anchor()
        if self._options.exchange_position and self._position_timer.fires(now):
            self._send_position(now)
        if self._repair_timer.fires(now):
            self._request_missing(now)
        self._start_registration(now)
        self._publish(now)
        if self._transform_timer.fires(now):
            self._broadcast()

    def effects(self) -> List[Effect]:
        """What is to be done since the last call."""
        effects, self._effects = self._effects, []
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
            self._sender.updates,
            len(self.transforms()),
        )

    # Exchange

    def _peer(self, name: str) -> Optional[Peer]:
        if not name or name == self.name:
            return None
        if name not in self._peers:
            if len(self._peers) >= MOST_ROBOTS:
                self._warn(f"{name} ignored: there are {MOST_ROBOTS} robots already")
                return None
            self._peers[name] = Peer(name)
            self._note(f"{name} is new")
        return self._peers[name]

    def _room_for(self, peer: Peer) -> int:
        """Cells that the map of the robot may have."""
        others = sum(other.map.stored for other in self._peers.values() if other is not peer)
        return min(MOST_MAP_CELLS, MOST_STORED_CELLS - others)

    def _send(self, purpose: Purpose, destination: str, payloads: Iterable[Payload]) -> None:
        self._sends += 1
        self._effects.append(Send(self._sends, purpose, destination, tuple(payloads)))

    def _group_send(self, purpose: Purpose, payloads: Iterable[Payload]) -> None:
        self._outstanding.add(purpose)
        self._send(purpose, f"mc_{self.name}", payloads)

    def _send_changes(self, now: float) -> None:
        anchor = self._sender.anchor()
        if anchor is None or Purpose.CHANGES in self._outstanding:
            return
        try:
            tiles = self._sender.changes()
        except GridError as error:
            self._warn_once("sending", self.name, f"local map not sent: {error}")
            return
        if tiles and self._options.debug and self._local is not None:
            before = self._sent_before or empty_grid(self._local.info)
            self._effects.append(SaveDebugImages(self._local, before))
            self._sent_before = self._local
        if self._undelivered and self._resend.ready(now):
            tiles += self._sender.again(self._undelivered)
        if tiles:
            payloads: List[Payload] = [] if self._announced else [anchor]
            self._group_send(Purpose.CHANGES, payloads + list(tiles))

    def _halve(self, refused: Tile) -> None:
        rows, columns = refused.cells.shape
        size = f"a piece of the map of {rows} x {columns} cells is larger than adhoc_communication sends"
        if self._sender.halve(refused):
            self._resend.progress()
            self._warn_once("halving", self.name, f"{size}: pieces are halved until they fit; see max_packet_size")
        else:
            self._warn_once("refused", self.name, f"{size}, and is not cut further: raise max_packet_size")

    def _send_anchor(self) -> None:
        anchor = self._sender.anchor()
        if anchor is not None and self._peers and Purpose.ANCHOR not in self._outstanding:
            self._group_send(Purpose.ANCHOR, [anchor])

    def _send_position(self, now: float) -> None:
        if self._own_pose is not None and self._options.has_local_map and Purpose.POSITION not in self._outstanding:
            self._group_send(Purpose.POSITION, [Position(self.name, self._own_pose)])
        places = tuple(self._places(now))
        self._effects.append(PublishPositions(places))
        self._effects.append(PublishTrack(self.name, self._own_track.points()[-MOST_MARKERS:]))
        for name, transform in self._transforms_with_base().items():
            self._effects.append(PublishTrack(name, transform.apply(self._peers[name].track.points()[-MOST_MARKERS:])))

    def _answer(self, peer: Peer, tiles: List[Tile], always: bool = False) -> None:
        anchor = self._sender.anchor()
        if anchor is None or peer.answering or not (tiles or always):
            return
        peer.answering = True
        payloads: List[Payload] = [anchor]
        self._send(Purpose.ANSWER, peer.name, payloads + list(tiles))

    def _request_missing(self, now: float) -> None:
        for peer in self._peers.values():
            wanted = peer.map.wanted()
            if wanted is not None and peer.present and peer.retry.ready(now):
                self._send(Purpose.REQUEST, peer.name, [Request(self.name, wanted)])

    # Base station

    def _adopt_base(self, peer: Peer, now: float) -> None:
        if self._options.has_local_map:
            return
        if self._base is None:
            self._base = peer.name
            self._note(f"base station: the map of {peer.name} is the reference")
        grid = peer.map.grid()
        if self._base == peer.name and grid is not None:
            self._set_local(grid, now)

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
        if soon or peer.viewed == peer.map.version or peer.alignment.transform is not None:
            return
        peer.viewed, peer.viewed_at = peer.map.version, now
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
            grid = peer.map.grid()
            if grid is None or peer.name == self._base:
                continue
            self._look_through(peer, grid, now)
            period: float = self._options.seconds_pub_timer
            if peer.alignment.transform is not None:
                period = self._options.seconds_recompute_transform
                if period < 0:
                    continue
            source = Versioned((peer.name, peer.generation, peer.map.version), grid)
            if peer.alignment.due(now, target, source):
                peer.alignment.started(now, target, source, period)
                self._registering = True
                self._effects.append(Register(self._job(peer, target, source), peer.generation))
                return

    def _job(self, peer: Peer, target: Versioned, source: Versioned) -> Job:
        team = tuple(
            Member(Versioned((other.name, other.generation, other.map.version), grid), other.alignment.transform)
            for other, grid in ((other, other.map.grid()) for _, other in sorted(self._peers.items()))
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
            and (other.position is not None or other.map.grid() is not None)
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
            if self._peers[name].map.grid() is not None and not any(layer is each for each in fitting):
                self._warn_once(
                    "drawing",
                    name,
                    f"map of {name} not drawn: with it the global map would have more than "
                    f"{fusion.MOST_GLOBAL_CELLS} cells",
                )
        return fusion.fused(local, fitting)

    def _layer(self, peer: Peer, transform: Transform, local: Grid) -> Optional[fusion.Layer]:
        grid = peer.map.grid()
        if grid is None:
            return None
        lattice = (local.info.resolution, local.info.origin)
        key: tuple = (peer.generation, peer.map.version, lattice)
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
