"""One robot in virtual time: the engines of its nodes, wired as topics, services and actions wire them."""

from __future__ import annotations

from typing import Callable, Protocol

import numpy as np

from explorer import messages
from explorer.auction_result import AuctionResult
from explorer.options import Options as ExplorerOptions
from map_merger.messages import Boot
from map_merger.options import Options as MergerOptions
from mr_experiments.common.stopwatch import Stopwatch
from mr_experiments.host.agenda import Agenda
from mr_experiments.host.exploring import Explorer
from mr_experiments.host.fast.fast_body import FastBody
from mr_experiments.host.fast.perfect_merging import PerfectMerger
from mr_experiments.host.fast.team_sight import TeamSight
from mr_experiments.host.merging import Merger
from mr_experiments.host.radio import TeamRadio
from mr_experiments.host.robot_radio import RobotRadio
from mr_grid import OccupancyGrid, Pose
from mr_measures.record.logs import CANCELLED
from mr_sim.body import Body

STATUS_PERIOD = 1.0  # s between two messages of adhoc_communication/status


class Observer(Protocol):
    """Who records what happens on a robot. `robot`: its index."""

    def on_goal(self, robot: int, goal_id: int, pose: Pose, now: float) -> None: ...

    def on_goal_end(self, robot: int, goal_id: int | None, outcome: str, text: str, now: float) -> None: ...

    def on_auction(self, robot: int, auction: messages.Auction, now: float) -> None: ...

    def on_answer(self, robot: int, auction: messages.Auction, now: float) -> None: ...

    def on_auction_result(self, robot: int, result: AuctionResult, now: float) -> None: ...

    def on_global_map(self, robot: int, grid: OccupancyGrid, now: float) -> None: ...

    def on_note(self, robot: int, text: str, warning: bool, now: float) -> None: ...


