"""Robots in virtual time: world engine, SLAM engine and navigation engine in one process, nearest-frontier goals.

    python3 nearest_frontier.py [--world office26x15] [--robots 1] [--seeds 3] [--picture PREFIX]

explores with every seed and prints time, distance, worst and final drift, collisions and CPU time per engine.
"""

import argparse
import math
import time
from typing import Dict, List, Optional, Tuple

import cv2
import numpy as np

from mr_grid import OccupancyGrid, Pose
from mr_robot.navigation.engine import Status
from mr_sim.closed_loop import ClosedLoop, Robot

GOAL_PERIOD = 2.0  # s between choices of a goal


def frontiers(grid: OccupancyGrid) -> List[Tuple[float, float]]:
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
        points.append(grid.info.centre_of(int(rows[best]), int(columns[best])))
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
        from mr_robot import _navigation
        from mr_robot.navigation.planner import CostMap

        assert robot.grid is not None
        slowness = CostMap(robot.grid, robot.navigator.options).slowness(np.empty((0, 2)), pose)
        row, column = robot.grid.info.cell_of(pose[0], pose[1])
        cost = _navigation.march(slowness, [(row, column, 0.0)])

        def way(point: Tuple[float, float]) -> float:
            r, c = robot.grid.info.cell_of(*point)
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


def picture(grid: OccupancyGrid, path: str) -> None:
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
