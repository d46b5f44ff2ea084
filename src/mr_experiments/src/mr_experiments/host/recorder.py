"""Writes down what happens in a mission; the record is made from it at the end."""

from __future__ import annotations

import functools
import math
from array import array
from dataclasses import fields
from typing import Any, Sequence

import numpy as np

from explorer import auction_result, messages
from mr_experiments.host.radio import TeamRadio
from mr_experiments.host.robot import Robot
from mr_experiments.host.transforms import MergeLog
from mr_experiments.trial.trial import Trial
from mr_experiments.trial.trial_world import world_of
from mr_grid import OccupancyGrid, Pose
from mr_measures.map_picture import picture_of
from mr_measures.motion import RECORD
from mr_measures.occupancy import free_area, occupancy_of
from mr_measures.record.logs import AuctionLog, GoalLog, NoteLog
from mr_measures.record.mission_record import Note, Snapshot
from mr_measures.record.robot_record import Auction, Goal, Offer
from mr_measures.record.series import RobotSeries, TeamSeries
from mr_measures.stored_truth import truth_of_generated
from mr_measures.truth import Truth
from mr_plans import is_generated
from mr_sim.true_world import true_world_of
from mr_sim.world import World
from mr_sim.worlds import find_world

SERIES_PERIOD = 1.0  # s between two samples
COVERAGE_PERIOD = 5.0  # s between two samples of what the team knows
MOTION = ["x", "y", "yaw", "velocity_x", "velocity_y", "velocity_yaw", "stalled", "contact"]


@functools.lru_cache(maxsize=8)
def _truth_of(world: str, starts: tuple[Pose, ...]) -> Truth:
    """Seconds of work, so kept; a process runs many trials in one world."""
    simulated = true_world_of(world_of(Trial(world, len(starts), 0, starts=starts)))
    return truth_of_generated(simulated, find_world(world)) if is_generated(world) else Truth.of_world(simulated)


def truth_for(trial: Trial, world: World) -> Truth:
    """What the maps of the trial are compared with."""
    return _truth_of(trial.world, trial.starts or tuple(world.pose(i) for i in range(trial.robots)))


class RobotLog:
    """One robot's."""

    def __init__(self) -> None:
        self.truth = array("d")  # rows as RECORD; millions of numbers
        self.place: tuple[float, float] | None = None
        self.stalled = 0.0  # s
        self.columns: dict[str, list[Any]] = {field.name: [] for field in fields(RobotSeries)}
        self.goals = GoalLog()
        self.auctions = AuctionLog()
        self.distance = 0.0
        self.global_map: OccupancyGrid | None = None
        self.explored = 0.0
        self.died_at: float | None = None

    @property
    def series(self) -> RobotSeries:
        return RobotSeries(**{name: tuple(column) for name, column in self.columns.items()})