class Robot:
    """`on_scan` drives it; everything else comes from the radio and the agenda."""

    def __init__(
        self, index: int, start: Pose, merger: MergerOptions, explorer: ExplorerOptions,
        body: Body | FastBody, seed: int, agenda: Agenda, radio: TeamRadio, stopwatch: Stopwatch,
        observer: Observer, clock: Callable[[], float], tick: float, sight: TeamSight,
    ) -> None:  # fmt: skip
        """`tick`: s between two ticks of the explorer; `sight`: for robots with perfect maps."""
        self.index, self.start_pose, self.name = index, start, merger.robot_name
        self.alive = True
        self.senses = False  # drivers, SLAM and navigation run
        self.running = False  # and all other nodes
        self._agenda, self._radio, self._observer, self._clock = agenda, radio, observer, clock
        self._stopwatch = stopwatch
        self.own_radio = RobotRadio(radio, stopwatch)
        boot: Boot = (seed % 2**31, index + 1)
        self.merger: Merger | PerfectMerger
        if isinstance(body, FastBody):
            self.merger = PerfectMerger(merger, body.true_map, sight, agenda, stopwatch, self, clock)
        else:
            self.merger = Merger(merger, boot, agenda, self.own_radio, stopwatch, self, clock)
        self.explorer = Explorer(explorer, agenda, self.own_radio, stopwatch, self, clock, tick)
        self.body = body
        self.body.on_goal_end = self._on_goal_end
        self.local_map: OccupancyGrid | None = None
        self.own_radio.index = radio.add(self.name, self, start)

    def start_sensing(self) -> None:
        """Drivers, SLAM and navigation start."""
        self.senses = self.alive

    def switch_on(self, now: float) -> None:
        """All other nodes start. The local map is latched, so they get it at once."""
        if not self.alive:
            return
        self.running = True
        self.merger.start(now)
        self.explorer.start(now)
        if self.local_map is not None:
            self._hand_out(self.local_map)
        self._agenda.every(STATUS_PERIOD, now, lambda _: self._on_status())

    def switch_off(self) -> None:
        """The robot is dead where it stands."""
        self.alive = self.senses = self.running = False
        self.merger.stop()
        self.explorer.stop()
        self._radio.switch_off(self.own_radio.index)

    def on_scan(self, ranges: np.ndarray, odometry: Pose) -> None:
        """`odometry`: the robot in its odometry frame when the scan was taken."""
        assert isinstance(self.body, Body)
        scan = self.body.scan_of(ranges)
        pose = self.body.locate(scan, odometry, self._clock())
        self._locate(pose)
        if self.running and isinstance(self.merger, Merger):
            self.merger.on_scan(scan, pose)

    def steer(self, odometry: Pose) -> tuple[float, float] | None:
        """Velocities to drive with from now on, m/s and rad/s; None: those of before."""
        assert isinstance(self.body, Body)
        return self.body.steer(odometry, self._clock()) if self.senses else None

    def on_view(self) -> None:
        """In place of a scan, where the map is perfect."""
        assert isinstance(self.body, FastBody)
        self.body.look()
        self._locate(self.body.pose)

    def _locate(self, pose: Pose) -> None:
        if self.running:
            self.merger.on_pose(*pose)
            self.explorer.on_pose(*pose)
        local_map = self.body.new_map(self._clock())
        if local_map is not None:
            self.local_map = local_map
            if self.running:
                self._hand_out(local_map)

    def _hand_out(self, local_map: OccupancyGrid) -> None:
        self.explorer.on_own_map()
        self.merger.on_local_map(local_map)

    # What the radio brings.

    def on_packet(self, topic: str, message: bytes, now: float) -> None:
        if self.running and not self.merger.on_packet(topic, message):
            self.explorer.on_packet(topic, message)

    def on_robot_appeared(self, robot: str, now: float) -> None:
        if self.running:
            self.merger.on_robot(robot, returned=True)
            self.explorer.on_robot(robot, True)

    def on_robot_lost(self, robot: str, now: float) -> None:
        if self.running:
            self.merger.on_robot_lost(robot)
            self.explorer.on_robot(robot, False)

    def _on_status(self) -> None:
        if self.running:
            robots = self.own_radio.robots()
            for robot in robots:
                self.merger.on_robot(robot)
            self.explorer.on_robots(robots)

    # What the merger publishes.

    def on_global_map(self, grid: OccupancyGrid, now: float) -> None:
        self.explorer.on_global_map(grid)
        self.body.set_map(grid)
        self._observer.on_global_map(self.index, grid, now)

    def on_positions(self, positions: dict[str, tuple[float, float]], now: float) -> None:
        self.explorer.on_positions(positions)
        self.body.set_others(positions, now)

    def on_note(self, text: str, warning: bool, now: float) -> None:
        self._observer.on_note(self.index, text, warning, now)

    # What the explorer wants.

    def set_goal(self, goal_id: int, pose: Pose, now: float) -> None:
        self._observer.on_goal(self.index, goal_id, pose, now)
        self.explorer.on_goal_accepted(goal_id)
        self.body.set_goal(goal_id, pose, now)

    def cancel_goal(self, now: float) -> None:
        self._observer.on_goal_end(self.index, None, CANCELLED, "", now)
        self.body.cancel()

    def transform_point(self, robot: str, point: tuple[float, float]) -> tuple[float, float] | None:
        return self.merger.transform_point(robot, point)

    def on_auction_message(self, auction: messages.Auction, now: float) -> None:
        self._observer.on_auction(self.index, auction, now)

    def on_answer(self, auction: messages.Auction, now: float) -> None:
        self._observer.on_answer(self.index, auction, now)

    def on_auction_result(self, result: AuctionResult, now: float) -> None:
        self._observer.on_auction_result(self.index, result, now)

    def _on_goal_end(self, goal_id: int, reached: bool, text: str) -> None:
        outcome = messages.REACHED if reached else messages.FAILED
        self._observer.on_goal_end(self.index, goal_id, outcome, text, self._clock())
        self.explorer.on_goal_result(goal_id, outcome, text)
