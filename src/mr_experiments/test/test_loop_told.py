"""SLAM, map mergers and a radio in virtual time: a loop that one robot closes reaches the map of another one."""

from __future__ import annotations

import math
from typing import Iterator

import numpy as np
from scipy import ndimage

from map_merger.options import options_of
from map_merger.transform import displacement
from mr_experiments.common.stopwatch import Stopwatch
from mr_experiments.host.agenda import Agenda
from mr_experiments.host.fast.perfect_radio import PerfectRadio
from mr_experiments.host.merging import Merger
from mr_experiments.host.robot_radio import RobotRadio
from mr_grid import OCCUPIED, OccupancyGrid, Pose
from mr_robot.platforms.engines import defaults_of
from mr_robot.slam.engine import MAP_UPDATE_INTERVAL, LaserScan, Slam
from mr_robot.slam.options import SlamOptions
from mr_sim import _world

RESOLUTION = 0.05  # m
WIDTH, HEIGHT, CORRIDOR = 16.0, 8.0, 2.0  # m, of a corridor all around a block
# m, of the front of the block: x, y, width, height.
NICHES = [(3.0, 2.0, 1.0, 1.2), (6.5, 2.0, 1.4, 0.6), (9.0, 2.0, 0.8, 1.0), (12.0, 2.0, 2.0, 2.5)]
BODY = 0.2  # m, radius
REACH = 5.0  # m, of the laser
BEARINGS = np.radians(np.arange(-135.0, 135.25, 0.5))
STEP, TURN = 0.05, 0.1  # m, rad between two scans
SCAN_PERIOD = 0.1  # s
PLACED = 0.1  # m
PAD = 40  # cells around the plan, in which a wrong map may lie
WALL = 0.15  # m within which what is drawn is a wall
CORNERS = [(1.0, 0.7), (15.0, 0.7), (15.0, 7.0), (1.0, 7.0), (1.0, 0.7)]
PLACES = np.array([[0.0, 0.0], [14.0, 0.0], [14.0, 6.0], [0.0, 6.0]])


def plan() -> np.ndarray:
    """Wall cells. Along the front niches tell the way, so that the maps can be merged; elsewhere only wheels do."""
    cells = np.ones((round(HEIGHT / RESOLUTION), round(WIDTH / RESOLUTION)), np.uint8)
    cells[2:-2, 2:-2] = 0  # within walls of 0.1 m
    at = round(CORRIDOR / RESOLUTION)
    cells[at:-at, at:-at] = 1
    for niche in NICHES:
        x, y, width, height = (round(each / RESOLUTION) for each in niche)
        cells[y : y + height, x : x + width] = 0
    return cells


def way_along(corners: list[tuple[float, float]]) -> Iterator[Pose]:
    """Poses at each scan."""
    yaw = 0.0
    for start, end in zip(corners, corners[1:]):
        heading, length = math.atan2(end[1] - start[1], end[0] - start[0]), math.dist(start, end)
        turn = math.remainder(heading - yaw, 2.0 * math.pi)
        turns, steps = math.ceil(abs(turn) / TURN), round(length / STEP)
        yield from (Pose(*start, yaw + turn * index / turns) for index in range(turns))
        parts = np.linspace(start, end, steps, endpoint=False).tolist()
        yield from (Pose(x, y, heading) for x, y in parts)
        yaw = heading


