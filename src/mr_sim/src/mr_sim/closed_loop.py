"""World and bodies closed to a loop in one process and in virtual time, for goals that a test or a benchmark sets.
Teams that explore run in `mr_experiments.host.mission`."""

import itertools
import math
import time
from contextlib import contextmanager
from typing import Any, Callable, Dict, Iterator, List, Optional, Tuple, Union

import numpy as np

from mr_grid import OccupancyGrid, Pose, normalized
from mr_robot.navigation.engine import Navigator
from mr_robot.navigation.options import NavigationOptions
from mr_robot.platforms.engines import navigation_options, slam_options
from mr_robot.platforms.parameters import kinds_of
from mr_robot.slam.engine import Slam, SlamOptions
from mr_sim.body import Body
from mr_sim.simulated_platform import platform_of
from mr_sim.world import World
from mr_sim.world_description import RangerDescription, WorldDescription
from mr_sim.world_model import load_world
from mr_sim.worlds import find_world

SUCCEEDED = "succeeded"
POSITIONS_PERIOD = 2.0  # s between positions of the others


class Robot:
    """A body, how its goals ended, and how far it is from the truth."""

    def __init__(
        self, index: int, name: str, start: Pose, ranger: RangerDescription, slam: SlamOptions,
        navigation: NavigationOptions, seed: int,
    ) -> None:  # fmt: skip
        self.index, self.start = index, start
        self.drift: List[float] = []  # m, with each scan
        self.turn_drift: List[float] = []  # rad
        self.contacts = 0  # steps of the world
        self.velocities = (0.0, 0.0)  # m/s, rad/s
        self.results: List[Tuple[float, str]] = []  # s, SUCCEEDED or why not
        self.navigation_cpu = 0.0  # s
        self.grid: Optional[OccupancyGrid] = None
        self.positions_at = -math.inf  # s, those of the others
        self.body = Body(name, ranger, slam, navigation, seed, self._measured)
        self.body.on_goal_end = self._on_goal_end
        self._goals = itertools.count()
        self._now = 0.0

    @property
    def slam(self) -> Slam:
        return self.body.slam

    @property
    def navigator(self) -> Navigator:
        return self.body.navigator

    def local(self, pose: Pose) -> Pose:
        """A pose of the world in the robot's map frame."""
        return self.start.between(pose)

    def set_goal(self, pose: Pose, now: float) -> None:
        """`pose`: in the robot's map frame."""
        self._now = now
        self.body.set_goal(next(self._goals), pose, now)

    def control(self, odometry: Pose, now: float) -> bool:
        """Whether there are new velocities."""
        self._now = now
        velocities = self.body.steer(odometry, now)
        if velocities is None:
            return False
        self.velocities = velocities
        return True

    def _on_goal_end(self, _: int, reached: bool, text: str) -> None:
        self.results.append((self._now, SUCCEEDED if reached else text))

    @contextmanager
    def _measured(self, component: str) -> Iterator[None]:
        begun = time.process_time()
        yield
        if component == "navigation":
            self.navigation_cpu += time.process_time() - begun


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
                i, name, self.world.pose(i), description.rangers[description.main_ranger],
                slam_options(platform, team), navigation_options(platform, team, **navigation), seed,
            )
            for i, (name, platform, description) in enumerate(zip(self.world.names, platforms, self.world.robots))
        ]  # fmt: skip
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
        now = self.world.time
        pose = robot.body.locate(robot.body.scan_of(ranges), _odometry(state), now)
        own = robot.body.new_map(now)
        truth = robot.local(Pose(float(state["x"]), float(state["y"]), float(state["yaw"])))
        robot.drift.append(math.dist(pose[:2], truth[:2]))
        robot.turn_drift.append(abs(normalized(pose[2] - truth[2])))
        if self.on_scan is not None:
            self.on_scan(robot, pose)
        if own is not None:
            robot.grid = own
            robot.body.set_map(self.merge(robot, own))
        if self.share_positions and now - robot.positions_at >= POSITIONS_PERIOD:
            robot.positions_at = now
            robot.body.set_others(self._positions(robot), now)

    def _control(self, robot: Robot, state: np.ndarray) -> None:
        """If it is time for it."""
        if robot.control(_odometry(state), self.world.time):
            self.world.command(robot.index, *robot.velocities)

    def _positions(self, robot: Robot) -> Dict[str, Tuple[float, float]]:
        return {
            other.navigator.name: robot.local(self.world.pose(other.index))[:2]
            for other in self.robots
            if other is not robot
        }


def _odometry(state: np.ndarray) -> Pose:
    return Pose(float(state["odometry_x"]), float(state["odometry_y"]), float(state["odometry_yaw"]))
