"""The agent of one robot: local map, messages and time in, effects out. It knows no ROS, clock, thread or socket.

It hands values from one owner of state to the next: the exchange of maps, where robots are, what was seen of them,
registrations, the team's graph, and the global map.
"""

from typing import Dict, List, Optional, Sequence, Set, Tuple

from .announcements import Announcements
from .effects import (
    AskNeighbors,
    BroadcastTransforms,
    Effect,
    Note,
    PublishMap,
    Purpose,
    Register,
    Send,
)
from .exchange import Exchange
from .global_map import MOST_GLOBAL_CELLS
from .graph.edges import Edge, EdgeReport
from .graph.patience import Patience
from .graph.team import Placement, TeamGraph
from .graph.telling import Telling
from .grid import Grid
from .hearing import Hearing
from .job import Versioned
from .map_sightings import MapSightings
from .markers import RobotMarker, marker_of, outline_of
from .meetings import LaserScan, Meetings, TrackReport
from .merged_map import MergedMap
from .messages import Anchor, Boot, Position, Request, Tile, run_after
from .options import Options
from .own_edges import own_edges
from .payload import Payload
from .reference import Reference
from .registrar import Registrar, Team
from .registration import Registration
from .report import LogFigures, beyond_limits, figures_of, news_of, placement_of, positions_of
from .sighting import LONGEST_MAP_LAG_S, nowhere
from .status import MergerStatus, RobotPlacement
from .timer import Timer
from .told_runs import ToldRuns
from .topology import topology_of
from .transform import FARTHEST_M, Transform
from .whereabouts import Whereabouts

NEIGHBOR_QUESTION_S = 5.0
"""Seconds after the start at which the neighbours are asked for (contract 2.4)."""
TRANSFORM_PERIOD_S = 0.5
MEETING_WANTED_S = 60.0
"""A robot that was in hearing for so long without being placed should be met."""


class NoTransform(LookupError):
    """A point cannot be transformed; the text says why."""