class Robot:
    """Drives its way and rests at its end. Its wheels err at each step: `error` m after 1 m."""

    def __init__(self, name: str, way: list[Pose], error: float, seed: int, team: Team) -> None:
        self.name, self.start, self.pose, self._way, self._error = name, way[0], way[0], way, error
        self.global_map: OccupancyGrid | None = None
        self.notes: list[str] = []
        self.slam = Slam(SlamOptions(**defaults_of(SlamOptions)))
        self._random, self._team = np.random.default_rng(seed), team
        self._odometry, self._revision, self._map_at = Pose(), 0, -math.inf
        stopwatch, options = Stopwatch(), options_of({"exchange_position": True, "debug": False}, name)
        radio = RobotRadio(team.radio, stopwatch)
        self.merger = Merger(options, (1, seed), team.agenda, radio, stopwatch, self, lambda: team.now)
        radio.index = team.radio.add(name, self, self.start)
        self.merger.start(0.0)
        team.agenda.every(SCAN_PERIOD, 0.0, self._scan)

    def _scan(self, now: float) -> None:
        before, self.pose = self.pose, self._way.pop(0) if self._way else self.pose
        motion = before.between(self.pose)
        slip = self._error * math.sqrt(abs(motion.x)) * self._random.normal()
        self._odometry = self._odometry.compose(Pose(motion.x + slip, motion.y, motion.yaw))
        ranges = self._team.ranges(self)
        seen = np.where(ranges < REACH, ranges + self._random.normal(0.0, 0.01, ranges.size), REACH)
        scan = LaserScan(seen.astype(np.float32), BEARINGS[0], BEARINGS[1] - BEARINGS[0], 0.0, REACH, Pose())
        found = self.slam.process(scan, self._odometry, now).pose
        self.merger.on_pose(*found)
        self.merger.on_scan(scan, found)
        if now - self._map_at >= MAP_UPDATE_INTERVAL and self.slam.revision != self._revision:
            self._map_at, self._revision = now, self.slam.revision
            self.merger.on_local_map(self.slam.map())

    def on_packet(self, topic: str, message: bytes, now: float) -> None:
        assert self.merger.on_packet(topic, message)

    def on_robot_appeared(self, robot: str, now: float) -> None:
        self.merger.on_robot(robot, returned=True)

    def on_robot_lost(self, robot: str, now: float) -> None:
        self.merger.on_robot_lost(robot)

    def on_global_map(self, grid: OccupancyGrid, now: float) -> None:
        self.global_map = grid

    def on_positions(self, positions: dict[str, tuple[float, float]], now: float) -> None:
        pass

    def on_note(self, text: str, warning: bool, now: float) -> None:
        self.notes.append(text)


class Team:
    """One that drives around the block, and one that drives along its front and comes back."""

    def __init__(self) -> None:
        self.agenda, self.now = Agenda(), 0.0
        self.radio = PerfectRadio(self.agenda)
        cells = plan()
        self.raster = _world.Raster(cells, RESOLUTION, (0.0, 0.0))
        self._away = ndimage.distance_transform_edt(np.pad(cells, PAD) == 0) * RESOLUTION
        self.driver = Robot("robot_0", list(way_along(CORNERS)), 0.1, 1, self)
        self.listener = Robot("robot_1", list(way_along([(2.5, 1.5), (13.0, 1.5), (2.5, 1.5)])), 0.0, 1, self)

    def run(self, until: float) -> None:
        """`until`: s."""
        while self.agenda.next_time <= until:
            self.now = self.agenda.next_time
            self.radio.advance(self.now)
            self.agenda.run_due(self.now)

    def ranges(self, robot: Robot) -> np.ndarray:
        """To walls and to the other robot."""
        bearings = robot.pose.yaw + BEARINGS
        walls = self.raster.cast((robot.pose.x, robot.pose.y), bearings, REACH)
        other = self.listener if robot is self.driver else self.driver
        x, y = other.pose.x - robot.pose.x, other.pose.y - robot.pose.y
        along, aside = x * np.cos(bearings) + y * np.sin(bearings), y * np.cos(bearings) - x * np.sin(bearings)
        hit = (np.abs(aside) < BODY) & (along > 0.0)
        return np.where(hit, np.minimum(walls, along - np.sqrt(np.maximum(BODY**2 - aside**2, 0.0))), walls)

    def wrong(self, grid: OccupancyGrid, start: Pose) -> float:
        """Share of the occupied cells that are no wall. `start`: of the robot whose map it is."""
        walls = start.apply(grid.info.centres_of(np.argwhere(grid.cells == OCCUPIED)))
        columns, rows = np.floor(walls / RESOLUTION).astype(int).T + PAD
        return float((self._away[rows, columns] > WALL).mean())


def test_the_map_of_another_robot_follows_when_a_loop_is_closed_and_the_pair_stays_placed() -> None:
    team = Team()
    driver, listener = team.driver, team.listener
    truth, drawn = listener.start.between(driver.start), []
    for now in range(30, 106, 5):
        team.run(now)
        transform, other = listener.merger.transforms()["robot_0"], driver.merger.transforms()["robot_1"]
        assert displacement(truth, transform, PLACES).max() < PLACED
        assert displacement(truth.inverse(), other, PLACES).max() < PLACED
        assert listener.global_map is not None
        drawn.append(team.wrong(listener.global_map, listener.start))
    assert max(drawn) > 0.05, "the driver has to lose its way, and the listener to draw what it is told"
    assert drawn[-1] < 0.01 and team.wrong(driver.slam.map(), driver.start) < 0.01
    assert not [note for note in driver.notes + listener.notes if "revoked" in note]
