"""Agents in tiny worlds with perfect maps, radio and driving, on virtual time."""

import math
from dataclasses import dataclass, field
from typing import Any, List, Optional, Sequence

import numpy as np
from conftest import drawn
from usual_robot import options_with

from explorer.agent import ExplorerAgent
from explorer.grid import OccupancyMap
from explorer.messages import (
    FAILED,
    REACHED,
    AskTransform,
    CancelGoal,
    SendAuction,
    SendFrontiers,
    SendStatement,
    SetGoal,
)
from explorer.status import State
from explorer.travel import TravelGrid
from mr_grid import Pose

IDENTITY = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
CELLS_PER_SIGN = 6  # doors of one sign are 0.6 m wide
SPEED = 0.5  # m/s
SENSOR_RANGE = 3.0  # m, in all directions
STEP = 0.25  # s
STEPS_PER_MAP = 4
INBOXES = {
    "frontiers": ExplorerAgent.on_frontiers,
    "visited_frontiers": ExplorerAgent.on_visited_frontiers,
    "negotiation_list": ExplorerAgent.on_negotiation_list,
}


@dataclass
class Robot:
    agent: ExplorerAgent
    pose: Pose
    goal: Optional[SetGoal] = None
    path: List[Any] = field(default_factory=list)


class TinyWorld:
    """Robots in a world drawn as text: '#' wall, '.' floor, digits where robots start. All share one map, which shows
    what they have seen."""

    def __init__(self, rows: Sequence[str], robots: int, strategy: int) -> None:
        self.truth = drawn([_without_digits(row) for row in rows], CELLS_PER_SIGN)
        self.known = np.full_like(self.truth.cells, -1)
        self.now = 0.0
        self._grid = TravelGrid(self.truth, radius=0.2, comfort=0.3)
        self.robots = [self._robot(number, rows, strategy) for number in range(robots)]
        names = [robot.agent.name for robot in self.robots]
        for robot in self.robots:
            robot.agent.on_robots([name for name in names if name != robot.agent.name], self.now)
            robot.agent.start(self.now)

    def _robot(self, number: int, rows: Sequence[str], strategy: int) -> Robot:
        for line, row in enumerate(rows[::-1]):
            if str(number) in row:
                place = ((row.index(str(number)) + 0.5) * CELLS_PER_SIGN, (line + 0.5) * CELLS_PER_SIGN)
                pose = Pose(place[0] * self.truth.info.resolution, place[1] * self.truth.info.resolution, 0.0)
                options = options_with(frontier_selection=strategy, robot_name=f"robot_{number}", seed=number)
                return Robot(ExplorerAgent(options), pose)
        raise ValueError(f"robot {number} is not in the world")

    def finish(self, limit: float) -> float:
        """Runs until all robots are at their ends and returns when, in s; infinite where one is not within `limit`."""
        steps = 0
        while self.now < limit:
            if steps % STEPS_PER_MAP == 0:
                self._map()
            self._step()
            steps += 1
            if all(robot.agent.state >= State.FINISHED for robot in self.robots):
                return self.now
        return math.inf

    def unseen(self) -> float:
        """m^2 of the floor that nobody has seen."""
        return float(np.count_nonzero((self.truth.cells == 0) & (self.known < 0))) * self.truth.info.resolution**2

    def _map(self) -> None:
        occupancy = OccupancyMap(self.truth.info, self.known.copy())
        places = {robot.agent.name: (robot.pose.x, robot.pose.y) for robot in self.robots}
        for robot in self.robots:
            robot.agent.on_global_map(occupancy, self.now)
            robot.agent.on_own_map(self.now)
            others = {name: place for name, place in places.items() if name != robot.agent.name}
            robot.agent.on_positions(others, self.now)

    def _step(self) -> None:
        self.now += STEP
        for robot in self.robots:
            self._drive(robot)
            self._look(robot.pose)
            robot.agent.on_pose(robot.pose, self.now)
        for robot in self.robots:
            for effect in robot.agent.tick(self.now):
                self._carry_out(robot, effect)

    def _drive(self, robot: Robot) -> None:
        way = SPEED * STEP
        while robot.path and way > 0:
            x, y = robot.path[0]
            rest = math.hypot(x - robot.pose.x, y - robot.pose.y)
            share = min(1.0, way / rest) if rest > 0 else 1.0
            yaw = math.atan2(y - robot.pose.y, x - robot.pose.x) if rest > 0 else robot.pose.yaw
            place = (robot.pose.x + share * (x - robot.pose.x), robot.pose.y + share * (y - robot.pose.y))
            robot.pose = Pose(*place, yaw)
            way -= rest
            if share == 1.0:
                robot.path.pop(0)
        if robot.goal is not None and not robot.path:
            robot.pose = Pose(robot.pose.x, robot.pose.y, robot.goal.pose.yaw)
            robot.agent.on_goal_result(robot.goal.goal_id, REACHED, "", self.now)
            robot.goal = None

    def _look(self, pose: Pose) -> None:
        """Shows the cells along rays up to the first wall."""
        resolution = self.truth.info.resolution
        angles = np.linspace(0.0, 2 * math.pi, 240, endpoint=False)[:, None]
        lengths = np.arange(0.0, SENSOR_RANGE, resolution / 2)[None, :]
        rows = ((pose.y + lengths * np.sin(angles)) / resolution).astype(int).clip(0, self.truth.cells.shape[0] - 1)
        columns = ((pose.x + lengths * np.cos(angles)) / resolution).astype(int).clip(0, self.truth.cells.shape[1] - 1)
        hits = self.truth.cells[rows, columns] > 0
        seen = np.cumsum(hits, axis=1) - hits == 0
        self.known[rows[seen], columns[seen]] = self.truth.cells[rows[seen], columns[seen]]

    def _carry_out(self, robot: Robot, effect: Any) -> None:
        others = [other.agent for other in self.robots if other is not robot]
        if isinstance(effect, SetGoal):
            robot.agent.on_goal_accepted(effect.goal_id, self.now)
            field = self._grid.field_from(robot.pose.x, robot.pose.y)
            robot.path = field.path_to(effect.pose.x, effect.pose.y)
            robot.goal = effect if robot.path else None
            if not robot.path:
                robot.agent.on_goal_result(effect.goal_id, FAILED, "no way", self.now)
        elif isinstance(effect, CancelGoal):
            robot.goal, robot.path = None, []
        elif isinstance(effect, AskTransform):
            robot.agent.on_transform(effect.robot, IDENTITY, self.now)
        elif isinstance(effect, SendAuction):
            for agent in others:
                agent.on_auction(effect.auction, self.now)
        elif isinstance(effect, SendStatement):
            for agent in others:
                agent.on_statement(effect.statement, self.now)
        elif isinstance(effect, SendFrontiers):
            for agent in others:
                INBOXES[effect.topic](agent, effect.elements, self.now)


def _without_digits(row: str) -> str:
    return "".join("." if sign.isdigit() else sign for sign in row)
