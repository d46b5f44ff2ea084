#!/usr/bin/env python3
"""Rehearsal of missions in virtual time: several explorer agents in a floor plan, without ROS, to tune strategies.

Maps are perfect (visibility on the bitmap, 8 m, 270 degrees, twice a second), robots follow their planned path at
0.45 m/s and 90 deg/s and stop for one another, messages travel with configurable loss and delay, and each robot's
global map is its own map with those of the others as they were `--merge-period` seconds ago at most.

    rehearse.py --plan PLAN.png --robots 1 2 3 4 --strategies 0 1 3 7 --seeds 3
"""

import argparse
import heapq
import math
import sys
import time
from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Tuple

import cv2
import numpy as np

from explorer.agent import ExplorerAgent
from explorer.grid import GridInfo, OccupancyMap
from explorer.messages import (
    FAILED,
    REACHED,
    AskTransform,
    CancelGoal,
    Note,
    Pose,
    SendAuction,
    SendFrontiers,
    SetGoal,
)
from explorer.options import Options
from explorer.travel import TravelGrid

RESOLUTION = 0.05
STEP = 0.1
SPEED = 0.45
TURN_SPEED = math.radians(80)
BODY = 0.26


@dataclass
class Robot:
    """Truth and state of one simulated robot; poses in the world frame."""

    name: str
    start: Tuple[float, float, float]
    agent: ExplorerAgent
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    own: Any = None
    merged: Any = None
    goal: Optional[SetGoal] = None
    path: List[Tuple[float, float]] = field(default_factory=list)
    planned: float = -math.inf
    blocked: float = 0.0
    distance: float = 0.0
    moving: float = 0.0
    cpu: float = 0.0
    ticks: int = 0
    longest: float = 0.0
    messages: int = 0
    elements: int = 0
    alive: bool = True


