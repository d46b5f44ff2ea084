"""The agent of one robot: local map, messages and time in, effects out. It knows no ROS, clock, thread or socket.

It hands values from one owner of state to the next: the exchange of maps, where robots are, what was seen of them,
registrations, the team's graph, and the global map.
"""

from typing import Collection, List, Optional, Set

from mr_grid import OccupancyGrid, Pose

from .announcer import Announcer
from .base_frame import BaseFrame
from .believed import BelievedTransforms
from .effects import AskNeighbors, BroadcastTransforms, Effect, Note, Outcome, PublishMap, Register, Send
from .exchange import Exchange
from .frames import Frames
from .global_map import MOST_GLOBAL_CELLS
from .graph.edges import EdgeReport
from .graph.team import TeamGraph
from .hearing import Hearing
from .meetings import LaserScan, TrackReport
from .merged_map import MergedMap
from .messages import Anchor, Boot, Position, Request, Tile, sent_before
from .observations import Observations
from .options import Options
from .own_transforms import OwnTransforms
from .reference import Reference
from .registration import Registration
from .timer import Timer
from .topology import topology_of
from .view import TeamView

NEIGHBOR_QUESTION_S = 5.0
"""Seconds after the start at which the neighbours are asked for (contract 2.4)."""
TRANSFORM_PERIOD_S = 0.5


