"""The map merger of one robot in virtual time: what its node does with topics, services and threads."""

from __future__ import annotations

import functools
from collections import deque
from io import BytesIO
from typing import Callable, Protocol

import rospy

from map_merger import meetings, ros_io, ros_radio
from map_merger.agent import Agent
from map_merger.delivery import Delivery, take
from map_merger.effects import AskNeighbors, Effect, Note, PublishMap, PublishPositions, Purpose, Register, Send
from map_merger.job import outcome_of
from map_merger.messages import Boot, Tile
from map_merger.options import Options
from map_merger.payload import Payload
from map_merger.view import NoTransform
from map_merger.whereabouts import POSE_PERIOD_S
from mr_experiments.common.stopwatch import Stopwatch
from mr_experiments.host.agenda import Agenda
from mr_experiments.host.robot_radio import RobotRadio
from mr_grid import OccupancyGrid, Pose
from mr_robot.slam.engine import LaserScan

TICK = 0.2  # s
SCAN_PERIOD = 0.2  # s
REGISTRATION_TIME = 0.3  # s that a registration takes on a robot


# What one robot sends reaches all others, and nobody changes it: it is read once.
@functools.lru_cache(maxsize=64)
def _value(kind: ros_radio.Incoming, octets: bytes) -> Payload:
    return kind.value_of(kind.kind().deserialize(octets))


class MergerListener(Protocol):
    """Who wants what the merger publishes."""

    def on_global_map(self, grid: OccupancyGrid, now: float) -> None: ...

    def on_positions(self, positions: dict[str, tuple[float, float]], now: float) -> None: ...

    def on_note(self, text: str, warning: bool, now: float) -> None: ...


class _Sends:
    """Sends one after the other, each payload when the one before has ended."""

    def __init__(self, merger: Merger) -> None:
        self._merger = merger
        self._waiting: deque[Send] = deque()
        self._busy = False

    def put(self, send: Send) -> None:
        self._waiting.append(send)
        if not self._busy:
            self._begin()

    def _begin(self) -> None:
        self._busy = bool(self._waiting)
        if self._busy:
            self._deliver(Delivery(self._waiting[0]))

    def _deliver(self, delivery: Delivery) -> None:
        payload = delivery.next
        if payload is None:
            self._waiting.popleft()
            self._merger.do(lambda now: delivery.report(self._merger.agent, now))
            self._begin()
            return

        def done(delivered: bool, reason: str) -> None:
            delivery.ended(delivered, isinstance(payload, Tile) and ros_io.REFUSED_FOR_SIZE in reason)
            self._deliver(delivery)

        self._merger.transmit(delivery.send.destination, payload, done)


