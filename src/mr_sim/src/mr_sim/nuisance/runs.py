"""Runs a scene: world, SLAM and navigation as a loop in virtual time."""

import math
from dataclasses import dataclass

from mr_grid import Pose
from mr_sim.closed_loop import SUCCEEDED, ClosedLoop, Robot
from mr_sim.nuisance.merged import MergedMap
from mr_sim.nuisance.scenes import Scene, draw
from mr_sim.worlds import robot_named

SETTLED = 2.5  # s until there is a map
PATIENCE, SLOWEST = 20.0, 0.1  # s and m/s: a goal not reached within PATIENCE + way / SLOWEST counts as stuck
PIONEER = "pioneer"


@dataclass(frozen=True)
class GoalRun:
    """`why`: what navigation said of a goal that was not reached, empty if it said nothing."""

    robot: int
    goal: tuple[float, float]
    reached: bool
    seconds: float
    ideal: float  # s
    why: str


@dataclass(frozen=True)
class SceneRun:
    kind: str
    seed: int
    goals: tuple[GoalRun, ...]
    contacts: int  # steps in which a robot touched something
    commands: int
    navigation: float  # s of processor time for them
    slowest: float  # s of processor time for one

    @property
    def stuck(self) -> int:
        return sum(not goal.reached for goal in self.goals)


class _Errands:
    """Gives one robot its goals one after the other, until one is not reached."""

    def __init__(self, loop: ClosedLoop, robot: Robot, scene: Scene) -> None:
        self._loop, self._robot, self._scene = loop, robot, scene
        self._left = list(scene.goals[robot.index])
        self._since = self._ideal = 0.0
        self.runs: list[GoalRun] = []
        self._next()

    @property
    def done(self) -> bool:
        return not self._left

    def look(self) -> None:
        """Once per step of the world."""
        if self.done:
            return
        seconds = self._loop.world.time - self._since
        if self._robot.results:
            _, text = self._robot.results[-1]
            self._end(text == SUCCEEDED, seconds, "" if text == SUCCEEDED else text)
        elif seconds > PATIENCE + self._ideal * self._scene.reach.drive.max_linear_velocity / SLOWEST:
            self._end(False, seconds, "")

    def _end(self, reached: bool, seconds: float, why: str) -> None:
        goal = self._left.pop(0)
        self.runs.append(GoalRun(self._robot.index, goal, reached, seconds, self._ideal, why))
        if not reached:
            self._left.clear()
        self._robot.body.cancel()
        self._next()

    def _next(self) -> None:
        if self.done:
            return
        goal, self._since = self._left[0], self._loop.world.time
        self._ideal = self._scene.reach.seconds(self._loop.world.pose(self._robot.index), goal)
        if not math.isfinite(self._ideal):
            # The goal before was reached in a pose between those of the lattice.
            way = math.dist(self._loop.world.pose(self._robot.index)[:2], goal)
            self._ideal = way / self._scene.reach.drive.max_linear_velocity
        self._robot.results.clear()
        self._robot.set_goal(self._robot.local(Pose(*goal)), self._loop.world.time)


def run_seed(seed: int, kind: str = PIONEER) -> SceneRun:
    """Draws the scene of a seed and runs it. `kind`: of all its robots, as `robot_named` takes it, with its errors."""
    return run(draw(seed, robot_named(kind)))


def run(scene: Scene) -> SceneRun:
    loop = ClosedLoop(scene.world, len(scene.goals), scene.seed)
    merged = MergedMap(scene.world, scene.map_error)
    loop.merge = lambda robot, grid: merged.of(grid, robot.start)
    loop.share_positions = scene.hints
    commands, slowest = 0, 0.0
    spent = [0.0] * len(loop.robots)

    def count(robot: Robot, _: Pose) -> None:
        nonlocal commands, slowest
        commands += 1
        slowest = max(slowest, robot.navigation_cpu - spent[robot.index])
        spent[robot.index] = robot.navigation_cpu

    loop.on_scan = count
    loop.run(SETTLED)
    errands = [_Errands(loop, robot, scene) for robot in loop.robots]

    def stop() -> bool:
        for errand in errands:
            errand.look()
        return all(errand.done for errand in errands)

    loop.run(math.inf, stop)
    return SceneRun(
        scene.kind, scene.seed, tuple(goal for errand in errands for goal in errand.runs),
        sum(robot.contacts for robot in loop.robots), commands,
        sum(robot.navigation_cpu for robot in loop.robots), slowest,
    )  # fmt: skip