class Agent:
    """One robot's map merger. Every `on_...` call and `tick` takes the present time in seconds; then collect
    `effects()`. `view` answers what others ask."""

    def __init__(self, options: Options, boot: Boot) -> None:
        """`boot` names this run (see messages.Boot)."""
        self.name = options.robot_name
        self._options, self._topology = options, topology_of(options)
        self.exchange = Exchange(options, boot)
        self._reference = reference = Reference()
        self._graph = graph = TeamGraph(self.name, boot)
        self._merged, self._hearing = MergedMap(options), Hearing()
        self._believed = believed = BelievedTransforms(graph, reference)
        self._observations = seen = Observations(options, boot, self.exchange, reference, graph)
        self._own_transforms = own = OwnTransforms(options, boot, self.exchange, reference, seen, graph)
        self._frames = Frames(self.exchange, seen, own, graph)
        self._base_frame = BaseFrame(self._topology, boot, self.exchange, reference, seen, own, believed, self._merged)
        self._announcer = Announcer(options, self.exchange, reference, seen, own, believed)
        self.view = TeamView(
            options, self.exchange, reference, seen.whereabouts, own.registrar, believed, self._merged, self._hearing
        )
        self._missing: Set[str] = set()  # robots that the radio did not name when it last named all
        self._effects: List[Effect] = []
        self._question: Optional[Timer] = Timer(NEIGHBOR_QUESTION_S, NEIGHBOR_QUESTION_S)
        self._transform_timer = Timer(TRANSFORM_PERIOD_S)

    # What comes in

    def on_local_map(self, grid: OccupancyGrid, now: float) -> None:
        """The local SLAM map changed. Ignored on a base station."""
        if self._options.has_local_map and self.exchange.on_local_map(grid):
            self._reference.set(grid)
            self._observations.look(now)

    def on_local_pose(self, pose: Pose, now: float) -> None:
        """The robot's pose in its map frame at that time, `now`, which may lie up to timer.LONGEST_AGE_S behind that of
        other calls."""
        self._observations.on_own_pose(pose, now)

    @property
    def wants_scans(self) -> bool:
        """True while a robot in hearing is not placed, so that scans are worth their time."""
        return self._observations.meetings.watching

    def on_scan(self, scan: LaserScan, pose: Pose, now: float) -> None:
        """A scan of the own laser and the robot's pose in its map frame at that time, `now`, which may lie up to
        timer.LONGEST_AGE_S behind that of other calls."""
        self._observations.meetings.on_scan(scan, pose, now)

    def on_robot(self, name: str, now: float, returned: bool = False) -> None:
        """A robot is there. `returned`: the radio announced it anew (new_robot), so what was sent last may be lost."""
        self.exchange.on_robot(name, now, returned)

    def on_robots(self, names: Collection[str], now: float) -> None:
        """All robots that the radio knows, again and again. Who is missing twice in a row is lost: a radio that was
        started anew has never heard of it, and does not say so."""
        for name in names:
            self.on_robot(name, now)
        missing = {name for name in self.exchange.robots() if name not in names and self.exchange.present(name)}
        for name in sorted(missing & self._missing):
            self.on_robot_lost(name, now)
        self._missing = missing

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
        heard = self._options.exchange_position and self._hear(position.robot, now)
        if heard and not sent_before(position, self.exchange.boot_of(position.robot)):
            self._observations.on_position(position.robot, position.pose, now)
            self._effects += self._announcer.positions(now)

    def on_track(self, report: TrackReport, now: float) -> None:
        """A robot told where it has been in the last seconds, and what it saw."""
        if self._hear(report.robot, now) and not self.exchange.is_over(report.robot, report.boot):
            self._observations.meetings.on_report(report, now)

    def on_edges(self, report: EdgeReport, now: float) -> None:
        """A robot told the transforms that it has found."""
        if self._hear(report.robot, now):
            self._effects += [Note(text, warning=True) for text in self._graph.heard(report)]
            if report.robot == self._topology.relies_on:
                self._effects += self._frames.follow_told(report)

    def on_sent(self, send: Send, outcome: Outcome, now: float) -> None:
        """The host finished a Send."""
        if not self._announcer.ended(send):
            self.exchange.on_sent(send, outcome, now)

    def on_registered(self, effect: Register, result: Registration, now: float) -> None:
        """The host finished a registration."""
        self._effects += self._own_transforms.finished(effect, result)

    def forget(self, robot: str) -> bool:
        """Nothing that was known of the robot counts any more; False if nothing was. Heard again, it is new."""
        if not self.exchange.forget(robot):
            return False
        self._effects += self._frames.forget(robot)
        self._hearing.forget(robot)
        return True

    def _hear(self, robot: str, now: float, octets: int = 0) -> bool:
        """Something came from a robot; False for one too many."""
        if not self.exchange.meet(robot):
            return False
        self.exchange.on_heard(robot)
        self._hearing.on_news(robot, now, octets)
        return True

    def _follow(self, robot: str, now: float) -> None:
        """The robot's map or run may have changed."""
        self._effects += self._frames.follow(robot)
        if not self._options.has_local_map:
            self._effects += self._base_frame.follow(now)

    # What goes out

    def tick(self, now: float) -> None:
        """Does what is due."""
        if self._question is not None and self._question.fires(now):
            self._question = None
            self._effects.append(AskNeighbors())
        self.exchange.tick(now)
        for robot in self.exchange.robots():
            self._follow(robot, now)
        self._effects += self._own_transforms.give_up_refuted(now)
        self._effects += self._announcer.due(now)
        job = self._own_transforms.next_job(now)
        if job is not None:
            self._effects.append(job)
        self._publish(now)

    def effects(self) -> List[Effect]:
        """What is to be done since the last call."""
        effects, self._effects = self.exchange.effects() + self._effects, []
        return effects

    def _publish(self, now: float) -> None:
        transforms = self._believed.transforms()
        whereabouts = self._observations.whereabouts
        update = self._merged.step(self._reference, self.exchange, transforms, whereabouts, now)
        if update is not None:
            self._effects.append(PublishMap(update.grid, update.changed, self.exchange.boot))
            if self._topology.is_base:
                self.exchange.on_merged_map(update.grid)
        self._effects += [
            Note(
                f"map of {robot} not drawn: with it the global map would have more than {MOST_GLOBAL_CELLS} cells", True
            )
            for robot in self._merged.news()
        ]
        if self._transform_timer.fires(now) and transforms:
            self._effects.append(BroadcastTransforms(tuple(sorted(transforms.items()))))
