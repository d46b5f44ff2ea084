"""Scenes in which robots get stuck: drawn as promised, and counted as defined."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Callable, List

import numpy as np
import pytest

from mr_grid import OccupancyGrid, Pose
from mr_sim.bench_navigation import rows
from mr_sim.closed_loop import ClosedLoop
from mr_sim.nuisance import reach as reach_module
from mr_sim.nuisance.merged import MergedMap
from mr_sim.nuisance.reach import Reach
from mr_sim.nuisance.runs import PIONEER, GoalRun, SceneRun, run_seed
from mr_sim.nuisance.scenes import KINDS, STANDING_ROOM, draw
from mr_sim.world_description import Obstacle, WorldDescription
from mr_sim.worlds import WorldNotFoundError, robot_named

ROBOT = robot_named(PIONEER)
HUSKY = """define husky position ( size [ 0.99 0.67 0.39 ] velocity_bounds [ -1 1 0 0 0 0 -115 115 ] localization "odom"
  odom_error [ 0.03 0.03 0 0.05 ] ranger ( update_interval 100 pose [ 0.3 0 0 0 ]
  sensor ( range [ 0 8 ] fov 270 samples 541 noise [ 0.0001 0 0 ] ) ) )"""


@pytest.fixture
def husky(tmp_path: Path) -> str:
    (tmp_path / "husky.inc").write_text(HUSKY)
    return str(tmp_path / "husky.inc")


def world_of(*boxes: tuple) -> WorldDescription:
    """An area of 6 m x 4 m with boxes (left, bottom, right, top) in it."""
    obstacles = []
    for left, bottom, right, top in [(0, 0, 6, 0.1), (0, 3.9, 6, 4), (0, 0, 0.1, 4), (5.9, 0, 6, 4), *boxes]:
        a, b = (right - left) / 2, (top - bottom) / 2
        corners = ((-a, -b), (a, -b), (a, b), (-a, b))
        middle = Pose((left + right) / 2, (bottom + top) / 2, 0.0)
        obstacles.append(Obstacle(middle, (2 * a, 2 * b), (corners,), None, False, True, True))
    return WorldDescription(Path("test"), 0.02, 0.05, 0.0, None, tuple(obstacles), (ROBOT,))


def test_way_in_the_open_takes_as_long_as_driving_it() -> None:
    assert Reach(world_of()).seconds(Pose(1.0, 2.0, 0.0), (5.0, 2.0)) == pytest.approx(8.0, abs=0.4)
    assert Reach(world_of()).seconds(Pose(1.0, 2.0, math.pi), (5.0, 2.0)) == pytest.approx(8.0, abs=0.4), "backwards"


def test_ways_are_as_long_wherever_one_stops_to_look(monkeypatch: pytest.MonkeyPatch) -> None:
    """To the other side of a wall it is much farther than the straight line."""
    world, starts = world_of((0.1, 2.0, 4.9, 2.1)), (Pose(0.5, 2.5, 0.0), Pose(4.0, 3.0, 1.0), Pose(2.0, 1.0, 3.0))

    def ways() -> List[float]:
        reach = Reach(world)
        return [reach.seconds(start, (0.6, 1.5)) for start in starts]

    soon = ways()
    assert soon[0] > 4.0 * reach_module.TURNING
    monkeypatch.setattr(reach_module, "TURNING", math.inf)
    assert ways() == soon


@pytest.mark.parametrize("width, open_", [(0.36, False), (0.5, True)])
def test_a_gap_is_passed_by_what_fits_through(width: float, open_: bool) -> None:
    walls = ((3.0, 0.0, 3.1, 2.0 - width / 2), (3.0, 2.0 + width / 2, 3.1, 4.0))
    assert math.isfinite(Reach(world_of(*walls)).seconds(Pose(1.0, 2.0, 0.0), (5.0, 2.0))) == open_


def test_a_bend_needs_room_to_turn() -> None:
    """A disc of the robot's width would pass."""
    for width, open_ in ((0.46, False), (0.8, True)):
        walls = (
            (0.1, 0.1, 3.0, 2.0),
            (0.1, 2.0 + width, 3.0 + width, 3.9),
            (3.0 + width, 2.0 - width, 3.2 + width, 3.9),
        )
        assert math.isfinite(Reach(world_of(*walls)).seconds(Pose(0.5, 2.0 + width / 2, 0.0), (5.0, 1.0))) == open_


