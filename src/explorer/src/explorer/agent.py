"""The explorer of one robot: maps, poses and messages in; goals, messages and logs out.

No clock, no ROS, no thread: every call takes `now` in seconds, `tick` returns the effects.
"""

import math
from typing import List, Mapping, Optional, Sequence

import numpy as np

from explorer.answer import Answer
from explorer.driver import Goal
from explorer.edge import Edge
from explorer.errors import ParameterError
from explorer.foreign import Element, ForeignFrontiers
from explorer.geometry import Position
from explorer.grid import OccupancyMap
from explorer.homecoming import HOME_LOST
from explorer.memory import Memory
from explorer.messages import Auction, Effect, KeepLimits, Note
from explorer.missions import Missions, OnDecision
from explorer.options import Options, checked_limits
from explorer.perception import Perception
from explorer.pictures import picture_of, status_of
from explorer.report import Report, report_of
from explorer.senses import Senses
from explorer.statement import Statement
from explorer.status import Counters, Picture, State, Status
from explorer.team_orders import TeamOrders
from explorer.team_state import TeamOrder, TeamState
from mr_grid import Pose

CLOCK_TOLERANCE = 1.0  # s by which the clock may be set back without consequences
LONGEST_TICK = 60.0  # s from one tick to the next, beyond which the clock was set forward
STARTED = "exploration started"
MAXIMUM_CHOSEN = 5000  # elements of one negotiation list that are read


