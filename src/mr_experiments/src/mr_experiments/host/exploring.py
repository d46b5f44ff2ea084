"""The explorer of one robot in virtual time: what its node does with topics, services, actions and threads."""

from __future__ import annotations

import functools
import math
from io import BytesIO
from typing import Any, Callable, Protocol

from adhoc_communication.msg import ExpAuction, ExpFrontier
from explorer.msg import TeamOrder, TeamVerdicts

from explorer import messages, ros_io, ros_team, ros_verdicts
from explorer.agent import ExplorerAgent
from explorer.auction_result import AuctionResult
from explorer.call_queue import CALLS, HANDOVER, CallQueue
from explorer.foreign import Element
from explorer.grid import OccupancyMap
from explorer.options import Options
from explorer.scene_folder import recorder
from mr_experiments.common.stopwatch import Stopwatch
from mr_experiments.host.agenda import Agenda
from mr_experiments.host.robot_radio import RobotRadio
from mr_grid import OccupancyGrid, Pose

TICK = 0.1  # s
SERVICE_TIME = 0.01  # s that a call between two nodes of a robot takes


# What one robot sends reaches all others, and nobody changes it: it is read once.
@functools.lru_cache(maxsize=64)
def _parsed(kind: type, octets: bytes) -> Any:
    return kind().deserialize(octets)


@functools.lru_cache(maxsize=64)
def _elements(wire: ros_io.Wire, octets: bytes) -> tuple[Element, ...]:
    return wire.elements_from(ExpFrontier().deserialize(octets))


@functools.lru_cache(maxsize=64)
def _auction(wire: ros_io.Wire, octets: bytes) -> messages.Auction:
    return wire.auction_from(ExpAuction().deserialize(octets))


class ExplorerListener(Protocol):
    """Who carries out what the explorer wants of its robot."""

    def set_goal(self, goal_id: int, pose: Pose, now: float) -> None: ...

    def cancel_goal(self, now: float) -> None: ...

    def transform_point(self, robot: str, point: tuple[float, float]) -> tuple[float, float] | None: ...

    def on_auction_message(self, auction: messages.Auction, now: float) -> None: ...

    def on_answer(self, auction: messages.Auction, now: float) -> None: ...

    def on_auction_result(self, result: AuctionResult, now: float) -> None: ...

    def on_note(self, text: str, warning: bool, now: float) -> None: ...


class _Calls:
    """Blocking calls of adhoc_communication by a number of threads, in the order of a CallQueue."""

    def __init__(self, threads: int, agenda: Agenda, clock: Callable[[], float]) -> None:
        self._queue = CallQueue(CALLS, HANDOVER)
        self._idle = threads
        self._agenda, self._clock = agenda, clock
        self._number = 0
        self._woken_at = math.inf

    def put(self, call: Callable[[Callable[[], None]], None]) -> None:
        """`call` gets a function to be called at its end."""
        self._queue.put(lambda: self._run(call, self._number))
        self._begin()

    def _begin(self) -> None:
        now = self._clock()
        while self._idle > 0:
            taken = self._queue.take(now)
            if taken is None:
                break
            self._idle -= 1
            self._number, call = taken
            call()
        pause = self._queue.pause(now)
        if pause is not None and self._idle > 0 and not now < self._woken_at <= now + pause:
            self._woken_at = now + pause
            self._agenda.at(self._woken_at, lambda _: self._begin())

    def _run(self, call: Callable[[Callable[[], None]], None], number: int) -> None:
        def ended() -> None:
            self._idle += 1
            self._queue.ended(number)
            self._begin()

        call(ended)


