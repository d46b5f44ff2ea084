"""Robots in virtual time: world engine, SLAM engine and navigation engine in one process, nearest-frontier goals.

    python3 closed_loop.py [--world office26x15] [--robots 1] [--seeds 3] [--picture PREFIX]

explores with every seed and prints time, distance, worst and final drift, collisions and CPU time per engine.
"""

import argparse
import math
import time
from dataclasses import dataclass, field
from typing import Callable, Dict, List, Optional, Tuple

import cv2
import numpy as np

from mr_sim.navigation.engine import Command, Navigator, Status
from mr_sim.navigation.options import Grid, NavigationOptions, make_scan
from mr_sim.slam.engine import LaserScan, Slam
from mr_sim.slam.pose import Pose, compose, inverse, normalized
from mr_sim.world import World
from mr_sim.world_model import load_world
from mr_sim.worlds import find_world

MAP_PERIOD = 2.0  # s between maps handed to navigation
GOAL_PERIOD = 2.0  # s between choices of a goal


@dataclass
class Robot:
    index: int
    start: Pose
    slam: Slam
    navigator: Navigator
    drift: List[float] = field(default_factory=list)
    turn_drift: List[float] = field(default_factory=list)
    distance: float = 0.0
    contacts: int = 0
    touched: List[Tuple[float, Pose, str]] = field(default_factory=list)
    command: Optional[Command] = None
    results: List[Tuple[float, str]] = field(default_factory=list)
    cpu: Dict[str, float] = field(default_factory=lambda: {"slam": 0.0, "navigation": 0.0})
    map_at: float = -math.inf
    grid: Optional[Grid] = None

    def local(self, pose: Pose) -> Pose:
        """A pose of the world in the robot's map frame."""
        return compose(inverse(self.start), pose)


class ClosedLoop:
    """Steps the world; scans go to SLAM, its pose and map to navigation, the commands back."""

    def __init__(self, world: str, robots: int, seed: int, options: Optional[NavigationOptions] = None) -> None:
        self.world = World(load_world(find_world(world)), robots=robots, seed=seed)
        self.robots = [
            Robot(i, self.world.pose(i), Slam(), Navigator(options, name, seed))
            for i, name in enumerate(self.world.names)
        ]
        self.on_scan: Optional[Callable[[Robot, Pose], None]] = None
        self.share_positions = True

    def run(self, until: float, stop: Callable[[], bool] = lambda: False) -> None:
        while self.world.time < until and not stop():
            self.world.step()
            states = self.world.states()
            for robot, state in zip(self.robots, states):
                robot.distance += math.hypot(state["velocity_x"], state["velocity_y"]) * self.world.interval
                if state["contact"]:
                    robot.contacts += 1
                    robot.touched.append(
                        (
                            self.world.time,
                            robot.local((state["x"], state["y"], state["yaw"])),
                            robot.navigator.mode.value,
                        )
                    )
            for scan in self.world.due_scans():
                self._control(self.robots[scan.robot], states[scan.robot], scan.ranges)

    def _control(self, robot: Robot, state: np.ndarray, ranges: np.ndarray) -> None:
        ranger = self.world.robots[robot.index].rangers[0]
        now = self.world.time
        odometry = (float(state["odometry_x"]), float(state["odometry_y"]), float(state["odometry_yaw"]))
        begun = time.process_time()
        geometry = (ranger.angle_min, ranger.angle_increment, ranger.range_min, ranger.range_max, ranger.mount)
        pose = robot.slam.process(LaserScan(ranges, *geometry), odometry).pose
        if now - robot.map_at >= MAP_PERIOD:
            robot.map_at = now
            map_ = robot.slam.map()
            robot.grid = Grid(map_.cells, map_.resolution, map_.origin)
        robot.cpu["slam"] += time.process_time() - begun
        truth = robot.local((float(state["x"]), float(state["y"]), float(state["yaw"])))
        robot.drift.append(math.dist(pose[:2], truth[:2]))
        robot.turn_drift.append(abs(normalized(pose[2] - truth[2])))
        if self.on_scan is not None:
            self.on_scan(robot, pose)
        begun = time.process_time()
        if robot.map_at == now and robot.grid is not None:
            robot.navigator.set_map(robot.grid)
            if self.share_positions:
                robot.navigator.set_others(self._positions(robot), now)
        robot.command = robot.navigator.step(now, pose, make_scan(ranges, *geometry))
        robot.cpu["navigation"] += time.process_time() - begun
        if robot.command.status in (Status.SUCCEEDED, Status.ABORTED):
            robot.results.append((now, robot.command.text or "succeeded"))
        self.world.command(robot.index, robot.command.linear, robot.command.angular)

    def _positions(self, robot: Robot) -> Dict[str, Tuple[float, float]]:
        return {
            other.navigator.name: robot.local(self.world.pose(other.index))[:2]
            for other in self.robots
            if other is not robot
        }