class ExplorerAgent:
    """See the module. Bounded in memory; every message from outside may be late, lost, doubled or out of order.

    Owns what outlives a mission; the mission is an `Exploration`, and a new one when the clock is set back or the map
    frame is another one."""

    def __init__(self, options: Options, on_decision: Optional[OnDecision] = None) -> None:
        """`on_decision` takes each decision of the strategy at the moment when it is made."""
        self.options = options
        self.name = options.robot_name
        self.foreign = ForeignFrontiers()
        self._senses = Senses(Pose(*options.home_pose) if options.home_pose else None)
        self.perception = Perception(options, self._senses)
        self._outbox: List[Effect] = []
        self._edge = Edge(self.name, self._outbox.append)
        self._reached: List[str] = []  # by the radio
        self._ticked = -math.inf
        emit = self._outbox.append
        self._missions = Missions(options, self._senses, self.perception, self.foreign, emit, on_decision)
        self.mission = self._missions.first()
        orders = {"start": self.order_start, "pause": self.pause, "resume": self.resume}
        orders.update({"return_now": self.return_now, "stop": self.stop, "go_home": self.go_home})
        self._team_orders = TeamOrders(orders, self.set_limits, emit)

    # ---- input ----------------------------------------------------------------------------------------------------

    def start(self, now: float) -> bool:
        """Starts the mission; False if it was started or stopped before."""
        return self.mission.start(now)

    def order_start(self, now: float) -> Answer:
        """The same, as an order of somebody: answered in words."""
        if self.start(now):
            halt = self.mission.orders.halt
            return Answer(True, f"exploration started; the robot {halt} until it is resumed" if halt else STARTED)
        if self.finished_at is not None:
            return Answer(False, f"has ended: {self.text}; a new mission begins with a new launch")
        return Answer(False, "exploration was started before")

    def pause(self, now: float) -> Answer:
        """The robot stays where it is and claims nothing until it is to `resume`."""
        return self.mission.steering.pause(now)

    def return_now(self, now: float) -> Answer:
        """The robot drives home at once and waits there until it is to `resume`; one that has not begun waits there."""
        return self.mission.steering.return_now(now)

    def resume(self, now: float) -> Answer:
        return self.mission.steering.resume()

    def stop(self, now: float) -> Answer:
        """Ends the mission where the robot is."""
        return self.mission.steering.stop(now)

    def go_home(self, now: float) -> Answer:
        """Ends the exploration and drives home; one that has not begun stays there, and does not begin."""
        return self.mission.steering.go_home(now)

    def set_limits(self, time: float, distance: float) -> Answer:
        """After how many s of exploration and m of way it ends; 0: none."""
        try:
            limits = checked_limits(time, distance)
        except ParameterError as error:
            return Answer(False, str(error))
        answer = self.mission.steering.set_limits(limits)
        if answer.done:
            self._outbox.append(KeepLimits(limits))
        return answer

    def recall(self, memory: Memory, now: float) -> None:
        """Goes on with a mission after the node was started anew; before the first tick."""
        self.mission.recall(memory, now)

    def on_new_frame(self, shift: Optional[Pose], now: float) -> None:
        """The robot's SLAM has begun a new map, in another frame; maps and poses of before must not come any more.
        `shift`: the former frame in the new one, None where it is not known."""
        self._senses.begin_frame(shift)
        self.foreign.forget_transforms()
        self.mission = self._missions.in_new_frame(self.mission, now)
        home = f"; {HOME_LOST}" if self._senses.home_is_lost else ""
        self._outbox.append(Note(f"SLAM was started anew: goes on in the frame of its new map{home}", True))

    def on_global_map(self, occupancy: OccupancyMap, now: float) -> None:
        self._senses.take_map(occupancy, now)
        self.perception.take_map()

    def on_own_map(self, now: float) -> None:
        """The robot's own SLAM has updated its map."""
        self._senses.take_own_map(now)

    def on_pose(self, pose: Pose, now: float) -> None:
        """Pose of the robot in its map frame."""
        if self._edge.accepts(pose):
            self._senses.take_pose(pose, now)

    def on_positions(self, positions: Mapping[str, Position], now: float) -> None:
        """Positions of other robots in metres in the own map frame (map_merger's `all_positions`)."""
        self.mission.team.set_positions(self._edge.positions(positions), now)

    def on_robots(self, names: Sequence[str], now: float) -> None:
        """All robots that the radio reaches now."""
        self._reached = list(names)
        self.mission.hearing.take_robots(names)

    def on_robot(self, name: str, present: bool, now: float) -> None:
        """The radio reaches one more robot, or one less."""
        others = [other for other in self._reached if other != name]
        self.on_robots([*others, name] if present else others, now)

    def on_transform(self, robot: str, transform: Optional[np.ndarray], now: float) -> None:
        """(2, 3) transform from a robot's map frame to the own one, or None while there is none."""
        self.foreign.set_transform(robot, self._edge.transform(robot, transform))

    def on_frontiers(self, elements: Sequence[Element], now: float) -> None:
        for element in self._edge.elements(elements, self.mission.team):
            self.foreign.add(element)

    def on_visited_frontiers(self, elements: Sequence[Element], now: float) -> None:
        """Points that another robot has explored."""
        self.mission.hearing.take_explored(self._edge.elements(elements, self.mission.team), now)

    def on_negotiation_list(self, elements: Sequence[Element], now: float) -> None:
        """The cluster that another robot has chosen (strategies 5 and 6)."""
        chosen = self._edge.elements(elements[:MAXIMUM_CHOSEN], self.mission.team)
        for element in chosen:
            self.foreign.add(element)
        self.mission.hearing.take_choice(chosen, now)

    def on_auction(self, auction: Auction, now: float) -> bool:
        """True if the next `tick` should not wait for its time."""
        return self.mission.take_auction(auction, now)

    def on_statement(self, statement: Statement, now: float) -> None:
        """What another robot has decided, and whether it has anything left."""
        if self._edge.accepts_statement(statement):
            self.mission.hearing.take_statement(statement, now)

    def on_order(self, order: TeamOrder, now: float) -> None:
        """A mission control of the team has sent it."""
        self._team_orders.take(order, now)

    def on_goal_accepted(self, goal_id: int, now: float) -> None:
        self.mission.driver.take_accepted(goal_id, now)

    def on_goal_result(self, goal_id: int, outcome: str, text: str, now: float) -> None:
        """Outcome of a goal: `messages.REACHED`, `FAILED` or `REPLACED`. Results of former goals are ignored."""
        self.mission.take_result(goal_id, outcome, text, now)

    # ---- the step -------------------------------------------------------------------------------------------------

    def tick(self, now: float) -> List[Effect]:
        """What there is to do now. Cheap when nothing has changed; call it some 5 times a second, and at once after
        auction messages that ask for it."""
        if now < self._ticked - CLOCK_TOLERANCE:
            self._outbox.append(Note(f"time went back by {self._ticked - now:.1f} s; the mission starts anew", True))
            self.mission = self._missions.anew(self.mission, now)
        elif now > self._ticked + LONGEST_TICK and self.mission.skip(self._ticked, now):
            self._outbox.append(Note(f"time went forward by {now - self._ticked:.1f} s, which do not count", True))
        self._ticked = now
        self.mission.step(now)
        self._tell_controls(now)
        effects = list(self._outbox)
        self._outbox.clear()
        return effects

    def _tell_controls(self, now: float) -> None:
        ended_by = self.mission.orders.ended_by or ""
        if not self._team_orders.due((self.state, self.mission.orders.halt, ended_by), now):
            return
        area = 0.0 if self.map is None else self.map.known_area
        time = self.exploration_time(now)
        self._team_orders.tell(TeamState(self.name, int(self.state), self.text, "", ended_by, time, area))

    # ---- what is told of the robot --------------------------------------------------------------------------------

    @property
    def map(self) -> Optional[OccupancyMap]:
        return self._senses.map

    @property
    def pose(self) -> Optional[Pose]:
        return self._senses.pose

    @property
    def home(self) -> Optional[Pose]:
        return self._senses.home

    @property
    def memory(self) -> Memory:
        """What is to be kept, so that the mission can go on after a crash: see `recall`."""
        return self.mission.memory

    @property
    def state(self) -> State:
        return self.mission.state

    @property
    def text(self) -> str:
        """The state in words."""
        return self.mission.text

    @property
    def started_at(self) -> Optional[float]:
        return self.mission.started_at

    @property
    def finished_at(self) -> Optional[float]:
        """When the exploration was finished, in seconds."""
        return self.mission.finished_at

    @property
    def counters(self) -> Counters:
        return self.mission.counters

    @property
    def goal(self) -> Optional[Goal]:
        return self.mission.driver.goal

    def exploration_time(self, now: float) -> float:
        """Seconds from the start of the mission, fixed once finished (T_r)."""
        return self.mission.exploration_time(now)

    def status(self, now: float) -> Status:
        return status_of(self.name, self.mission, self.perception, now)

    def report(self, now: float) -> Report:
        """What the robot explores and why; takes some ms, so ask for it about once a second."""
        return report_of(self.status(now), self.mission, self.perception, self.map, now)

    def picture(self) -> Picture:
        return picture_of(self.perception, self.mission.verdicts, self.foreign)