class Merger:
    """Owns the agent and carries out its effects."""

    def __init__(
        self, options: Options, boot: Boot, agenda: Agenda, radio: RobotRadio, stopwatch: Stopwatch,
        listener: MergerListener, clock: Callable[[], float],
    ) -> None:  # fmt: skip
        self.agent = Agent(options, boot)
        self._options = options
        self._agenda, self._radio, self._stopwatch = agenda, radio, stopwatch
        self._listener, self._clock = listener, clock
        self._sends = {purpose: _Sends(self) for purpose in Purpose}
        self._incoming = ros_radio.incoming(options)
        self._pose_at = -POSE_PERIOD_S
        self._scan_at = -SCAN_PERIOD
        self._running = True

    def start(self, now: float) -> None:
        self._agenda.every(TICK, now, lambda _: self._tick())

    def stop(self) -> None:
        """The robot is no more."""
        self._running = False

    def _tick(self) -> None:
        if self._running:
            self.do(self.agent.tick)

    def on_local_map(self, local: OccupancyGrid) -> None:
        self.do(lambda now: self.agent.on_local_map(local, now))
        self._tick()

    def on_pose(self, x: float, y: float, yaw: float) -> None:
        now = self._clock()
        if now - self._pose_at >= POSE_PERIOD_S - 1e-6:
            self._pose_at = now
            self.do(lambda now: self.agent.on_local_pose(Pose(x, y, yaw), now))

    def on_scan(self, scan: LaserScan, pose: Pose) -> None:
        """A scan and the robot's pose in its map frame at that time."""
        now = self._clock()
        if self._running and self.agent.wants_scans and now - self._scan_at >= SCAN_PERIOD - 1e-6:
            self._scan_at = now
            seen = meetings.LaserScan(
                scan.ranges,
                scan.angle_min,
                scan.angle_increment,
                scan.range_min,
                scan.range_max,
                Pose(*scan.mount),
            )
            self.do(lambda now: self.agent.on_scan(seen, Pose(*pose), now))

    def on_robot(self, name: str, returned: bool = False) -> None:
        self.do(lambda now: self.agent.on_robot(name, now, returned=returned))

    def on_robot_lost(self, name: str) -> None:
        self.do(lambda now: self.agent.on_robot_lost(name, now))

    def on_packet(self, topic: str, octets: bytes) -> bool:
        """False if the topic is not for the merger."""
        kind = self._incoming.get(topic)
        if kind is None:
            return False
        self.do(lambda now: take(self.agent, self._value(kind, octets), now))
        return True

    def _value(self, kind: ros_radio.Incoming, octets: bytes) -> Payload:
        with self._stopwatch.span("messages"):
            return _value(kind, octets)

    def transforms(self) -> dict[str, Pose]:
        """From the frame of each other robot to the own one, where they are known."""
        return self.agent.view.transforms()

    def transform_point(self, robot: str, point: tuple[float, float]) -> tuple[float, float] | None:
        """What the service transformPoint answers."""
        try:
            return self.agent.view.transform_point(robot, *point)
        except NoTransform:
            return None

    def do(self, call: Callable[[float], None]) -> None:
        """Calls the agent and carries out what it wants; a message that cannot be used is reported."""
        if not self._running:
            return
        now = self._clock()
        try:
            with self._stopwatch.span("merging"):
                call(now)
        except ros_io.MessageError as error:
            self._listener.on_note(f"map_merger ignored {error}", True, now)
        for effect in self.agent.effects():
            self._carry_out(effect, now)

    def _carry_out(self, effect: Effect, now: float) -> None:
        if isinstance(effect, Send):
            self._sends[effect.purpose].put(effect)
        elif isinstance(effect, Register):
            self._register(effect, now)
        elif isinstance(effect, PublishMap):
            self._listener.on_global_map(effect.grid, now)
        elif isinstance(effect, PublishPositions):
            self._listener.on_positions({place.robot: (place.x, place.y) for place in effect.places}, now)
        elif isinstance(effect, AskNeighbors):
            for name in self._radio.neighbors():
                self.on_robot(name)
        elif isinstance(effect, Note):
            self._listener.on_note(f"map_merger: {effect.text}", effect.warning, now)

    def _register(self, effect: Register, now: float) -> None:
        with self._stopwatch.span("registration"):
            result, fault = outcome_of(effect.job)
        if fault is not None:
            raise fault
        self._agenda.at(
            now + REGISTRATION_TIME, lambda _: self.do(lambda now: self.agent.on_registered(effect, result, now))
        )

    def transmit(self, destination: str, payload: object, done: Callable[[bool, str], None]) -> None:
        """Sends one payload as the message that the node would send."""
        with self._stopwatch.span("messages"):
            call = ros_radio.radio_call(payload, self._options, rospy.Time.from_sec(self._clock()))  # type: ignore[arg-type]
        if call.service == "send_message":
            self._radio.send_typed(destination, call.topic, call.message, done)
            return
        with self._stopwatch.span("messages"):
            octets = BytesIO()
            call.message.serialize(octets)
        self._radio.send(call.service, destination, call.topic, octets.getvalue(), done)