class Agent:
    """One robot's map merger. Every `on_...` call and `tick` takes the present time in seconds; then collect
    `effects()`."""

    def __init__(self, options: Options, boot: Boot) -> None:
        """`boot` names this run (see messages.Boot)."""
        self.name = options.robot_name
        self._options, self._boot, self._first_boot = options, boot, boot
        self._topology, self._told_runs = topology_of(options), ToldRuns()
        self.exchange = Exchange(options, boot)
        self._reference = Reference()
        self._whereabouts = Whereabouts()
        self._sightings = MapSightings()
        self._meetings = Meetings(self.name, boot, options.body_radius)
        self._registrar = Registrar(options, self._whereabouts, self._sightings, self._meetings)
        self._graph, self._telling = TeamGraph(self.name, boot), Telling(self.name, boot)
        self._merged = MergedMap(options)
        self._patience = Patience()
        self._announcements = Announcements(self.name)
        self._hearing = Hearing()
        self._effects: List[Effect] = []
        self._runs: Dict[str, int] = {}
        self._refused: Set[str] = set()
        self._frame = 0
        self._question: Optional[Timer] = Timer(NEIGHBOR_QUESTION_S, NEIGHBOR_QUESTION_S)
        self._position_timer = Timer(options.seconds_send_position)
        self._transform_timer = Timer(TRANSFORM_PERIOD_S)

    # What comes in

    def on_local_map(self, grid: Grid, now: float) -> None:
        """The local SLAM map changed. Ignored on a base station."""
        if self._options.has_local_map and self.exchange.on_local_map(grid):
            self._reference.set(grid)
            self._look(now)

    def on_local_pose(self, pose: Transform, now: float) -> None:
        """The robot's pose in its map frame."""
        self._whereabouts.on_own_pose(pose, now)
        self._meetings.on_own_pose(pose, now)

    @property
    def wants_scans(self) -> bool:
        """True while a robot in hearing is not placed, so that scans are worth their time."""
        return self._meetings.watching

    def on_scan(self, scan: LaserScan, pose: Transform, now: float) -> None:
        """A scan of the own laser and the robot's pose in its map frame at that time."""
        self._meetings.on_scan(scan, pose, now)

    def on_robot(self, name: str, now: float, returned: bool = False) -> None:
        """A robot is there. `returned`: the radio announced it anew (new_robot), so what was sent last may be lost."""
        self.exchange.on_robot(name, now, returned)

    def on_robot_lost(self, name: str, now: float) -> None:
        """The radio lost the robot. Its map and transform stay."""
        self.exchange.on_robot_lost(name)

    def on_anchor(self, anchor: Anchor, now: float) -> None:
        """A robot announced its anchor."""
        self._hear(anchor.robot, now)
        self.exchange.on_anchor(anchor, now)
        self._follow(anchor.robot, now)

    def on_tile(self, tile: Tile, now: float) -> None:
        """Map cells of another robot arrived."""
        self._hear(tile.robot, now, tile.cells.size)
        self.exchange.on_tile(tile, now)
        self._follow(tile.robot, now)

    def on_request(self, request: Request, now: float) -> None:
        """A robot asks for updates: none listed = everything, first one -1 = ignore (contract 2.4)."""
        self.exchange.on_request(request, now)

    def on_position(self, position: Position, now: float) -> None:
        """A robot told its pose."""
        if self._options.exchange_position and self._hear(position.robot, now):
            self._whereabouts.on_position(position.robot, position.pose, now)
            self._look_for(position.robot, now)

    def on_track(self, report: TrackReport, now: float) -> None:
        """A robot told where it has been in the last seconds, and what it saw."""
        if self._hear(report.robot, now):
            self._meetings.on_report(report, now)

    def on_edges(self, report: EdgeReport, now: float) -> None:
        """A robot told the transforms that it has found."""
        if self._hear(report.robot, now):
            self._effects += [Note(text, warning=True) for text in self._graph.heard(report)]
            if report.robot == self._topology.relies_on:
                for robot in self._told_runs.restarted(report):
                    self._forget_frame_of(robot)

    def on_sent(
        self,
        send: Send,
        delivered: bool,
        now: float,
        too_large: Optional[Tile] = None,
        undelivered: Sequence[Payload] = (),
    ) -> None:
        """The host finished a Send; see `Exchange.on_sent`."""
        if not self._announcements.ended(send):
            self.exchange.on_sent(send, delivered, now, too_large, undelivered)

    def on_registered(self, effect: Register, result: Registration, now: float) -> None:
        """The host finished a registration."""
        robot = effect.job.robot
        news = self._registrar.finished(effect, result)
        if news:
            # They have served, and if they misled they would do so again.
            self._sightings.forget(robot)
        refusal = beyond_limits(robot, result)
        if refusal is not None and robot not in self._refused:
            self._refused.add(robot)
            self._effects.append(Note(refusal, warning=True))
        if news is not None:
            self._effects += news_of(robot, news, self._registrar.alignment(robot), result)
            self._update_graph()

    def forget(self, robot: str) -> bool:
        """Nothing that was known of the robot counts any more; False if nothing was. Heard again, it is new."""
        if not self.exchange.forget(robot):
            return False
        self._forget_frame_of(robot)
        self._graph.forget(robot)
        self._hearing.forget(robot)
        self._runs.pop(robot, None)
        return True

    # What goes out

    def tick(self, now: float) -> None:
        """Does what is due."""
        if self._question is not None and self._question.fires(now):
            self._question = None
            self._effects.append(AskNeighbors())
        self.exchange.tick(now)
        for robot in self.exchange.robots():
            self._follow(robot, now)
        self._give_up_refuted(now)
        self._announce(now)
        self._register(now)
        self._publish(now)

    def effects(self) -> List[Effect]:
        """What is to be done since the last call."""
        effects, self._effects = self.exchange.effects() + self._effects, []
        return effects

    # What others ask

    @property
    def local_map(self) -> Optional[Grid]:
        """The local map, on a base station that of the adopted robot."""
        return self._reference.grid

    @property
    def global_map(self) -> Optional[Grid]:
        """The global map as published last."""
        return self._merged.grid

    def placements(self) -> Dict[str, Placement]:
        """Where the frames of the other robots lie in the own one, as far as that is believed."""
        placed, base = self._graph.placed(), self._reference.robot
        if base not in placed:
            return placed
        # The graph lets every robot give way a little; a base station's frame is that of the robot by definition.
        return {**placed, base: placed[base]._replace(transform=Transform())}

    def transforms(self) -> Dict[str, Transform]:
        """Believed transforms of the others' map frames to the own one."""
        return {name: placement.transform for name, placement in self.placements().items()}

    def verdict(self, robot: str) -> str:
        """Why there is (no) transform to the robot."""
        if robot not in self.exchange.robots():
            return "robot not known"
        return self._placement(robot, 0.0).why

    def transform_point(self, robot: str, x: float, y: float) -> Tuple[float, float]:
        """A point of the robot's map frame in the own one, metres. NoTransform while the transform is not known."""
        if not (abs(x) <= FARTHEST_M and abs(y) <= FARTHEST_M):
            raise NoTransform(f"point ({x:g}, {y:g}) is not finite or farther than {FARTHEST_M:g} m away")
        if robot == self.name:
            return x, y
        if robot not in self.exchange.robots():
            raise NoTransform(f"no transform to {robot or 'the empty name'}: this robot is not known")
        placement = self.placements().get(robot)
        if placement is None:
            raise NoTransform(f"no transform to {robot} yet: {self.verdict(robot)}")
        return placement.transform.apply_point(x, y)

    def log_figures(self) -> LogFigures:
        """Figures for the log."""
        pose, transforms = self._whereabouts.own_pose, len(self.transforms())
        return figures_of(self.global_map, self.local_map, pose, self.exchange.updates, transforms)

    def status(self, now: float) -> MergerStatus:
        """Who is placed, and why the others are not."""
        robots = tuple(
            self._placement(robot, now) for robot in self.exchange.robots() if robot != self._reference.robot
        )
        placed = self._graph.placed()
        missed = tuple(
            robot
            for robot in self._driving()
            if robot not in placed and self._hearing.known_for(robot, now) >= MEETING_WANTED_S
        )
        return MergerStatus(self.name, self._options.topology, self._options.base_station, robots, missed)

    def markers(self) -> Tuple[RobotMarker, ...]:
        """The placed robots and the outlines of their maps, for people; takes some milliseconds."""
        places = [(self.name, Transform(), self._whereabouts.own_pose, self._reference.grid)]
        for robot, transform in self.transforms().items():
            heard = self._whereabouts.position(robot)
            pose = None if heard is None else heard.pose
            places.append((robot, transform, pose, self.exchange.map_of(robot)))
        return tuple(
            marker_of(robot, pose, nowhere() if grid is None else outline_of(grid), transform)
            for robot, transform, pose, grid in places
        )

    def _placement(self, robot: str, now: float) -> RobotPlacement:
        return placement_of(
            robot,
            self._graph.placed().get(robot),
            self._registrar.alignment(robot),
            self._why_not_placed(robot),
            self._hearing.age(robot, now),
            self._hearing.octets(robot),
        )

    def _why_not_placed(self, robot: str) -> str:
        base = self._topology.relies_on
        if base is None:
            return self._registrar.why(robot)
        return self._topology.why_not_placed(robot, self.exchange.present(base), base in self._graph.placed())

    # Robots and their frames

    def _hear(self, robot: str, now: float, octets: int = 0) -> bool:
        """Something came from a robot; False for one too many."""
        if not self.exchange.meet(robot):
            return False
        self.exchange.on_heard(robot)
        self._hearing.on_news(robot, now, octets)
        return True

    def _follow(self, robot: str, now: float) -> None:
        """A robot that restarted has a new frame. A base station's own map is that of another robot."""
        before, run = self._runs.get(robot, 0), self.exchange.run_of(robot)
        if run != before:
            self._runs[robot] = run
            self._graph.set_run(robot, self.exchange.boot_of(robot))
            if before:
                self._forget_frame_of(robot)
        if not self._options.has_local_map:
            self._follow_base(now)

    def _forget_frame_of(self, robot: str) -> None:
        self._whereabouts.forget(robot)
        self._sightings.forget(robot)
        self._registrar.forget(robot)
        self._meetings.forget(robot)
        self._update_graph()

    def _follow_base(self, now: float) -> None:
        """A base station takes the map of another robot for its own."""
        version = self._reference.version
        notes = self._reference.follow(self.exchange, len(self.transforms()) > 1, now)
        self._effects += [Note(text) for text in notes]
        if self._reference.frame != self._frame:
            self._frame = self._reference.frame
            self._merged.forget()
            self._sightings.forget_all()
            self._meetings.forget_own()
            if self._topology.is_base:
                self._begin_run(run_after(self._first_boot, self._frame))
            for robot in self.exchange.robots():
                self._registrar.forget(robot)
            self._update_graph()
        if self._reference.version != version:
            self._look(now)

    def _begin_run(self, boot: Boot) -> None:
        """The frame in which a base tells its map is a new one."""
        self._boot = boot
        self.exchange.begin_run(boot)
        self._graph.begin_run(boot)
        self._telling.begin_run(boot)

    # Sightings in maps

    def _look(self, now: float) -> None:
        """The own map changed."""
        assert self._reference.grid is not None
        self._meetings.on_map(self._reference.grid, now)
        self._sightings.on_map(self._reference.grid, now)
        for robot in self.exchange.robots():
            self._look_for(robot, now)

    def _look_for(self, robot: str, now: float) -> None:
        if robot not in self._graph.placed():
            base = self._reference.robot
            heard = None if base is None else self._whereabouts.position(base)
            viewer = self._whereabouts.own_pose if base is None else None if heard is None else heard.pose
            self._sightings.look_for(robot, self._whereabouts.position(robot), viewer, now)

    # Steps

    def _announce(self, now: float) -> None:
        """Short messages to the group: position, track, transforms found."""
        whereabouts = self._whereabouts
        if self._options.exchange_position and self._position_timer.fires(now):
            if whereabouts.own_pose is not None and self._options.has_local_map:
                self._tell(Purpose.POSITION, Position(self.name, whereabouts.own_pose))
            self._effects += positions_of(self._options, whereabouts, self.transforms(), now)
        if self._announcements.free(Purpose.TRACK):
            self._meetings.on_team(self._driving(), self.transforms(), self._reference.robot)
            self._tell(Purpose.TRACK, self._meetings.report(now))
        if self._announcements.free(Purpose.EDGES):
            self._tell(Purpose.EDGES, self._telling.due(self._graph.own(), now))

    def _tell(self, purpose: Purpose, payload: Optional[Payload]) -> None:
        send = None if payload is None else self._announcements.send(purpose, payload)
        if send is not None:
            self._effects.append(send)

    def _driving(self) -> List[str]:
        """Robots in hearing that have a map or a position; who has neither, like a base station, has no frame. Where
        a base merges, it is for that one to say."""
        heard = [robot for robot in self.exchange.robots() if self.exchange.present(robot)]
        if self._topology.relies_on is not None:
            return heard if self._topology.relies_on in heard else []
        return [
            robot
            for robot in heard
            if self.exchange.map_of(robot) is not None or self._whereabouts.position(robot) is not None
        ]

    def _register(self, now: float) -> None:
        if self._reference.grid is None or self._topology.relies_on is not None:
            return
        maps = {}
        for robot in self.exchange.robots():
            grid = self.exchange.map_of(robot)
            if grid is not None:
                version = self.exchange.version_of(robot)
                maps[robot] = Versioned((robot, self.exchange.run_of(robot), version), grid)
                self._look_through(robot, grid, version, now)
        target = Versioned((self.name, self._reference.frame, self._reference.version), self._reference.grid)
        team = Team(target, maps, self._graph.placed(), self._graph.disputed(), self._reference.robot)
        job = self._registrar.next_job(now, team)
        if job is not None:
            self._effects.append(job)

    def _look_through(self, robot: str, grid: Grid, version: int, now: float) -> None:
        if robot not in self._graph.placed():
            own_poses = self._whereabouts.own_poses(now, LONGEST_MAP_LAG_S)
            position = self._whereabouts.position(robot)
            self._sightings.look_through(robot, grid, version, position, own_poses, now)

    def _edges(self) -> List[Edge]:
        base = self._reference.robot if self._reference.grid is not None else None
        return own_edges(self.name, self._boot, self._registrar, self.exchange, base)

    def _update_graph(self) -> None:
        """The own transforms changed."""
        self._effects += [Note(text, warning=True) for text in self._graph.set_own(self._edges())]

    def _give_up_refuted(self, now: float) -> None:
        """A transform that the team contradicts for long is given up."""
        refuted = self._patience.lasting(self._graph.refuted(), now)
        for robot, words in refuted.items():
            if self._registrar.alignment(robot).refuted(words):
                self._effects.append(Note(f"transform to {robot} revoked: {words}", warning=True))
        if refuted:
            self._update_graph()

    def _publish(self, now: float) -> None:
        update = self._merged.step(self._reference, self.exchange, self.transforms(), self._whereabouts, now)
        if update is not None:
            self._effects.append(PublishMap(update.grid, update.changed))
            if self._topology.is_base:
                self.exchange.on_merged_map(update.grid)
        self._effects += [
            Note(
                f"map of {robot} not drawn: with it the global map would have more than {MOST_GLOBAL_CELLS} cells", True
            )
            for robot in self._merged.news()
        ]
        if self._transform_timer.fires(now) and self.transforms():
            self._effects.append(BroadcastTransforms(tuple(sorted(self.transforms().items()))))