class Explorer:
    """Owns the agent and carries out its effects."""

    def __init__(
        self, options: Options, agenda: Agenda, radio: RobotRadio, stopwatch: Stopwatch, listener: ExplorerListener,
        clock: Callable[[], float], tick: float = TICK,
    ) -> None:  # fmt: skip
        self.agent = ExplorerAgent(options, recorder(options))
        self._tick = tick
        self.bids = 0
        self._options = options
        self._agenda, self._radio, self._stopwatch = agenda, radio, stopwatch
        self._listener, self._clock = listener, clock
        self._wire = ros_io.Wire(options.simulation)
        self._calls, self._bid_calls = _Calls(3, agenda, clock), _Calls(2, agenda, clock)
        self._running = True
        self._last_auction: AuctionResult | None = None

    def start(self, now: float) -> None:
        self._agenda.every(self._tick, now, lambda _: self.tick())

    def stop(self) -> None:
        """The robot is no more."""
        self._running = False

    @property
    def ready(self) -> bool:
        return self.agent.map is not None and self.agent.pose is not None

    def begin(self) -> None:
        """What the service ~start does."""
        self.agent.start(self._clock())
        self.tick()

    def on_global_map(self, grid: OccupancyGrid) -> None:
        self.agent.on_global_map(OccupancyMap(grid.info, grid.cells), self._clock())

    def on_own_map(self) -> None:
        self.agent.on_own_map(self._clock())

    def on_pose(self, x: float, y: float, yaw: float) -> None:
        self.agent.on_pose(Pose(x, y, yaw), self._clock())

    def on_positions(self, positions: dict[str, tuple[float, float]]) -> None:
        self.agent.on_positions(positions, self._clock())

    def on_robots(self, robots: list[str]) -> None:
        """All that the radio knows now."""
        self.agent.on_robots(robots, self._clock())

    def on_robot(self, robot: str, present: bool) -> None:
        self.agent.on_robot(robot, present, self._clock())

    def on_goal_result(self, goal_id: int, outcome: str, text: str) -> None:
        self.agent.on_goal_result(goal_id, outcome, text, self._clock())
        self._agenda.at(self._clock() + SERVICE_TIME, lambda _: self.tick())

    def on_goal_accepted(self, goal_id: int) -> None:
        self.agent.on_goal_accepted(goal_id, self._clock())

    def on_packet(self, topic: str, octets: bytes) -> bool:
        """False if the topic is not for the explorer."""
        take = {
            "frontiers": self.agent.on_frontiers,
            "visited_frontiers": self.agent.on_visited_frontiers,
            "negotiation_list": self.agent.on_negotiation_list,
        }.get(topic)
        if take is None and topic not in ("auction", ros_verdicts.TOPIC, ros_team.ORDERS_TOPIC):
            return False
        now = self._clock()
        if topic == ros_team.ORDERS_TOPIC:
            self.agent.on_order(ros_team.order_from(_parsed(TeamOrder, octets)), now)
            return True
        if topic == ros_verdicts.TOPIC:
            statement = ros_verdicts.statement_from(_parsed(TeamVerdicts, octets))
            if statement is not None:
                self.agent.on_statement(statement, now)
            return True
        if take is not None:
            with self._stopwatch.span("messages"):
                elements = _elements(self._wire, octets)
            take(elements, now)
            return True
        with self._stopwatch.span("messages"):
            auction = _auction(self._wire, octets)
        if not auction.status:
            self._listener.on_answer(auction, now)
        with self._stopwatch.span("exploration"):
            hurried = self.agent.on_auction(auction, now)
        if hurried:
            self._agenda.at(now + SERVICE_TIME, lambda _: self.tick())
        return True

    def tick(self) -> None:
        if not self._running:
            return
        now = self._clock()
        with self._stopwatch.span("exploration"):
            effects = self.agent.tick(now)
        for effect in effects:
            self._carry_out(effect, now)
        result = self.agent.mission.last_auction
        if result is not None and result is not self._last_auction:
            self._last_auction = result
            self._listener.on_auction_result(result, now)

    def _carry_out(self, effect: messages.Effect, now: float) -> None:
        if isinstance(effect, messages.SetGoal):
            self._listener.set_goal(effect.goal_id, effect.pose, now)
        elif isinstance(effect, messages.CancelGoal):
            self._listener.cancel_goal(now)
        elif isinstance(effect, (messages.SendFrontiers, messages.SendAuction)):
            self._send(effect, now)
        elif isinstance(effect, messages.SendStatement):
            message, group = ros_verdicts.verdicts_to(effect), self._options.group
            self._calls.put(
                lambda ended: self._radio.send_typed(group, ros_verdicts.TOPIC, message, lambda *_: ended())
            )
        elif isinstance(effect, messages.SendState):
            told, to = ros_team.state_to(effect.state), effect.to
            self._calls.put(lambda ended: self._radio.send_typed(to, ros_team.STATES_TOPIC, told, lambda *_: ended()))
        elif isinstance(effect, messages.AskTransform):
            robot = effect.robot
            self._agenda.at(now + SERVICE_TIME, lambda _: self._answer_transform(robot))
        elif isinstance(effect, messages.Note):
            self._listener.on_note(f"explorer: {effect.text}", effect.warning, now)

    def _send(self, effect: Any, now: float) -> None:
        is_bid = isinstance(effect, messages.SendAuction) and not effect.auction.status
        if isinstance(effect, messages.SendAuction):
            self.bids += is_bid
            self._listener.on_auction_message(effect.auction, now)
        with self._stopwatch.span("messages"):
            service, topic, message = self._wire.radio_call(effect)
            octets = BytesIO()
            message.serialize(octets)

        def call(ended: Callable[[], None]) -> None:
            self._radio.send(service, self._options.group, topic, octets.getvalue(), lambda *_: ended())

        (self._bid_calls if is_bid else self._calls).put(call)

    def _answer_transform(self, robot: str) -> None:
        if self._running:
            images = [self._listener.transform_point(robot, probe) for probe in ros_io.PROBES]
            self.agent.on_transform(robot, ros_io.transform_from(images), self._clock())