class Recorder:
    """Observes the robots. Times in the record count from the start of the mission."""

    def __init__(self, trial: Trial, world: World, starts: list[Pose], snapshot_period: float) -> None:
        """`starts`: world frame."""
        self.trial, self.world, self.starts = trial, world, starts
        self.truth = truth_for(trial, world)
        # The reference cells as the robots see them, by their true starts.
        self._reference = [start.apply_inverse(self.truth.reference) for start in self.starts]
        self.logs = [RobotLog() for _ in range(trial.robots)]
        self.merges = MergeLog(self.starts, world.names)
        self.team: dict[str, list[float]] = {field.name: [] for field in fields(TeamSeries)}
        self.notes = NoteLog()
        self.snapshots: list[Snapshot] = []
        self._snapshot_period = snapshot_period
        self._snapshot_due = [0.0] * trial.robots
        self._begun_at: float | None = None
        self._sampled_at = -math.inf
        self._covered_at = -math.inf
        self._robots: Sequence[Robot] = ()
        self._radio: TeamRadio | None = None
        self._radios: list[int] = []

    def attach(self, robots: Sequence[Robot], radio: TeamRadio, radios: Sequence[int]) -> None:
        """`radios`: all whose traffic is the team's."""
        self._robots, self._radio, self._radios = robots, radio, list(radios)

    def begin(self, now: float) -> None:
        self._begun_at = now

    def _since(self, now: float) -> float:
        return round(now - self._begun_at, 4) if self._begun_at is not None else 0.0

    def on_step(self, states: np.ndarray, since_start: float) -> None:
        """After each step of the world; `states` as from World.states()."""
        if self._begun_at is None:
            return
        for log, motion in zip(self.logs, states[MOTION].tolist()):
            self._follow(log, motion, since_start)
        if since_start - self._sampled_at >= SERIES_PERIOD - 1e-6:
            self._sampled_at = since_start
            self._sample(states, since_start)
        if since_start - self._covered_at >= COVERAGE_PERIOD - 1e-6:
            self._covered_at = since_start
            self.cover(since_start)

    def _follow(self, log: RobotLog, motion: tuple[float, ...], now: float) -> None:
        x, y, yaw, velocity_x, velocity_y, velocity_yaw, stalled, contact = motion
        speed = velocity_x * math.cos(yaw) + velocity_y * math.sin(yaw)
        if log.place is not None:
            log.distance += math.dist((x, y), log.place)
        log.place = (x, y)
        log.stalled += stalled * self.world.interval
        log.truth.extend((now, now, x, y, yaw, speed, velocity_yaw, stalled, contact))

    def _sample(self, states: np.ndarray, now: float) -> None:
        assert self._radio is not None
        for robot, log, state in zip(self._robots, self.logs, states):
            statistics = self._radio.statistics(robot.own_radio.index)
            local = robot.local_map
            values = {
                "time": round(now, 4),
                "x": round(float(state["x"]), 4),
                "y": round(float(state["y"]), 4),
                "yaw": round(float(state["yaw"]), 4),
                "explored": round(log.explored, 3),
                "own": 0.0 if local is None else round(free_area(local.cells, local.resolution), 3),
                "distance": round(log.distance, 4),
                "stalled": round(log.stalled, 4),
                "bytes": statistics.get("bytes_sent", 0),
                "frames": statistics.get("frames_sent", 0),
                "bids": robot.explorer.bids,
                "state": int(robot.explorer.agent.state),
                "neighbors": tuple(robot.own_radio.neighbors()) if robot.running else (),
            }
            for key, value in values.items():
                log.columns[key].append(value)
        for robot in self._robots:
            self.merges.look(robot, self._robots, now)

    def cover(self, now: float) -> None:
        """Samples what the robots know together, by their own local maps."""
        if self.team["time"] and self.team["time"][-1] == round(now, 4):
            return
        known = np.logical_or.reduce(self.known_cells())
        share = float(known.mean()) if known.size else 0.0
        self.team["time"].append(round(now, 4))
        self.team["coverage"].append(round(share, 5))
        self.team["explored"].append(round(float(known.sum()) * self.truth.cell_area, 3))
        assert self._radio is not None
        traffic = [self._radio.statistics(index) for index in self._radios]
        self.team["distance"].append(round(sum(log.distance for log in self.logs), 4))
        self.team["bytes"].append(sum(one.get("bytes_sent", 0) for one in traffic))
        self.team["frames"].append(sum(one.get("frames_sent", 0) for one in traffic))

    @property
    def team_series(self) -> TeamSeries:
        return TeamSeries(**{name: tuple(column) for name, column in self.team.items()})

    def known_cells(self) -> list[np.ndarray]:
        """For each robot, which of the reference cells its own local map knows: bool (N,)."""
        return [
            occupancy_of(robot.local_map).values_at(places) >= 0 for robot, places in zip(self._robots, self._reference)
        ]

    def records(self, robot: int) -> np.ndarray:
        """True motion as a record array of mr_measures.motion."""
        names = RECORD.names or ()
        columns = np.array(self.logs[robot].truth).reshape(-1, len(names)).T
        records = np.zeros(columns.shape[1], dtype=RECORD)
        for name, column in zip(names, columns):
            records[name] = column
        return records

    # What the robots report.

    def on_pose(self, robot: int, true: Pose) -> None:
        """SLAM has a new pose; `true`: the robot's at that moment, world frame."""
        self.merges.follow(self._robots[robot], true)

    def on_goal(self, robot: int, goal_id: int, pose: Pose, now: float) -> None:
        self.logs[robot].goals.begin(Goal(self._since(now), round(pose.x, 4), round(pose.y, 4), id=goal_id))

    def on_goal_end(self, robot: int, goal_id: int | None, outcome: str, text: str, now: float) -> None:
        self.logs[robot].goals.end(self._since(now), outcome, text)

    def on_auction(self, robot: int, auction: messages.Auction, now: float) -> None:
        if auction.status and auction.start:
            opened = Auction(self._since(now), auction.auction_id, len(auction.requested))
            self.logs[robot].auctions.begin(opened)

    def on_answer(self, robot: int, auction: messages.Auction, now: float) -> None:
        """The robot hears it; it need not be for its own auction."""
        self.logs[robot].auctions.answer(auction.auction_id, auction.robot, self._since(now))

    def on_auction_result(self, robot: int, result: auction_result.AuctionResult, now: float) -> None:
        offers = map(_offer_of, result.offers)
        self.logs[robot].auctions.end(result.auction_id, self._since(now), result.unit, offers)

    def on_global_map(self, robot: int, grid: OccupancyGrid, now: float) -> None:
        log = self.logs[robot]
        log.global_map = grid
        log.explored = free_area(grid.cells, grid.info.resolution)
        if self._begun_at is not None and self._since(now) >= self._snapshot_due[robot]:
            if math.isinf(self._snapshot_period):
                return
            self._snapshot_due[robot] = self._since(now) + self._snapshot_period
            self.snapshots.append(Snapshot.of(self._since(now), self.world.names[robot], picture_of(grid)))

    def on_note(self, robot: int, text: str, warning: bool, now: float) -> None:
        self.note(self.world.names[robot], text, warning, now)

    def note(self, name: str, text: str, warning: bool, now: float) -> None:
        """`name`: of a robot or of the base."""
        self.notes.add(Note(self._since(now), name, text, warning))

    def on_death(self, robot: int, now: float) -> None:
        self.logs[robot].died_at = self._since(now)


def _offer_of(offer: auction_result.Offer) -> Offer:
    (x, y), bids = offer.place, {robot: round(bid, 2) for robot, bid in offer.bids.items() if math.isfinite(bid)}
    return Offer(round(x, 3), round(y, 3), bids, offer.explored_by)
