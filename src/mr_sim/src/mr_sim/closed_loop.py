"""World, SLAM and navigation engines closed to a loop in one process and in virtual time, for goals that a test or a
benchmark sets. Teams that explore run in `mr_experiments.host.mission`."""

import math
import time
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, Optional, Tuple, Union

import numpy as np

from mr_grid import OccupancyGrid, Pose, normalized
from mr_robot.navigation.engine import Command, Navigator, Status
from mr_robot.platforms.engines import navigation_options, slam_options
from mr_robot.platforms.parameters import kinds_of
from mr_robot.slam.engine import LaserScan, Slam
from mr_sim.control_cycle import ControlCycle
from mr_sim.simulated_platform import platform_of
from mr_sim.world import World
from mr_sim.world_description import WorldDescription
from mr_sim.world_model import load_world
from mr_sim.worlds import find_world

MAP_PERIOD = 2.0  # s between maps handed to navigation


@dataclass
class Robot:
    index: int
    start: Pose
    slam: Slam
    navigator: Navigator
    cycle: ControlCycle
    drift: List[float] = field(default_factory=list)
    turn_drift: List[float] = field(default_factory=list)
    contacts: int = 0
    command: Optional[Command] = None
    results: List[Tuple[float, str]] = field(default_factory=list)
    navigation_cpu: float = 0.0  # s
    map_at: float = -math.inf
    grid: Optional[OccupancyGrid] = None

    def local(self, pose: Pose) -> Pose:
        """A pose of the world in the robot's map frame."""
        return self.start.between(pose)


class ClosedLoop:
    """Steps the world; scans go to SLAM, its pose and map to navigation, the commands back."""

    def __init__(self, world: Union[str, WorldDescription], robots: int, seed: int, **navigation: Any) -> None:
        """`world`: a description, or what `find_world` knows; its robots are what their models say. `navigation`:
        options in place of those that follow from that. Raises PlatformError for a robot that cannot explore."""
        description = load_world(find_world(world)) if isinstance(world, str) else world
        self.world = World(description, robots=robots, seed=seed)
        platforms = [platform_of(robot) for robot in self.world.robots]
        team = kinds_of(platforms)
        self.robots = [
            Robot(
                i,
                self.world.pose(i),
                Slam(slam_options(platform, team)),
                Navigator(options, name, seed),
                ControlCycle(description.rangers[description.main_ranger], options.controller_period),
            )
            for i, (name, platform, description) in enumerate(zip(self.world.names, platforms, self.world.robots))
            for options in [navigation_options(platform, team, **navigation)]
        ]
        self.on_scan: Optional[Callable[[Robot, Pose], None]] = None
        # The map to plan on, from the own one.
        self.merge: Callable[[Robot, OccupancyGrid], OccupancyGrid] = lambda robot, grid: grid
        self.share_positions = True

    def run(self, until: float, stop: Callable[[], bool] = lambda: False) -> None:
        while self.world.time < until and not stop():
            self.world.step()
            states = self.world.states()
            for robot, state in zip(self.robots, states):
                robot.contacts += bool(state["contact"])
            for scan in self.world.due_scans():
                if scan.ranger == self.world.robots[scan.robot].main_ranger:
                    robot = self.robots[scan.robot]
                    self._locate(robot, states[scan.robot], scan.ranges)
                    self._control(robot, states[scan.robot])
            for robot, state in zip(self.robots, states):
                self._control(robot, state)

    def _locate(self, robot: Robot, state: np.ndarray, ranges: np.ndarray) -> None:
        description = self.world.robots[robot.index]
        ranger = description.rangers[description.main_ranger]
        now = self.world.time
        odometry = _odometry(state)
        robot.cycle.see(ranges, odometry, now)
        geometry = (ranger.angle_min, ranger.angle_increment, ranger.range_min, ranger.range_max, ranger.mount)
        pose = robot.slam.process(LaserScan(ranges, *geometry), odometry, now).pose
        if now - robot.map_at >= MAP_PERIOD:
            robot.map_at = now
            robot.grid = robot.slam.map()
        truth = robot.local(Pose(float(state["x"]), float(state["y"]), float(state["yaw"])))
        robot.drift.append(math.dist(pose[:2], truth[:2]))
        robot.turn_drift.append(abs(normalized(pose[2] - truth[2])))
        if self.on_scan is not None:
            self.on_scan(robot, pose)
        if robot.map_at == now and robot.grid is not None:
            begun = time.process_time()
            robot.navigator.set_own_map(robot.grid, now)
            robot.navigator.set_map(self.merge(robot, robot.grid))
            if self.share_positions:
                robot.navigator.set_others(self._positions(robot), now)
            robot.navigation_cpu += time.process_time() - begun

    def _control(self, robot: Robot, state: np.ndarray) -> None:
        """If it is time for it."""
        now, odometry = self.world.time, _odometry(state)
        if not robot.cycle.due(now):
            return
        begun = time.process_time()
        robot.command = robot.navigator.step(now, robot.slam.pose_at(odometry), robot.cycle.scan(odometry))
        robot.navigation_cpu += time.process_time() - begun
        if robot.command.status in (Status.SUCCEEDED, Status.ABORTED):
            robot.results.append((now, robot.command.text or "succeeded"))
        self.world.command(robot.index, robot.command.linear, robot.command.angular)

    def _positions(self, robot: Robot) -> Dict[str, Tuple[float, float]]:
        return {
            other.navigator.name: robot.local(self.world.pose(other.index))[:2]
            for other in self.robots
            if other is not robot
        }


def _odometry(state: np.ndarray) -> Pose:
    return Pose(float(state["odometry_x"]), float(state["odometry_y"]), float(state["odometry_yaw"]))