@pytest.mark.parametrize("seed", range(len(KINDS)))
def test_scenes_come_from_their_seed(seed: int) -> None:
    scene, again = draw(seed, ROBOT), draw(seed, ROBOT)
    assert scene.world == again.world and scene.goals == again.goals and scene.map_error == again.map_error
    assert scene.kind == list(KINDS)[seed]
    assert scene.world.obstacles != draw(seed + len(KINDS), ROBOT).world.obstacles or scene.kind == "along a wall"
    for robot, goals in zip(scene.world.robots, scene.goals):
        assert scene.reach.stands(robot.start, STANDING_ROOM)
        assert all(math.isfinite(scene.reach.seconds(robot.start, goal)) for goal in goals)


def test_own_cells_win_over_those_of_a_map_drawn_beside() -> None:
    merged = MergedMap(world_of(), Pose(0.3, 0.0, 0.0))
    own = OccupancyGrid.of(np.full((40, 40), -1, np.int8), 0.05, Pose(-1.0, -1.0))
    own.cells[20, 20] = 100
    grid = merged.of(own, Pose(3.0, 2.0, 0.0))
    assert grid.cells[grid.info.cell_of(0.025, 0.025)] == 100
    assert grid.cells[grid.info.cell_of(1.0, 1.0)] == 0
    assert grid.cells[grid.info.cell_of(-2.65, 0.0)] == 100, "the wall at x = 0 is drawn at 0.3"
    assert grid.cells[grid.info.cell_of(-2.95, 0.0)] == -1


def test_a_goal_that_is_not_reached_counts() -> None:
    reached = GoalRun(0, (1.0, 1.0), True, 12.0, 8.0, "")
    run = SceneRun("desks", 2, (reached, replace(reached, reached=False)), 3, 100, 0.1, 0.01)
    values = {row.what: row.value for row in rows([run, replace(run, goals=(reached,) * 2, contacts=0)])}
    assert values["stuck per 100 goals"] == 25.0
    assert values["steps in contact"] == 3
    assert values["time over the ideal"] == 1.5


def test_a_scene_runs() -> None:
    run = run_seed(2)
    assert run.kind == "desks" and run.stuck == 0 and run.contacts == 0
    assert len(run.goals) == 3 and all(0.95 < goal.seconds / goal.ideal < 2.2 for goal in run.goals)


@pytest.mark.parametrize("seed", [37, 93])
def test_robots_that_meet_in_a_corridor_pass(seed: int) -> None:
    """Both gave way at once and came back at once; or one dithered where it could not turn, or gave up a goal that it
    came nearer to all the time."""
    assert run_seed(seed).stuck == 0


def test_a_goal_is_not_given_up_while_robots_give_way_to_each_other() -> None:
    """Neither knows where the other is: how long they take to get past each other is left to chance."""
    run = run_seed(117)
    assert run.contacts == 0 and not any(goal.why for goal in run.goals)
    assert any(goal.reached for goal in run.goals)


def test_robots_that_do_not_read_what_is_near_do_not_push_each_other() -> None:
    """Face to face, each of two Turtlebots forgot what had come nearer than its laser reads."""
    assert run_seed(64125, "turtlebot").contacts == 0


@pytest.mark.parametrize("seed", [73149, 75125])
def test_a_robot_that_meets_another_before_an_unknown_room_stays_where_it_is(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It looked through where the other had stood, or on nothing but the other, and believed to be in the room behind
    it, which looks alike: 2 and 4 m away."""
    errors: List[float] = []

    class Watched(ClosedLoop):
        def run(self, until: float, stop: Callable[[], bool] = lambda: False) -> None:
            super().run(until, stop)
            errors.extend(max(robot.drift) for robot in self.robots)

    monkeypatch.setattr("mr_sim.nuisance.runs.ClosedLoop", Watched)
    run_seed(seed, "turtlebot")
    assert max(errors) < 0.2


@pytest.mark.parametrize("seed", range(len(KINDS)))
def test_a_larger_robot_has_scenes_that_it_fits_through(husky: str, seed: int) -> None:
    scene = draw(seed, robot_named(husky))
    assert scene.kind == list(KINDS)[seed]
    for robot, goals in zip(scene.world.robots, scene.goals):
        assert scene.reach.stands(robot.start, STANDING_ROOM)
        assert all(math.isfinite(scene.reach.seconds(robot.start, goal)) for goal in goals)


@pytest.mark.parametrize("name, told", [("pioner", "pioner.inc"), ("none.inc", "cannot be read")])
def test_a_robot_that_there_is_not_is_one_clear_error(name: str, told: str) -> None:
    with pytest.raises(WorldNotFoundError, match=told):
        robot_named(name)


@pytest.mark.parametrize("seed", [65001, 65003, 65021])
def test_a_long_robot_gets_on_where_it_stands_askew(husky: str, seed: int) -> None:
    """Beside a jamb it backed by a step, drove on to where it had stood, and backed again; it came to no goal that is
    close to two walls; where it gave way it braked into one."""
    run = run_seed(seed, husky)
    assert run.stuck == 0 and run.contacts == 0