def frontiers(grid: Grid) -> List[Tuple[float, float]]:
    """Middles of the groups of free cells that border the unknown."""
    free, unknown = grid.cells == 0, (grid.cells < 0).astype(np.uint8)
    border = free & (cv2.dilate(unknown, np.ones((3, 3), np.uint8)) > 0)
    count, labels, statistics, centers = cv2.connectedComponentsWithStats(border.astype(np.uint8))
    points = []
    for label in range(1, count):
        if statistics[label, cv2.CC_STAT_AREA] < 8:
            continue
        rows, columns = np.nonzero(labels == label)
        best = int(np.argmin(np.hypot(columns - centers[label][0], rows - centers[label][1])))
        points.append(grid.center(int(rows[best]), int(columns[best])))
    return points


class NearestFrontier:
    """Sends each robot to the frontier nearest to it, and again when that is seen or reached."""

    def __init__(self, loop: ClosedLoop) -> None:
        self.loop = loop
        self.goals: Dict[int, Optional[Tuple[float, float]]] = {}
        self.asked: Dict[int, float] = {}
        self.failed: Dict[int, List[Tuple[float, float]]] = {robot.index: [] for robot in loop.robots}
        self.done: Dict[int, float] = {}
        loop.on_scan = self.choose

    def finished(self) -> bool:
        return len(self.done) == len(self.loop.robots)

    def choose(self, robot: Robot, pose: Pose) -> None:
        now = self.loop.world.time
        if robot.grid is None or now - self.asked.get(robot.index, -math.inf) < GOAL_PERIOD:
            return
        self.asked[robot.index] = now
        command, goal = robot.command, self.goals.get(robot.index)
        idle = command is None or command.status is not Status.ACTIVE
        if idle and goal is not None:
            self.failed[robot.index].append(goal)
        open_ = [f for f in frontiers(robot.grid) if all(math.dist(f, g) > 0.5 for g in self.failed[robot.index])]
        if not open_:
            self.done.setdefault(robot.index, now)
            self.goals[robot.index] = None
            robot.navigator.cancel()
            return
        self.done.pop(robot.index, None)
        if not idle and goal is not None and any(math.dist(f, goal) < 0.7 for f in open_):
            return
        nearest = self._nearest(robot, pose, open_)
        self.goals[robot.index] = nearest
        robot.navigator.set_goal((nearest[0], nearest[1], 0.0), now)

    def _nearest(self, robot: Robot, pose: Pose, points: List[Tuple[float, float]]) -> Tuple[float, float]:
        from mr_sim import _navigation
        from mr_sim.navigation.planner import CostMap

        assert robot.grid is not None
        slowness = CostMap(robot.grid, robot.navigator.options).slowness(np.empty((0, 2)), pose)
        row, column = robot.grid.cell(pose[0], pose[1])
        cost = _navigation.march(slowness, [(row, column, 0.0)])

        def way(point: Tuple[float, float]) -> float:
            r, c = robot.grid.cell(*point)
            window = cost[max(0, r - 8) : r + 9, max(0, c - 8) : c + 9]
            return float(window.min())

        return min(points, key=way)


def report(loop: ClosedLoop, explorer: NearestFrontier, wall: float) -> str:
    lines = []
    for robot in loop.robots:
        cpu = ", ".join(f"{name} {1e2 * used / loop.world.time:.1f} %" for name, used in robot.cpu.items())
        drift = np.array(robot.drift)
        lines.append(
            f"  {robot.navigator.name}: done {explorer.done.get(robot.index, math.nan):.0f} s, {robot.distance:.0f} m, "
            f"{robot.distance / loop.world.time:.2f} m/s, "
            f"drift mean {drift.mean():.3f} max {drift.max():.3f} end {drift[-1]:.3f} m "
            f"yaw max {math.degrees(max(robot.turn_drift)):.2f} deg, contacts {robot.contacts}, of a core: {cpu}"
        )
        lines += [
            f"    {when:.2f} s: touched at {pose[0]:.2f} {pose[1]:.2f} {pose[2]:.2f}: {mode}"
            for when, pose, mode in robot.touched[:5]
        ]
        lines += [f"    {when:.0f} s: {text}" for when, text in robot.results if text != "succeeded"]
    return f"{loop.world.time:.0f} s in {wall:.0f} s\n" + "\n".join(lines)


def picture(grid: Grid, path: str) -> None:
    image = np.where(grid.cells < 0, 128, np.where(grid.cells > 50, 0, 255)).astype(np.uint8)
    cv2.imwrite(path, np.flipud(image))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--world", default="office26x15")
    parser.add_argument("--robots", type=int, default=1)
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--duration", type=float, default=900.0)
    parser.add_argument("--picture", help="prefix of PNG files with the maps")
    arguments = parser.parse_args()
    for seed in range(arguments.first_seed, arguments.first_seed + arguments.seeds):
        loop = ClosedLoop(arguments.world, arguments.robots, seed)
        explorer = NearestFrontier(loop)
        begun = time.monotonic()
        loop.run(arguments.duration, explorer.finished)
        print(f"seed {seed}: {report(loop, explorer, time.monotonic() - begun)}", flush=True)
        for robot in loop.robots:
            if arguments.picture and robot.grid is not None:
                picture(robot.grid, f"{arguments.picture}{seed}_{robot.navigator.name}.png")


if __name__ == "__main__":
    main()