class Rehearsal:
    """One mission. `run` returns a dict with the times."""

    def __init__(
        self,
        free: np.ndarray,
        robots: int,
        strategy: int,
        seed: int,
        loss: float = 0.0,
        delay: float = 0.05,
        merge_period: float = 3.0,
        map_period: float = 2.0,
        limit: float = 1500.0,
        radio_range: float = math.inf,
        verbose: bool = False,
        **options: Any,
    ) -> None:
        self.free = free
        self.height, self.width = free.shape
        self.random = np.random.default_rng(seed)
        self.loss, self.delay, self.limit = loss, delay, limit
        self.merge_period, self.map_period, self.range = merge_period, map_period, radio_range
        self.verbose = verbose
        self.now = 0.0
        self.mail: List[Tuple[float, int, int, Any]] = []
        self.count = 0
        self.robots = [self._robot(i, strategy, seed, options) for i in range(robots)]
        self.snapshots: Dict[str, np.ndarray] = {}

    def _robot(self, index: int, strategy: int, seed: int, options: Dict[str, Any]) -> Robot:
        x, y = 1.0 + index // 2, self.height * RESOLUTION - 0.7 - 0.9 * (index % 2)
        x, y = x + self.random.uniform(-0.1, 0.1), y + self.random.uniform(-0.1, 0.1)
        name = f"robot_{index}"
        agent = ExplorerAgent(Options(frontier_selection=strategy, robot_name=name, seed=seed, **options))
        robot = Robot(name, (x, y, 0.0), agent, x, y, 0.0)
        robot.own = np.full(self.free.shape, -1, dtype=np.int8)
        robot.merged = robot.own
        return robot

    # ---- world ----------------------------------------------------------------------------------------------------

    def _scan(self, robot: Robot) -> None:
        angles = robot.yaw + np.radians(np.linspace(-135, 135, 541))
        reach = np.arange(0.0, 8.0, RESOLUTION * 0.7)
        cols = ((robot.x + np.cos(angles)[:, None] * reach) / RESOLUTION).astype(np.int32)
        rows = ((robot.y + np.sin(angles)[:, None] * reach) / RESOLUTION).astype(np.int32)
        np.clip(cols, 0, self.width - 1, out=cols)
        np.clip(rows, 0, self.height - 1, out=rows)
        solid = ~self.free[rows, cols]
        first = np.where(solid.any(axis=1), solid.argmax(axis=1), len(reach))
        before = np.arange(len(reach))[None, :] < first[:, None]
        robot.own[rows[before], cols[before]] = 0
        hit = first < len(reach)
        robot.own[rows[hit, first[hit]], cols[hit, first[hit]]] = 100

    def _merge(self, robot: Robot) -> None:
        merged = robot.own.copy()
        for other in self.robots:
            if other is not robot and other.name in self.snapshots and self._hears(robot, other):
                theirs = self.snapshots[other.name]
                unknown = merged < 0
                merged[unknown] = theirs[unknown]
        robot.merged = merged
        info = GridInfo(RESOLUTION, self.width, self.height, -robot.start[0], -robot.start[1])
        self._timed(robot, robot.agent.on_global_map, OccupancyMap(info, merged), self.now)
        robot.agent.on_own_map(self.now)

    def _hears(self, a: Robot, b: Robot) -> bool:
        return a.alive and b.alive and math.hypot(a.x - b.x, a.y - b.y) <= self.range

    def _local(self, robot: Robot, x: float, y: float) -> Tuple[float, float]:
        return (x - robot.start[0], y - robot.start[1])

    def _timed(self, robot: Robot, call: Any, *arguments: Any) -> Any:
        begin = time.process_time()
        result = call(*arguments)
        took = time.process_time() - begin
        robot.cpu += took
        robot.longest = max(robot.longest, took)
        return result

    # ---- motion ---------------------------------------------------------------------------------------------------

    def _plan(self, robot: Robot) -> None:
        assert robot.goal is not None
        info = GridInfo(RESOLUTION, self.width, self.height, 0.0, 0.0)
        cells = robot.merged.copy()
        for other in self.robots:
            if other is not robot and math.hypot(other.x - robot.x, other.y - robot.y) < 2.5:
                row, col = info.cell_of(other.x, other.y)
                image = np.zeros(cells.shape, dtype=np.uint8)
                cv2.circle(image, (col, row), int(0.3 / RESOLUTION), 1, -1)
                cells[(image > 0) & (cells >= 0)] = 100
        grid = TravelGrid(OccupancyMap(info, cells), 0.25, 0.6)
        field_ = grid.field_from(robot.x, robot.y)
        goal = robot.goal.pose
        robot.path = field_.path_to(goal.x + robot.start[0], goal.y + robot.start[1])[2:]
        robot.planned = self.now

    def _drive(self, robot: Robot) -> None:
        if robot.goal is None or not robot.alive:
            return
        goal = robot.goal.pose
        gx, gy = goal.x + robot.start[0], goal.y + robot.start[1]
        if self.now - robot.planned > 2.0:
            self._plan(robot)
        if math.hypot(gx - robot.x, gy - robot.y) < 0.25:
            self._turn_to(robot, goal.yaw)
            return
        if not robot.path:
            robot.blocked += STEP
            if robot.blocked > 6.0:
                self._result(robot, FAILED)
            return
        while len(robot.path) > 1 and math.hypot(robot.path[0][0] - robot.x, robot.path[0][1] - robot.y) < 0.3:
            robot.path.pop(0)
        tx, ty = robot.path[0]
        heading = math.atan2(ty - robot.y, tx - robot.x)
        error = math.atan2(math.sin(heading - robot.yaw), math.cos(heading - robot.yaw))
        robot.yaw += max(-TURN_SPEED * STEP, min(TURN_SPEED * STEP, error))
        if abs(error) > 0.8:
            robot.moving += STEP
            return
        step = min(SPEED * STEP * max(0.2, math.cos(error)), math.hypot(tx - robot.x, ty - robot.y))
        x, y = robot.x + step * math.cos(robot.yaw), robot.y + step * math.sin(robot.yaw)
        if self._collides(robot, x, y):
            robot.blocked += STEP
            if robot.blocked > 8.0:
                self._result(robot, FAILED)
            return
        robot.blocked = max(0.0, robot.blocked - 0.5 * STEP)
        robot.distance += math.hypot(x - robot.x, y - robot.y)
        robot.moving += STEP
        robot.x, robot.y = x, y
        if len(robot.path) == 1 and math.hypot(tx - x, ty - y) < 0.1:
            robot.path = []
            self._turn_to(robot, goal.yaw)

    def _turn_to(self, robot: Robot, yaw: float) -> None:
        error = math.atan2(math.sin(yaw - robot.yaw), math.cos(yaw - robot.yaw))
        robot.yaw += max(-TURN_SPEED * STEP, min(TURN_SPEED * STEP, error))
        if abs(error) < 0.2:
            self._result(robot, REACHED)

    def _collides(self, robot: Robot, x: float, y: float) -> bool:
        if not self.free[min(self.height - 1, int(y / RESOLUTION)), min(self.width - 1, int(x / RESOLUTION))]:
            return True
        for other in self.robots:
            if other is not robot:
                now, then = math.hypot(other.x - robot.x, other.y - robot.y), math.hypot(other.x - x, other.y - y)
                if then < 2 * BODY and then < now:
                    return True
        return False

    def _result(self, robot: Robot, outcome: str) -> None:
        assert robot.goal is not None
        goal, robot.goal, robot.blocked, robot.path = robot.goal, None, 0.0, []
        robot.agent.on_goal_result(goal.goal_id, outcome, "blocked" if outcome == FAILED else "", self.now)

    # ---- messages -------------------------------------------------------------------------------------------------

    def _apply(self, robot: Robot, effects: List[Any]) -> None:
        for effect in effects:
            if isinstance(effect, SetGoal):
                robot.goal, robot.planned, robot.blocked = effect, -math.inf, 0.0
                robot.agent.on_goal_accepted(effect.goal_id, self.now)
                if self.verbose:
                    x, y = effect.pose.x + robot.start[0], effect.pose.y + robot.start[1]
                    print(f"{self.now:6.1f} {robot.name} at ({robot.x:.1f}, {robot.y:.1f}) goal ({x:.1f}, {y:.1f})")
            elif isinstance(effect, CancelGoal):
                robot.goal = None
            elif isinstance(effect, AskTransform):
                other = next(r for r in self.robots if r.name == effect.robot)
                dx, dy = other.start[0] - robot.start[0], other.start[1] - robot.start[1]
                robot.agent.on_transform(effect.robot, np.array([[1.0, 0, dx], [0, 1.0, dy]]), self.now)
            elif isinstance(effect, (SendFrontiers, SendAuction)):
                robot.messages += 1
                self._send(robot, effect)
            elif isinstance(effect, Note) and self.verbose:
                print(f"{self.now:6.1f} {robot.name}: {effect.text}")

    def _send(self, robot: Robot, effect: Any) -> None:
        for index, other in enumerate(self.robots):
            if other is robot or not self._hears(robot, other) or self.random.random() < self.loss:
                continue
            self.count += 1
            arrival = self.now + self.delay * self.random.uniform(0.5, 1.5)
            heapq.heappush(self.mail, (arrival, self.count, index, effect))

    def _deliver(self) -> None:
        while self.mail and self.mail[0][0] <= self.now:
            _, _, index, effect = heapq.heappop(self.mail)
            robot = self.robots[index]
            if isinstance(effect, SendAuction):
                self._timed(robot, robot.agent.on_auction, effect.auction, self.now)
                self._apply(robot, self._timed(robot, robot.agent.tick, self.now))
            elif effect.topic == "frontiers":
                robot.agent.on_frontiers(effect.elements, self.now)
            elif effect.topic == "visited_frontiers":
                robot.agent.on_visited_frontiers(effect.elements, self.now)
            else:
                robot.agent.on_negotiation_list(effect.elements, self.now)

    # ---- the run --------------------------------------------------------------------------------------------------

    def run(self) -> Dict[str, Any]:
        for robot in self.robots:
            robot.agent.start(0.0)
        step = 0
        while self.now < self.limit:
            self.step(step)
            step += 1
            if all(r.agent.finished_at is not None or not r.alive for r in self.robots):
                break
        return self._summary()

    def step(self, step: int) -> None:
        self.now = round(step * STEP, 3)
        for index, robot in enumerate(self.robots):
            if not robot.alive:
                continue
            if step % 5 == index % 5:
                self._scan(robot)
            if step % int(self.merge_period / STEP) == 3 * index:
                self.snapshots[robot.name] = robot.own.copy()
            if step % int(self.map_period / STEP) == 2 * index:
                self._merge(robot)
            x, y = self._local(robot, robot.x, robot.y)
            if step % 2 == 0:
                robot.agent.on_pose(Pose(x, y, robot.yaw), self.now)
            if step % 10 == 0:
                others = [o for o in self.robots if o is not robot and self._hears(robot, o)]
                robot.agent.on_robots([o.name for o in others], self.now)
                robot.agent.on_positions({o.name: self._local(robot, o.x, o.y) for o in others}, self.now)
            if step % 2 == 1:
                robot.ticks += 1
                self._apply(robot, self._timed(robot, robot.agent.tick, self.now))
            self._drive(robot)
        self._deliver()

    def coverage(self, cells: np.ndarray) -> float:
        """Share of the free cells of the plan that a map knows."""
        _, labels = cv2.connectedComponents(self.free.astype(np.uint8), connectivity=4)
        robot = self.robots[0]
        inside = labels == labels[int(robot.start[1] / RESOLUTION), int(robot.start[0] / RESOLUTION)]
        inside &= cv2.distanceTransform(self.free.astype(np.uint8), cv2.DIST_L2, 5) * RESOLUTION > 0.1
        return float((cells[inside] == 0).mean())

    def _summary(self) -> Dict[str, Any]:
        alive = [r for r in self.robots if r.alive]
        times = [r.agent.exploration_time(self.now) for r in alive]
        done = all(r.agent.finished_at is not None for r in alive)
        return {
            "finished": done,
            "time": max(times),
            "times": [round(t, 1) for t in times],
            "coverage": min(self.coverage(r.merged) for r in alive),
            "distance": sum(r.distance for r in alive),
            "moving": sum(r.moving for r in alive) / sum(times),
            "cpu": sum(r.cpu for r in alive) / sum(times),
            "longest_ms": 1e3 * max(r.longest for r in alive),
            "messages": sum(r.messages for r in alive),
            "goals": sum(r.agent.counters.goals for r in alive),
            "failed": sum(r.agent.counters.goals_failed for r in alive),
        }


def load_plan(path: str) -> np.ndarray:
    """(rows, cols) bool array of the free cells of a bitmap of 0.05 m per pixel, row 0 at the bottom."""
    image = cv2.imread(path, cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise SystemExit(f"rehearse: cannot read the floor plan {path}")
    return np.ascontiguousarray(image[::-1] > 128)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plan", required=True, help="floor plan, PNG, 0.05 m per pixel, dark is wall")
    parser.add_argument("--robots", type=int, nargs="+", default=[1, 2, 3, 4])
    parser.add_argument("--strategies", type=int, nargs="+", default=[0, 1, 3, 7])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--loss", type=float, default=0.0)
    parser.add_argument("--delay", type=float, default=0.05, help="s")
    parser.add_argument("--merge-period", type=float, default=3.0, help="s")
    parser.add_argument("--range", type=float, default=math.inf, help="m")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--limit", type=float, default=1500.0, help="s")
    parser.add_argument("--verbose", action="store_true")
    arguments = parser.parse_args()
    free = load_plan(arguments.plan)
    print("strategy robots  time mean (min..max) s   coverage  distance m  moving  cpu     goals failed messages")
    complete = True
    for strategy in arguments.strategies:
        for robots in arguments.robots:
            results = []
            for seed in range(arguments.first_seed, arguments.first_seed + arguments.seeds):
                mission = Rehearsal(
                    free,
                    robots,
                    strategy,
                    seed,
                    arguments.loss,
                    arguments.delay,
                    arguments.merge_period,
                    radio_range=arguments.range,
                    limit=arguments.limit,
                    verbose=arguments.verbose,
                )
                results.append(mission.run())
            report(strategy, robots, results)
            complete &= all(r["finished"] and r["coverage"] >= 0.97 for r in results)
    return 0 if complete else 1


def report(strategy: int, robots: int, results: List[Dict[str, Any]]) -> None:
    def mean(key: str) -> float:
        return float(np.mean([r[key] for r in results]))

    times = [r["time"] for r in results]
    unfinished = sum(not r["finished"] for r in results)
    print(
        f"{strategy:8d} {robots:6d} {mean('time'):9.0f} ({min(times):.0f}..{max(times):.0f})"
        f" {'':6s} {min(r['coverage'] for r in results):9.3f} {mean('distance'):10.0f} {mean('moving'):8.2f}"
        f" {mean('cpu'):6.3f} {mean('goals'):8.0f} {mean('failed'):5.1f} {mean('messages'):6.0f}"
        + (f"   {unfinished} UNFINISHED" if unfinished else ""),
        flush=True,
    )


if __name__ == "__main__":
    sys.exit(main())
