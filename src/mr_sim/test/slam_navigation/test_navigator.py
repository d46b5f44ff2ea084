"""The navigation engine on the world engine, and its answers without one."""

import math
from typing import Callable, List, Optional, Tuple

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from usual_robot import navigation_with

from mr_grid import OccupancyGrid, Pose
from mr_robot import _navigation
from mr_robot.navigation import engine
from mr_robot.navigation import follower as follower_module
from mr_robot.navigation.arrivals import Arrivals
from mr_robot.navigation.clock import Clock
from mr_robot.navigation.command import GivenUp
from mr_robot.navigation.engine import Command, Navigator, Status
from mr_robot.navigation.follower import Follower
from mr_robot.navigation.manoeuvre import Manoeuvre
from mr_robot.navigation.motion import STOP, Motion, bare
from mr_robot.navigation.obstacles import ObstacleMemory
from mr_robot.navigation.options import AT_REST, STANDING, NavigationError, Scan, make_scan
from mr_robot.navigation.planner import CostMap, Plan, path, plan
from mr_robot.navigation.route import Route
from mr_robot.navigation.stall import StallWatch
from mr_robot.navigation.surroundings import Hazards, Surroundings
from mr_robot.navigation.yielding import HeldUp, Retreat, find_retreat
from mr_robot.platforms.engines import navigation_options, slam_options
from mr_sim.closed_loop import ClosedLoop, Robot
from mr_sim.nuisance.reach import Reach
from mr_sim.simulated_platform import platform_of
from mr_sim.world_model import load_world
from mr_sim.worlds import find_world

EMPTY = make_scan(np.full(541, np.inf), -2.356, 4.712 / 540, 0.0, 8.0, Pose(0.1, 0.0, 0.0))


def room(walls: Tuple[slice, ...] = ()) -> OccupancyGrid:
    cells = np.zeros((80, 80), np.int8)
    for rows, columns in zip(walls[::2], walls[1::2]):
        cells[rows, columns] = 100
    return OccupancyGrid.of(cells, 0.05)


def until_end(navigator: Navigator, pose: Pose, scan: Scan = EMPTY, limit: float = 60.0) -> Tuple[float, Command]:
    """Steps a robot that stands still until its goal ends."""
    for step in range(int(limit * 10)):
        command = navigator.step(step * 0.1, pose, scan)
        if command.status is not Status.ACTIVE:
            return step * 0.1, command
    raise AssertionError("goal did not end")


@pytest.mark.parametrize("ahead, stops", [(0.30, True), (1.0, False)])
def test_a_robot_whose_goal_ended_brakes_at_once_where_gently_it_would_touch(ahead: float, stops: bool) -> None:
    """It reached its goal at full speed in a bend and touched the wall while it braked."""
    navigator = Navigator(navigation_with())
    navigator.set_map(room())
    navigator.set_goal(Pose(3.5, 2.0, 0.0), 0.0)
    pose = Pose(1.0, 2.0, 0.0)
    for step in range(10):
        pose = Pose(1.0 + 0.05 * step, 2.0, 0.0)
        speed = navigator.step(0.1 * step, pose, EMPTY).linear
    assert speed > 0.4
    navigator.cancel()
    bearings = np.linspace(-2.356, 2.356, 541)
    ranges = np.where(np.abs(bearings) < 0.5, (ahead - 0.1) / np.cos(bearings), np.inf)
    command = navigator.step(1.0, pose, make_scan(ranges, -2.356, 4.712 / 540, 0.0, 8.0, Pose(0.1, 0.0, 0.0)))
    assert command.status is Status.IDLE and (command.linear == 0.0) == stops


@pytest.mark.parametrize("view, radius", [(1.0, 0.5), (4.7, 0.0)])
def test_a_robot_turns_no_sharper_than_it_sees(view: float, radius: float) -> None:
    """Turtlebots drove round bends of 0.3 m into one another: each stood beside what the other saw. `radius`: m, of the
    sharpest bend."""
    navigator, pose, bends = Navigator(navigation_with()), Pose(1.0, 2.0, 0.0), []
    navigator.set_map(room())
    navigator.set_goal(Pose(1.2, 3.4, 0.0), 0.0)
    scan = make_scan(np.full(101, np.inf), -0.5 * view, view / 100, 0.0, 8.0, Pose(0.1, 0.0, 0.0))
    for step in range(200):
        command = navigator.step(0.1 * step, pose, scan)
        if command.status is not Status.ACTIVE:
            break
        if command.linear > 0.45 and command.angular != 0.0:
            bends.append(command.linear / abs(command.angular))
        pose = pose.compose(Pose(0.1 * command.linear, 0.0, 0.1 * command.angular))
    assert command.status is Status.SUCCEEDED and bends
    assert min(bends) > 0.9 * radius and (radius > 0.0 or min(bends) < 0.4)


def narrow(view: float) -> Scan:
    return make_scan(np.full(101, np.inf), -0.5 * view, view / 100, 0.0, 8.0, Pose(0.1, 0.0, 0.0))


def turned_before_it_drives(navigator: Navigator, scan: Scan, turns: bool = True) -> float:
    """rad to the left on the spot until the first motion ahead. `turns`: whether the wheels do what they are told."""
    pose, turned = Pose(1.0, 2.0, 0.0), 0.0
    for step in range(300):
        command = navigator.step(0.1 * step, pose, scan)
        assert command.status is Status.ACTIVE
        if command.linear > 0.05:
            return turned
        turned += 0.1 * command.angular
        if turns:
            pose = pose.compose(Pose(0.0, 0.0, 0.1 * command.angular))
    raise AssertionError("the robot never drove")


@pytest.mark.parametrize(
    "view, options, least", [(1.0, {}, 2 * math.pi), (4.7, {}, 0.0), (1.0, {"look_around": False}, 0.0)]
)
def test_a_robot_that_sees_little_turns_once_before_its_first_goal(view: float, options: dict, least: float) -> None:
    """What the wheels of Turtlebots lost on the first metres shifted all the rest of their maps."""
    navigator = Navigator(navigation_with(**options))
    navigator.set_map(room())
    navigator.set_goal(Pose(3.5, 2.0, 0.0), 0.0)
    assert turned_before_it_drives(navigator, narrow(view)) == pytest.approx(least, abs=0.8)
    navigator.cancel()
    navigator.set_goal(Pose(3.0, 2.0, 0.0), 0.0)
    assert turned_before_it_drives(navigator, narrow(view)) == pytest.approx(0.0, abs=0.8), "once is enough"


def test_a_robot_that_cannot_turn_does_not_look_around_for_ever() -> None:
    navigator = Navigator(navigation_with())
    navigator.set_map(room())
    navigator.set_goal(Pose(3.5, 2.0, 0.0), 0.0)
    assert turned_before_it_drives(navigator, narrow(1.0), turns=False) < 6 * math.pi


def test_a_robot_beside_something_that_it_would_touch_does_not_turn() -> None:
    navigator = Navigator(navigation_with())
    navigator.set_map(room())
    navigator.set_goal(Pose(3.5, 2.0, 0.0), 0.0)
    bearings = np.linspace(-0.5, 0.5, 101)
    beside = make_scan(0.24 / np.cos(bearings), -0.5, 0.01, 0.0, 8.0, Pose(0.0, 0.0, 0.5 * math.pi))
    assert turned_before_it_drives(navigator, beside) < 1.0


def test_no_way_is_said_within_a_second() -> None:
    navigator = Navigator(navigation_with())
    navigator.set_map(room((slice(None), slice(40, 42))))
    navigator.set_goal(Pose(3.0, 2.0, 0.0), 0.0)
    ended, command = until_end(navigator, Pose(1.0, 2.0, 0.0))
    assert ended <= 1.0 and command.status is Status.ABORTED
    assert command.text == "no way to (3.00, 2.00): walls or unknown cells close it off"


@pytest.mark.parametrize("goal, text", [((9.0, 2.0, 0.0), "outside the map"), ((2.05, 2.0, 0.0), "in a wall")])
def test_no_way_says_why(goal: Pose, text: str) -> None:
    navigator = Navigator(navigation_with(goal_search_radius=0.1))
    navigator.set_map(room((slice(None), slice(40, 42))))
    navigator.set_goal(goal, 0.0)
    _, command = until_end(navigator, Pose(1.0, 2.0, 0.0))
    assert command.status is Status.ABORTED and text in command.text


def test_missing_input_is_named() -> None:
    navigator = Navigator(navigation_with())
    navigator.set_goal(Pose(1.0, 0.0, 0.0), 0.0)
    ended, command = until_end(navigator, Pose(0.0, 0.0, 0.0))
    assert ended <= AT_REST + 1.0 and command.text == "no map for 8 s"


def test_a_scan_that_is_late_ends_no_goal() -> None:
    """One late scan ended each goal that was older than what is allowed for its input."""
    navigator, pose = Navigator(navigation_with()), Pose(1.0, 2.0, 0.0)
    navigator.set_map(room())
    navigator.set_goal(Pose(3.5, 2.0, 0.0), 0.0)
    for step in range(100):
        assert navigator.step(0.1 * step, pose, EMPTY).status is Status.ACTIVE
    for step in range(100, 179):
        command = navigator.step(0.1 * step, pose, None)
        assert command.status is Status.ACTIVE and (command.linear, command.angular) == STOP
    assert navigator.step(17.9, pose, EMPTY).linear > 0.0
    commands = [navigator.step(18.0 + 0.1 * step, pose, None) for step in range(81)]
    assert {each.status for each in commands[:-2]} == {Status.ACTIVE}
    assert (commands[-1].status, commands[-1].text) == (Status.ABORTED, "no laser scan for 8 s")


@pytest.mark.parametrize(
    "call",
    [
        lambda n: n.set_goal(Pose(math.nan, 0.0, 0.0), 0.0),
        lambda n: n.set_goal(Pose(0.0, 1e308, 0.0), 0.0),
        lambda n: n.set_map(OccupancyGrid.of(np.zeros((4, 4), np.int8), 0.05, Pose(1e308, 0))),
        lambda n: n.set_map(OccupancyGrid.of(np.zeros((4, 4), np.int8), 0.05, Pose(yaw=0.1))),
        lambda n: n.set_map(OccupancyGrid.of(np.zeros((0, 4), np.int8), 0.05, Pose(0, 0))),
        lambda n: n.set_own_map(OccupancyGrid.of(np.zeros((4, 4), np.int8), 0.05, Pose(yaw=1.57)), 0.0),
    ],
)
def test_bad_input_is_refused(call: Callable[[Navigator], None]) -> None:
    with pytest.raises(NavigationError):
        call(Navigator(navigation_with()))
    with pytest.raises(NavigationError, match="max_linear_velocity"):
        navigation_with(max_linear_velocity=-1.0)


@pytest.mark.parametrize(
    "angle_min, angle_increment, range_min, range_max",
    [(math.nan, 0.01, 0.1, 8.0), (-2.0, 0.0, 0.1, 8.0), (-2.0, 0.01, math.nan, 8.0), (-2.0, 0.01, 0.1, 0.0),
     (-2.0, 0.01, 0.1, math.nan)],
)  # fmt: skip
def test_a_scan_that_would_leave_the_robot_blind_is_refused(
    angle_min: float, angle_increment: float, range_min: float, range_max: float
) -> None:
    """It showed nothing, and the robot drove into what was before it."""
    with pytest.raises(NavigationError, match="scan"):
        make_scan(np.full(400, 1.0), angle_min, angle_increment, range_min, range_max, Pose())
    assert len(make_scan(np.full(400, 1.0), -2.0, 0.01, 0.1, math.inf, Pose()).points) == 400
    assert len(make_scan(np.full(1, 1.0), 0.0, 0.0, 0.1, 8.0, Pose()).points) == 1, "one beam has none beside it"


def test_a_robot_off_the_map_of_its_way_has_no_path() -> None:
    """rviz asked for it, and an exception ended the thread that controls the robot."""
    navigator = Navigator(navigation_with())
    navigator.set_map(room())
    navigator.set_goal(Pose(3.0, 2.0, 0.0), 0.0)
    navigator.step(0.1, Pose(0.6, 2.0, 0.0), EMPTY)
    assert navigator.path(Pose(0.6, 2.0, 0.0)) and navigator.path(Pose(30.0, 2.0, 0.0)) == []


@pytest.mark.parametrize("tolerance", [0.01, 0.03, 0.05])
def test_a_goal_of_any_tolerance_can_be_reached(tolerance: float) -> None:
    """At 0.03 m its radius was 0."""
    navigator, pose = Navigator(navigation_with(xy_goal_tolerance=tolerance)), Pose(1.0, 2.0, 0.0)
    navigator.set_map(room())
    navigator.set_goal(Pose(3.0, 2.0, 0.0), 0.0)
    for step in range(150):
        command = navigator.step(0.1 * step, pose, EMPTY)
        if command.status is not Status.ACTIVE:
            break
        pose = pose.compose(Pose(0.1 * command.linear, 0.0, 0.1 * command.angular))
    assert command.status is Status.SUCCEEDED, command.text


@pytest.mark.parametrize("value", [1e308, -1e308, 3e5, math.inf, math.nan])
def test_positions_that_cannot_be_are_ignored(value: float) -> None:
    """A finite but huge position of another robot has no cell: with it every later map was refused by a traceback."""
    navigator = Navigator(navigation_with(), name="robot_0")
    assert navigator.set_others({"robot_1": (value, 0.0), "robot_2": (1.0, 1.0)}, 0.0) == ["robot_1"]
    navigator.set_map(room())
    assert navigator.set_others({"robot_1": (0.0, value), "robot_0": (0.0, 0.0)}, 1.0) == ["robot_1"]
    navigator.set_goal(Pose(3.0, 2.0, 0.0), 1.0)
    assert navigator.step(1.1, Pose(0.6, 2.0, 0.0), EMPTY).status is Status.ACTIVE


def test_gentle_start_and_cancel() -> None:
    navigator = Navigator(navigation_with())
    navigator.set_map(room())
    navigator.set_goal(Pose(3.5, 2.0, 0.0), 0.0)
    speeds, pose = [0.0], Pose(0.6, 2.0, 0.0)
    for step in range(12):
        command = navigator.step(step * 0.1, pose, EMPTY)
        pose = Pose(pose[0] + 0.1 * command.linear, pose[1], 0.0)
        speeds.append(command.linear)
    assert max(np.diff(speeds)) < 0.1 + 1e-9 and speeds[-1] == pytest.approx(0.5)
    navigator.cancel()
    assert navigator.step(1.3, pose, EMPTY).status is Status.IDLE


LIMITS = _navigation.Limits(0.5, 1.57, 1.0, 3.14)
FOOTPRINT = _navigation.Footprint(0.22, 0.19)
AGILITY = _navigation.Agility(LIMITS)


def may_drive(target: Tuple[float, float], obstacle: Tuple[float, float, float, float]) -> bool:
    horizon = _navigation.Horizon(0.2)
    return _navigation.is_clear((0.0, 0.0, 0.0), target, target, np.array([obstacle]), LIMITS, FOOTPRINT, horizon)


def test_past_what_may_move_only_slowly() -> None:
    """A robot drove by at full speed 1 cm from another that had come nearer, and touched it."""
    beside = (0.1, 0.19 + 0.15, 0.1, 0.25)
    assert may_drive((0.1, 0.0), beside)
    assert not may_drive((0.5, 0.0), beside)
    assert may_drive((0.5, 0.0), (0.1, 0.19 + 0.15, 0.05, 0.0)), "a wall does not come nearer"


def test_within_touching_distance_no_nearer() -> None:
    """Three millimetres nearer with every step, robots ended up touching."""
    beside = (0.2, 0.19 + 0.01, 0.1, 0.25)
    assert may_drive((0.0, 0.0), beside)
    assert may_drive((0.0, -0.05), beside)
    assert not may_drive((0.0, 0.05), beside)


def test_a_margin_that_grows_with_speed_does_not_close_the_way_out() -> None:
    """Five centimetres from something that might move a robot could not even drive away from it."""
    behind = (-0.22 - 0.05, 0.0, 0.1, 0.25)
    assert may_drive((0.15, 0.0), behind)
    assert not may_drive((-0.15, 0.0), behind)
    assert not may_drive((0.15, 0.0), (0.22 + 0.05, 0.0, 0.1, 0.25))


def test_out_along_a_wall_whose_cells_are_not_in_line() -> None:
    """Beside a wall in a slanting map every motion came a third of a millimetre nearer to some cell: none was open."""
    cells = np.array([(-0.15, -0.219, 0.02, 0.0), (-0.30, -0.2187, 0.02, 0.0)])
    horizon = _navigation.Horizon(1.1)
    motion = ((0.0, 0.0, 0.0), (0.0, 0.0), (-0.15, 0.0), cells, LIMITS, FOOTPRINT, horizon)
    assert not _navigation.is_clear(*motion)
    horizon.slack = 0.002
    assert _navigation.is_clear(*motion)
    cells[1, 1] = -0.215
    assert not _navigation.is_clear(*motion)


anywhere = st.tuples(st.floats(-0.6, 0.6), st.floats(-0.6, 0.6))
gap = st.floats(0.005, 0.075)
side = st.sampled_from([-1, 1])
nearby = st.one_of(
    st.builds(lambda x, sign, gap: (x, sign * (0.19 + gap)), st.floats(-0.22, 0.22), side, gap),
    st.builds(lambda y, sign, gap: (sign * (0.22 + gap), y), st.floats(-0.19, 0.19), side, gap),
)


def plan_out(
    obstacles: np.ndarray,
    goal: Tuple[float, float] = (3.0, 2.0),
    unknown: Tuple[slice, slice] = (slice(0), slice(0)),
) -> np.ndarray:
    """Waypoints from (1, 2, 0) in a room of 4 m x 4 m, rows (x, y, yaw, direction, seconds)."""
    way = plan(CostMap(room(), navigation_with()), np.empty((0, 2)), Pose(1.0, 2.0, 0.0), goal, 0.5)
    assert way is not None
    start = (1.0, 2.0, 0.0)
    cells = way.grid.cells.copy()
    cells[unknown] = -1
    return _navigation.manoeuvre(way.cost, cells, 0.05, (0.0, 0.0), way.goal, start, obstacles, FOOTPRINT, AGILITY, 1.3)


def test_a_way_out_gains_room_and_never_comes_nearer() -> None:
    """With a tolerance instead robots backed into tables; what a corner swept in the middle of a step was not seen."""
    found: List[bool] = []

    @given(st.lists(nearby, min_size=1, max_size=4), st.lists(anywhere, max_size=4))
    def no_nearer(beside: List[Tuple[float, float]], others: List[Tuple[float, float]]) -> None:
        obstacles = np.array([(1.0 + x, 2.0 + y, 0.0, 0.0) for x, y in beside + others])
        before = _navigation.clearance((1.0, 2.0, 0.0), obstacles, FOOTPRINT)
        assume(0.0 < before < 0.08)
        rows = plan_out(obstacles)
        found.append(len(rows) > 1)
        for former, row in zip(rows, rows[1:]):
            for share in np.linspace(0.0, 1.0, 11):
                pose = tuple((former + share * (row - former))[:3])
                assert _navigation.clearance(pose, obstacles, FOOTPRINT) > min(before, 0.03) - 0.003

    no_nearer()
    assert len(found) >= 30 and sum(found) > 0.6 * len(found), "ways must be found, or nothing was looked at"


touching = st.tuples(st.floats(-0.22, 0.22), st.sampled_from([-1, 1]), st.floats(-0.01, 0.02)).map(
    lambda point: (point[0], point[1] * (0.19 + point[2]))
)


def test_a_manoeuvre_can_begin() -> None:
    found: List[bool] = []

    @given(st.lists(touching, min_size=2, max_size=4), st.sampled_from([(3.0, 2.0), (0.3, 2.0), (1.0, 3.5)]))
    def can_begin(points: List[Tuple[float, float]], goal: Tuple[float, float]) -> None:
        obstacles = np.array([(1.0 + x, 2.0 + y, 0.0, 0.0) for x, y in points])
        assume(_navigation.clearance((1.0, 2.0, 0.0), obstacles, FOOTPRINT) > -0.02)
        rows = plan_out(obstacles, goal)
        found.append(len(rows) > 1)
        if len(rows):
            assert may_begin(rows, obstacles)

    can_begin()
    assert len(found) >= 30 and sum(found) > 0.9 * len(found), "ways must be found, or nothing was looked at"


def may_begin(rows: np.ndarray, obstacles: np.ndarray) -> bool:
    seconds = rows[1, 4] - rows[0, 4]
    way = rows[1, 3] * math.dist(rows[0, :2], rows[1, :2])
    horizon = _navigation.Horizon(_navigation.RAMP)
    horizon.slack = _navigation.SLACK
    target = (way / seconds, (rows[1, 2] - rows[0, 2]) / seconds)
    return _navigation.is_clear((1.0, 2.0, 0.0), (0.0, 0.0), target, obstacles, LIMITS, FOOTPRINT, horizon)


def nobody() -> np.ndarray:
    """No followers."""
    return np.empty((0, 4))


def test_away_from_a_jamb_behind_that_the_body_seems_to_touch() -> None:
    """Every plan began with a motion that was not clear, twice a second for the rest of the mission."""
    jamb = np.array([(1.0 - 0.169, 2.0 - 0.185, 0.0, 0.0), (1.0 - 0.218, 2.0 - 0.177, 0.0, 0.0)])
    way = plan(CostMap(room(), navigation_with()), np.empty((0, 2)), Pose(1.0, 2.0, 0.0), (1.0, 3.0), 0.5)
    assert way is not None
    motion = Motion(navigation_with())
    follower, pose = Follower(motion, navigation_with()), Pose(1.0, 2.0, 0.0)
    for step in range(80):
        motion.velocity = follower.follow(0.1 * step, way, pose, Hazards(jamb, nobody), stuck=True) or STOP
        yaw = pose.yaw + 0.1 * motion.velocity[1]
        way_on = 0.1 * motion.velocity[0]
        pose = Pose(pose.x + way_on * math.cos(yaw), pose.y + way_on * math.sin(yaw), yaw)
    assert math.dist(pose[:2], (1.0, 2.0)) > 0.3
    assert _navigation.clearance(tuple(pose), jamb, FOOTPRINT) > 0.0


def test_who_may_have_followed_is_asked_for_manoeuvres_only() -> None:
    """It took a tenth of each step of a robot that drove ahead."""
    asked: List[bool] = []

    def followers() -> np.ndarray:
        asked.append(True)
        return nobody()

    way = plan(CostMap(room(), navigation_with()), np.empty((0, 2)), Pose(1.0, 2.0, 0.0), (3.0, 2.0), 0.5)
    assert way is not None
    follower, hazards = Follower(Motion(navigation_with()), navigation_with()), Hazards(np.empty((0, 4)), followers)
    assert follower.follow(0.0, way, Pose(1.0, 2.0, 0.0), hazards, stuck=False) and not asked
    follower.follow(0.1, way, Pose(1.0, 2.0, 0.0), hazards, stuck=True)
    assert asked


def test_what_drives_ahead_best_is_looked_for_once_a_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """It was twice where there is no room to turn."""
    sides = np.array([(x, y, 0.0, 0.0) for x in np.arange(0.6, 1.4, 0.02) for y in (1.77, 2.23)])
    way = plan(CostMap(room(), navigation_with()), np.empty((0, 2)), Pose(1.0, 2.0, 0.0), (2.0, 3.0), 0.5)
    assert way is not None
    looked, choose = [], _navigation.choose_velocity
    monkeypatch.setattr(_navigation, "choose_velocity", lambda *of: (looked.append(of), choose(*of))[1])
    follower, hazards = Follower(Motion(navigation_with()), navigation_with()), Hazards(sides, nobody)
    velocity = follower.follow(0.0, way, Pose(1.0, 2.0, 0.0), hazards, stuck=False)
    assert velocity and velocity[0] > 0.0 and len(looked) == 1


def test_a_robot_at_speed_brakes_before_it_plans_a_manoeuvre(monkeypatch: pytest.MonkeyPatch) -> None:
    """It was planned for a robot that stands: one of a metre came 0.4 m farther, and back, before it began."""
    options = navigation_with(max_linear_velocity=1.0)
    way = plan(CostMap(room(), options), np.empty((0, 2)), Pose(1.0, 2.0, 0.0), (3.0, 2.0), 0.5)
    assert way is not None
    motion, planned_at = Motion(options), []
    monkeypatch.setattr(follower_module, "plan_manoeuvre", lambda *_: planned_at.append(motion.velocity[0]))
    follower, pose, motion.velocity = Follower(motion, options), Pose(1.0, 2.0, 0.0), (0.9, 0.0)
    hazards = Hazards(np.array([(1.9, 2.0, 0.0, 0.0)]), nobody)
    for step in range(8):
        motion.velocity = follower.follow(0.1 * step, way, pose, hazards, stuck=True) or STOP
        pose = pose.compose(Pose(0.1 * motion.velocity[0], 0.0, 0.1 * motion.velocity[1]))
    assert planned_at and planned_at[0] <= 0.25


def test_a_manoeuvre_slows_down_where_it_would_turn_too_far() -> None:
    """In a corner behind a desk the way out began with a turn that was looked at beyond its end, and given up: it
    never came home."""
    ahead = [(1.29, 2.0 + y) for y in np.arange(-0.2, 0.62, 0.02)]
    beside = [(1.0 + x, 2.6) for x in np.arange(-0.95, 0.3, 0.02)]
    desk = [(1.0 + x, 1.83 - y) for x in np.arange(-0.58, -0.26, 0.04) for y in (0.0, 0.05, 0.1)]
    obstacles = np.array([*((x, y, 0.05, 0.0) for x, y in ahead + beside), *((x, y, 0.03, 0.0) for x, y in desk)])
    way = plan(CostMap(room(), navigation_with()), np.empty((0, 2)), Pose(1.0, 2.0, 0.0), (0.2, 2.2), 0.5)
    assert way is not None
    motion = Motion(navigation_with())
    follower, pose = Follower(motion, navigation_with()), Pose(1.0, 2.0, 0.0)
    for step in range(150):
        hazards = Hazards(obstacles, nobody)
        motion.velocity = follower.follow(0.1 * step, way, pose, hazards, stuck=step > 20) or STOP
        pose = pose.compose(Pose(0.1 * motion.velocity[0], 0.0, 0.1 * motion.velocity[1]))
        assert _navigation.clearance(tuple(pose), obstacles, FOOTPRINT) > 0.0
    assert math.dist(pose[:2], (1.0, 2.0)) > 0.5


def test_out_of_a_niche_backwards_and_turned_where_there_is_room() -> None:
    sides = [(x, y) for x in np.arange(0.6, 1.4, 0.02) for y in (1.77, 2.23)]
    obstacles = np.array([(x, y, 0.0, 0.0) for x, y in [*sides, *((1.3, y) for y in np.arange(1.78, 2.22, 0.02))]])
    rows = plan_out(obstacles, (0.3, 3.0))
    inside = rows[rows[:, 0] > 0.8]
    assert (inside[1:, 3] == -1).all() and np.abs(inside[:, 2]).max() < 0.15
    assert rows[-1, 0] < 0.4


def test_backing_over_unknown_ground_is_the_last_choice() -> None:
    """At its start a robot backed half a metre over what it had never seen, into another one."""
    ahead = np.array([(1.35, 2.0 + y, 0.0, 0.0) for y in np.arange(-0.2, 0.2, 0.02)])
    beside = np.array([(x, y, 0.0, 0.0) for x in np.arange(0.8, 1.2, 0.02) for y in (1.775, 2.225)])
    behind = (slice(0, 80), slice(0, 16))
    assert backs_to(plan_out(ahead, (0.4, 2.0))) < 0.8
    assert backs_to(plan_out(ahead, (0.4, 2.0), unknown=behind)) > 0.8
    assert backs_to(plan_out(np.concatenate([ahead, beside]), (0.4, 2.0), unknown=behind)) < 0.8
    # Two cells wide, between an end of the rear edge and its middle: the corner of a desk.
    assert backs_to(plan_out(ahead, (0.4, 2.0), unknown=(slice(41, 43), slice(0, 16)))) > 0.6


def backs_to(rows: np.ndarray) -> float:
    """The least x, m, of the rear edge where a manoeuvre leads back."""
    assert len(rows)
    back = rows[1:][rows[1:, 3] == -1]
    rear = back[:, 0] - 0.22 * np.cos(back[:, 2]) - 0.19 * np.abs(np.sin(back[:, 2]))
    return float(rear.min(initial=np.inf))


def test_nothing_leads_out_of_a_closed_place() -> None:
    around = np.concatenate([[(1.0 + s * 0.27, 2.0 + t, 0.0, 0.0), (1.0 + t, 2.0 + s * 0.24, 0.0, 0.0)]
                             for s in (-1, 1) for t in np.arange(-0.3, 0.3, 0.02)])  # fmt: skip
    assert len(plan_out(around)) == 0


@pytest.mark.parametrize("seed", [2, 5])
@pytest.mark.parametrize("side, gap", [(1, 0.205), (1, 0.21), (-1, 0.205), (-1, 0.21)])
def test_a_robot_that_stands_along_a_wall_gets_away_from_it(
    draw_world: Callable[..., str], side: int, gap: float, seed: int
) -> None:
    """Its corners would touch if it turned, and along the wall nothing was nearer: it stayed for half an hour."""
    loop = ClosedLoop(draw_world((14, 10), [], [(7.013, 0.1 + gap if side > 0 else 9.9 - gap, 0.0)]), 1, seed)
    loop.run(2.5)
    robot = loop.robots[0]
    robot.set_goal(Pose(0.0, 4.0 * side, 0.0), loop.world.time)
    start = loop.world.pose(0)
    loop.run(62.5, lambda: abs(loop.world.pose(0)[1] - start[1]) > 1.0)
    assert abs(loop.world.pose(0)[1] - start[1]) > 1.0
    assert robot.contacts == 0


@pytest.mark.parametrize("seed", [4, 5, 8, 9])
def test_a_robot_between_a_desk_and_a_corner_gets_out(draw_world: Callable[..., str], seed: int) -> None:
    """By scans and map it touched something already, and any motion led nearer: it stood there for nine minutes. Later
    it gave up its way out again and again, each time for the noise of a scan, and went back in between."""
    loop = ClosedLoop(draw_world((4, 4), [(0.65, 2.6, 0.8, 0.8)], [(0.396, 3.599, -160.4)]), 1, seed)
    drive(loop, [Pose(0.35, 2.05, 0.0)], 75.0)
    assert_arrived(loop.robots[0])


def test_a_new_goal_does_not_hide_that_the_robot_is_stuck() -> None:
    """A robot that stood was given another goal every few seconds, and none was old enough for a recovery."""
    # The blind end of a corridor of half a metre, with the goals at its other end.
    navigator, pose = Navigator(navigation_with()), Pose(1.0, 2.0, 0.0)
    navigator.set_map(room((slice(44, 46), slice(0, 30), slice(34, 35), slice(0, 30), slice(34, 45), slice(26, 28))))
    commands = []
    for step in range(100):
        if step % 15 == 0:
            navigator.set_goal(Pose(0.3, 1.95 + 0.001 * step, 0.0), 0.1 * step)
        commands.append(navigator.step(0.1 * step, pose, EMPTY))
    assert min(command.linear for command in commands) < -0.05


def test_a_way_back_where_there_is_no_room_to_turn(draw_world: Callable[..., str]) -> None:
    """At the end of a corridor narrower than its diagonal a robot turned to and fro until its goal was given up."""
    walls = [(2.5, 0.0, 3.5, 1.2), (2.5, 1.86, 3.5, 1.14)]
    loop = ClosedLoop(draw_world((6, 3), walls, [(1.0, 1.5, 0.0)]), 1, 0)
    drive(loop, [Pose(5.3, 1.53, 0.0)], 30.0)
    assert_arrived(loop.robots[0])
    loop.robots[0].results.clear()
    since = loop.world.time
    drive(loop, [Pose(1.0, 1.5, 0.0)], since + 30.0, since)
    assert_arrived(loop.robots[0])


def test_backwards_not_into_a_robot_that_says_where_it_is() -> None:
    """The laser is blind there: a robot that gave way backed into the one behind it."""
    for others, backs in (({}, True), ({"robot_1": (0.4, 2.0)}, False)):
        navigator = Navigator(navigation_with(), name="robot_0")
        navigator.set_map(
            room((slice(44, 46), slice(0, 30), slice(34, 35), slice(0, 30), slice(34, 45), slice(26, 28)))
        )
        navigator.set_others(others, 0.0)
        navigator.set_goal(Pose(0.3, 2.0, 0.0), 0.0)
        least = min(navigator.step(0.1 * step, Pose(1.0, 2.0, 0.0), EMPTY).linear for step in range(30))
        assert (least < -0.05) == backs


@pytest.mark.parametrize("degrees, touches", [(57.0, False), (270.0, True)])
def test_not_into_a_robot_that_says_it_is_beside_a_narrow_view(degrees: float, touches: bool) -> None:
    """Turtlebots that knew one another's positions touched: neither was behind the other, nor in its view. What a wide
    view does not show is not there."""
    navigator, other = Navigator(navigation_with(), name="robot_0"), (1.6, 2.36)
    navigator.set_map(room())
    navigator.set_others({"robot_1": other}, 0.0)
    navigator.set_goal(Pose(3.2, 2.0, 0.0), 0.0)
    view = math.radians(degrees)
    scan = make_scan(np.full(541, np.inf), -0.5 * view, view / 540, 0.0, 8.0, Pose())
    pose, nearest = Pose(1.0, 2.0, 0.0), math.inf
    for step in range(50):
        command = navigator.step(0.1 * step, pose, scan)
        pose = pose.compose(Pose(0.1 * command.linear, 0.0, 0.1 * command.angular))
        nearest = min(nearest, math.dist(pose[:2], other))
    assert (nearest < 0.45) == touches


def test_thinning_keeps_the_nearest_point() -> None:
    """A corner was taken for 4 cm farther away than it was, and touched."""
    options = navigation_with()
    costs = CostMap(OccupancyGrid.of(np.zeros((40, 40), np.int8), 0.05, Pose(-1.0, -1.0)), options)
    points = np.array([[0.599, 0.0], [0.571, 0.0], [0.585, 0.0]])
    scan = Scan(points, np.full(3, 0.6), 0.0, 0.01, 0.0, 8.0, (0.0, 0.0, 0.0))
    rows = Surroundings(options).obstacles(costs, None, Pose(), scan)
    assert rows[:, 0].min() == pytest.approx(0.571)


def test_a_new_goal_does_not_stop_the_robot() -> None:
    navigator = Navigator(navigation_with())
    navigator.set_map(room())
    pose, speeds = Pose(0.6, 2.0, 0.0), []
    navigator.set_goal(Pose(3.4, 2.0, 0.0), 0.0)
    for step in range(25):
        if step == 10:
            navigator.set_goal(Pose(3.4, 2.3, 0.0), 1.0)
        command = navigator.step(step * 0.1, pose, EMPTY)
        yaw = pose[2] + 0.1 * command.angular
        pose = Pose(pose[0] + 0.1 * command.linear * math.cos(yaw), pose[1] + 0.1 * command.linear * math.sin(yaw), yaw)
        speeds.append(command.linear)
    assert min(speeds[8:]) > 0.3


def test_a_way_around_what_is_at_rest_is_kept() -> None:
    """A robot set out around its mates at home, held its way for blocked no longer, and came back, to and fro."""
    cells = np.zeros((240, 80), np.int8)
    cells[:, 39:41] = 100
    cells[15:35, 39:41] = cells[190:215, 39:41] = 0  # two doors, 9 m from one another
    costs, route = CostMap(OccupancyGrid.of(cells, 0.05), navigation_with()), Route(navigation_with())
    at_rest = np.array([(2.0, y) for y in np.arange(0.75, 1.8, 0.05)])
    place, goal = np.array((1.0, 1.25)), Pose(3.0, 1.25, 0.0)
    route.set_goal(goal, 0.0)
    for step in range(700):
        pose = Pose(*place, 0.0)
        route.update(0.1 * step, pose, costs, at_rest)
        assert route.plan is not None
        route.advance(0.1 * step, pose)
        ahead = path(route.plan, pose)[:3][-1]
        if np.hypot(*(at_rest - ahead).T).min() > 0.4:
            place = place + 0.04 * (ahead - place) / max(math.dist(ahead, place), 0.04)
    assert math.dist(place, goal[:2]) < 0.1


def test_blocked_wheels_are_noticed_soon() -> None:
    watch = StallWatch(0.1)
    for step in range(20):
        now = step * 0.1
        if watch.blocked(now, Pose(0.0, 0.0, 0.0)):
            break
        watch.command(now, (0.5, 0.0))
    assert 0.2 < now <= 0.5


def test_a_robot_that_moves_is_not_called_blocked() -> None:
    watch = StallWatch(0.1)
    x = v = 0.0
    for step in range(50):
        assert not watch.blocked(step * 0.1, Pose(x, 0.0, 0.0))
        x, v = x + 0.1 * v, min(0.5, v + 0.1)
        watch.command(step * 0.1, (v, 0.0))


@pytest.mark.parametrize("world", ["office26x15_turtlebots", "office26x15_mixed"])
def test_robots_of_a_world_are_driven_as_what_they_are(world: str) -> None:
    """All were taken for Pioneers: a Turtlebot kept 1.3 cm more to its sides than it needs, and turned to no goal."""
    loop = ClosedLoop(world, 2, 0)
    platforms = [platform_of(robot) for robot in loop.world.robots]
    for robot, platform in zip(loop.robots, platforms):
        assert robot.navigator.options == navigation_options(platform, platforms)
        assert robot.slam.options == slam_options(platform, platforms)
    assert loop.robots[1].navigator.options.footprint_width == 0.354


def drive(loop: ClosedLoop, goals: List[Pose], limit: float, since: float = 2.5) -> None:
    """Gives every robot its goal (world frame) after `since` and runs until all have ended."""
    loop.run(since)
    for robot, goal in zip(loop.robots, goals):
        robot.set_goal(robot.local(goal), loop.world.time)
    loop.run(limit, lambda: all(robot.results for robot in loop.robots))


def assert_arrived(robot: Robot) -> None:
    assert robot.results and robot.results[-1][1] == "succeeded", robot.results
    assert robot.contacts == 0


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("hints", [True, False])
def test_nose_to_nose_in_a_doorway(draw_world: Callable[..., str], seed: int, hints: bool) -> None:
    # Two rooms, one door of 0.9 m; each robot wants to go where the other comes from.
    world = draw_world((8, 4), [(3.95, 0, 0.1, 1.55), (3.95, 2.45, 0.1, 1.55)], [(1.5, 2.0, 0.0), (6.5, 2.0, 180.0)])
    loop = ClosedLoop(world, 2, seed)
    loop.share_positions = hints
    drive(loop, [Pose(6.5, 2.0, 0.0), Pose(1.5, 2.0, 0.0)], 90.0)
    for robot in loop.robots:
        assert_arrived(robot)


def test_random_goals_in_the_office_without_touching_anything() -> None:
    """All of them are places that a body can come near to in the true world: it takes at most twice the least time, or
    that of the way that its map knows."""
    loop = ClosedLoop("office26x15", 1, 5)
    robot, reach = loop.robots[0], Reach(load_world(find_world("office26x15")))
    radius = robot.navigator.options.goal_search_radius
    around = np.arange(-radius, radius + 0.01, 0.25)
    random = np.random.default_rng(5)
    loop.run(2.5)
    for _ in range(6):
        assert robot.grid is not None
        rows, columns = np.nonzero(robot.grid.cells == 0)
        index = int(random.integers(rows.size))
        goal = robot.grid.info.centre_of(int(rows[index]), int(columns[index]))
        pose, begin = Pose(*loop.world.pose(0)), loop.world.time
        x, y, _ = robot.start.compose(Pose(*goal, 0.0))
        least = reach.seconds(pose, (x, y))
        near = (reach.seconds(pose, (x + dx, y + dy)) for dx in around for dy in around if math.hypot(dx, dy) < radius)
        assert math.isfinite(least) or any(map(math.isfinite, near))
        robot.results.clear()
        robot.set_goal(Pose(*goal, 0.0), begin)
        loop.run(begin + 0.2)
        way = robot.navigator.path(robot.local(loop.world.pose(0)))
        least = max(least, sum(map(math.dist, way, way[1:])) / robot.navigator.options.max_linear_velocity)
        loop.run(begin + 60.0, lambda: bool(robot.results))
        assert robot.results and robot.results[-1][1] == "succeeded"
        assert loop.world.time - begin < 2.0 * least + 1.0
    assert robot.contacts == 0


def test_a_clock_set_back_neither_ends_nor_holds_up_a_goal() -> None:
    navigator = Navigator(navigation_with())
    navigator.set_map(room((slice(None), slice(40, 42))))
    navigator.set_goal(Pose(3.0, 2.0, 0.0), 1000.0)
    navigator.step(1000.1, Pose(1.0, 2.0, 0.0), EMPTY)
    ended, command = until_end(navigator, Pose(1.0, 2.0, 0.0), limit=3.0)
    assert ended <= 1.0 and "no way" in command.text


def test_time_goes_on_when_a_clock_is_set_back() -> None:
    clock = Clock()
    assert [clock(now) for now in (5.0, 6.0, 2.0, 2.5, 7.0)] == [5.0, 6.0, 6.0, 6.5, 11.0]


def test_way_blocked_by_what_the_map_does_not_know(draw_world: Callable[..., str]) -> None:
    # A robot that never moves fills the only door.
    world = draw_world((8, 4), [(3.95, 0, 0.1, 1.7), (3.95, 2.3, 0.1, 1.7)], [(1.5, 2.0, 0.0), (4.0, 2.0, 90.0)])
    loop = ClosedLoop(world, 2, 0, blocked_timeout=8.0)
    loop.share_positions = False
    first = loop.robots[0]
    loop.run(2.5)
    cells = first.grid.cells.copy()
    rows, columns = np.indices(cells.shape)
    x = first.grid.origin[0] + (columns + 0.5) * 0.05
    y = first.grid.origin[1] + (rows + 0.5) * 0.05
    # What a map made before the other robot came would say.
    known = (np.abs(y) < 1.9) & (x > -1.3) & (x < 6.3)
    cells[known] = 0
    cells[known & (np.abs(x - 2.5) < 0.05) & (np.abs(y) > 0.3)] = 100
    before = OccupancyGrid.of(cells, 0.05, first.grid.origin)
    first.navigator.set_map = lambda grid, set_map=first.navigator.set_map: set_map(before)  # type: ignore[method-assign]
    first.navigator.set_map(before)
    first.set_goal(first.local(Pose(6.5, 2.0, 0.0)), loop.world.time)
    loop.run(80.0, lambda: bool(first.results))
    assert first.results and "not in the map" in first.results[-1][1]
    assert first.contacts == 0


def test_close_obstacles_are_not_thinned_out() -> None:
    """Standing robots that turned a little touched with a corner: the point it came to was left out for one nearer to
    the middle of the robot."""
    costs = CostMap(OccupancyGrid.of(np.zeros((80, 80), dtype=np.int8), 0.05, Pose(-2.0, -2.0)), navigation_with())
    close, far = [[0.301, 0.001], [0.325, 0.025]], [[0.905, 0.001], [0.925, 0.025]]
    rows = _navigation.surroundings(
        np.array(close + far), (0.0, 0.0, 0.0), ObstacleMemory(1.0).rows, costs.walls, None, FOOTPRINT,
        _navigation.Margins(0.02, 0.1, 0.05, 0.1, 0.2), 1.3,
    )  # fmt: skip
    assert sorted(rows[:, :2].tolist()) == sorted([*close, far[0]])


def beside(wall: float) -> Scan:
    """A laser at the middle that sees 270 degrees and a wall at y = -`wall`, with noise of 1 cm."""
    angles = np.linspace(-2.356, 2.356, 541)
    with np.errstate(divide="ignore"):
        ranges = np.where(angles < 0.0, -wall / np.sin(angles), 8.0)
    ranges = np.where((ranges > 0.0) & (ranges < 8.0), ranges + np.random.default_rng(1).normal(0.0, 0.01, 541), np.inf)
    return make_scan(ranges, -2.356, 4.712 / 540, 0.0, 8.0, Pose(0.0, 0.0, 0.0))


def seen_around(scan: Scan, grid: OccupancyGrid, own: Optional[OccupancyGrid] = None) -> np.ndarray:
    options, pose = navigation_with(), Pose(2.0, 2.0, 0.0)
    mapped = None if own is None else _navigation.Map(own.cells, own.resolution, own.origin[:2])
    return Surroundings(options).obstacles(CostMap(grid, options), mapped, pose, scan)[:, :2] - pose[:2]


def test_a_wall_beside_the_robot_is_where_most_hits_are() -> None:
    """The nearest of them seemed to touch a robot that stood 1.5 cm beside it; no motion led away."""
    cells = np.full((80, 80), -1, np.int8)
    points = seen_around(beside(0.205), OccupancyGrid.of(cells, 0.05))
    close = points[(np.abs(points[:, 0]) < 0.1) & (points[:, 1] < 0.0)]
    assert len(close) > 10 and close[:, 1].max() < -0.2


def test_walls_that_only_others_have_mapped_are_kept_away_from() -> None:
    """A robot that backed between such walls, which were drawn some centimetres off, touched them."""
    cells = np.zeros((80, 80), np.int8)
    cells[36, 30:50], cells[44, 30:50] = 100, 100
    own = np.where(np.arange(80)[:, np.newaxis] < 40, cells, -1).astype(np.int8)  # nothing to the left of the robot
    grid, mapped = OccupancyGrid.of(cells, 0.05), _navigation.Map(own, 0.05, (0.0, 0.0))
    pose, options = Pose(2.0, 2.0, 0.0), navigation_with()
    blind = make_scan(np.full(3, np.inf), 3.0, 0.01, 0.0, 8.0, Pose(0.0, 0.0, 0.0))
    rows = bare(Surroundings(options).obstacles(CostMap(grid, options), mapped, pose, blind), options.obstacle_margin)
    assert rows[rows[:, 1] > 2.0, 2].tolist() == pytest.approx(
        [options.moving_margin - options.obstacle_margin] * (rows[:, 1] > 2.0).sum()
    )
    assert (rows[rows[:, 1] < 2.0, 2] == 0.0).all() and (rows[:, 1] < 2.0).any() and (rows[:, 1] > 2.0).any()


def test_manoeuvres_keep_away_from_what_moves_at_speed() -> None:
    """Two robots that backed past one another touched: for manoeuvres each of them took the other to stand."""
    options, motion = navigation_with(), Motion(navigation_with())
    beside = np.array([[x, 0.19 + 0.08, options.moving_margin, options.moving_reaction_time] for x in (-0.3, 0.0)])
    tight = bare(beside, options.obstacle_margin)
    assert motion.is_clear(Pose(0.0, 0.0, 0.0), tight, (-0.05, 0.0)), "slowly it may pass"
    assert not motion.is_clear(Pose(0.0, 0.0, 0.0), tight, (-0.25, 0.0))
    wall = np.array([[x, 0.19 + 0.08, options.obstacle_margin, 0.0] for x in (-0.3, 0.0)])
    assert motion.is_clear(Pose(0.0, 0.0, 0.0), bare(wall, options.obstacle_margin), (-0.25, 0.0))


def test_what_moves_may_have_come_nearer_behind_the_robot() -> None:
    """Robots backed into others that had followed them since they were last seen."""
    surroundings, pose = Surroundings(navigation_with()), Pose(2.0, 2.0, 0.0)
    costs = CostMap(room((slice(44, 46), slice(24, 26))), navigation_with())
    angles = np.linspace(-math.pi, math.pi, 720)
    robot = np.where(np.cos(angles - math.pi) > math.cos(0.05), 0.8, 8.0)  # behind
    surroundings.see(make_scan(robot, -math.pi, 2.0 * math.pi / 719, 0.1, 8.0, Pose()), pose, costs, 7.0)
    surroundings.see(EMPTY, pose, costs, 10.0)
    behind = surroundings.followers(10.0, costs, pose)
    assert len(behind) and behind[:, 0] == pytest.approx(1.2, abs=0.05)
    assert behind[:, 2] == pytest.approx(0.1 + 3.0 * 0.2)
    assert len(surroundings.followers(10.0, costs, Pose(2.0, 2.0, math.pi))) == 0, "it is seen there"
    wall = CostMap(room((slice(38, 42), slice(22, 24))), navigation_with())
    assert len(surroundings.followers(10.0, wall, pose)) == 0, "it has turned out to be a wall"
    unknown = CostMap(OccupancyGrid.of(np.full((80, 80), -1, np.int8), 0.05), navigation_with())
    assert len(surroundings.followers(10.0, unknown, pose)) == 0, "it may be one"


@pytest.mark.parametrize("off", [0.11, -0.11])
def test_a_robot_that_is_farther_than_its_manoeuvre_does_not_creep(off: float) -> None:
    """It drove on at full pace while what it followed went on at a tenth: it stayed as far, and backed at 3 cm/s."""
    manoeuvre = Manoeuvre(np.array([(0.0, 0.0, 0.0, -1.0, 0.0), (-0.5, 0.0, 0.0, -1.0, 2.0)]))
    x, seconds = off, 0.0
    while (velocity := manoeuvre.velocity(Pose(x, 0.0, 0.0), 0.1)) is not None:
        x, seconds = x + 0.1 * velocity[0], seconds + 0.1
    assert x == pytest.approx(-0.5, abs=0.07)
    assert seconds < 4.0


def test_a_way_that_closed_leads_up_to_where_that_shows_from_wherever_the_robot_is() -> None:
    """A robot that had made room stood until its goal was given up: the way it had was known near the other one only,
    which SLAM had drawn across the corridor."""
    options, route, nothing = navigation_with(), Route(navigation_with()), np.empty((0, 2))
    near, away = Pose(1.5, 2.0, 0.0), Pose(3.4, 2.0, 0.0)
    open_costs = CostMap(room(), options)
    route.set_goal(Pose(0.8, 2.0, 0.0), 0.0)
    route.update(0.0, near, open_costs, nothing)
    assert route.plan is not None and math.isinf(route.plan.cost_at(away.x, away.y))
    closed = CostMap(room((slice(0, 80), slice(25, 27))), options)
    route.update(2.0, away, closed, nothing)
    assert route.plan.cost_at(away.x, away.y) == pytest.approx(2.6, abs=0.3)


def test_a_robot_that_comes_nearer_to_what_closed_its_way_is_not_blocked_by_it() -> None:
    """One that came back from making room had its goal given up before it could see that the corridor
    was free again."""
    options, route, nothing = navigation_with(), Route(navigation_with()), np.empty((0, 2))
    closed = CostMap(room((slice(0, 80), slice(25, 27))), options)
    route.set_goal(Pose(0.8, 2.0, 0.0), 0.0)
    route.update(0.0, Pose(3.5, 2.0, 0.0), CostMap(room(), options), nothing)

    def stay(x: float, since: int, until: int, speed: float) -> float:
        for now in range(since, until):
            x -= speed
            route.update(float(now), Pose(x, 2.0, 0.0), closed, nothing)
            route.advance(float(now), Pose(x, 2.0, 0.0))
        return x

    x = stay(3.5, 1, 29, 0.06)
    assert options.blocked_timeout < 29 and route.plan is not None
    with pytest.raises(GivenUp, match="no way"):
        stay(x, 29, 57, 0.0)


def test_what_is_beside_the_robot_goes_on_where_the_laser_is_blind() -> None:
    """Robots that turned touched a wall with a corner behind the last beam, and backed into others that passed."""
    options, unknown, free = navigation_with(), np.full((80, 80), -1, np.int8), np.zeros((80, 80), np.int8)
    ends = free.copy()
    ends[35, 35:] = 100  # the wall that is seen, as far as it is seen
    for cells, goes_on in ((unknown, True), (ends, False), (free, True)):
        costs = CostMap(OccupancyGrid.of(cells, 0.05), options)
        rows = Surroundings(options).obstacles(costs, None, Pose(2.0, 2.0, 0.0), beside(0.205))
        behind = rows[(rows[:, 0] < 1.58) & (rows[:, 0] > 1.4)]
        assert (len(behind) > 0) == goes_on
        assert np.abs(behind[:, 1] - 1.795).max(initial=0.0) < 0.04


def test_a_surface_does_not_go_on_inside_the_robot() -> None:
    """The end of a jamb behind it told a direction that led there: what seemed to touch it already let it drive into
    what it saw."""
    angles = np.linspace(-2.356, 2.356, 541)
    # Where each beam meets the line through (-0.25, -0.25) that leads 67 degrees up, into the robot.
    along = np.array([0.38, 0.92])
    ranges = (-0.25 * along[1] + 0.25 * along[0]) / (np.cos(angles) * along[1] - np.sin(angles) * along[0])
    seen = (angles < -2.2) & (ranges > 0.0)
    scan = make_scan(np.where(seen, ranges, np.inf), -2.356, 4.712 / 540, 0.0, 8.0, Pose(0.0, 0.0, 0.0))
    points = seen_around(scan, OccupancyGrid.of(np.full((80, 80), -1, np.int8), 0.05))
    assert seen.sum() > 10 and len(points) > seen.sum() // 2
    assert (np.abs(points) >= (0.22, 0.19)).any(axis=1).all()


@pytest.mark.parametrize("slope, goes_on", [(-0.15, True), (0.15, False)])
def test_a_surface_that_seems_to_lead_into_the_robot_does_not_go_on(slope: float, goes_on: bool) -> None:
    """What came out on its other side, and what lay before, kept robots in doors that they had room to drive on in."""
    options = navigation_with(footprint_length=0.6)
    angles = np.linspace(-2.356, 2.356, 541)
    # Where each beam meets the line through (-0.33, -0.33) that leads up, past the robot or through its corner.
    ranges = (-0.33 + 0.33 * slope) / (np.cos(angles) - np.sin(angles) * slope)
    seen = (angles < -2.2) & (ranges > 0.0)
    scan = make_scan(np.where(seen, ranges, np.inf), -2.356, 4.712 / 540, 0.0, 8.0, Pose(0.0, 0.0, 0.0))
    costs = CostMap(OccupancyGrid.of(np.full((80, 80), -1, np.int8), 0.05), options)
    points = Surroundings(options).obstacles(costs, None, Pose(2.0, 2.0, 0.0), scan)[:, :2] - 2.0
    assert len(points) > seen.sum() // 2
    assert (points[:, 1] > -0.32).any() == goes_on


@pytest.mark.parametrize("first", [-math.pi, 0.0, math.pi, -2.0 * math.pi])
@pytest.mark.parametrize("turn", [2.0 * math.pi / 720, -2.0 * math.pi / 720])
@pytest.mark.parametrize("bearing", [0.0, 0.5 * math.pi, math.pi, -0.5 * math.pi])
def test_what_the_laser_sees_gone_is_forgotten_wherever_its_angles_begin(
    first: float, turn: float, bearing: float
) -> None:
    """On one side of lasers whose angles begin at 0 it was remembered, and walls that were seen counted twice."""
    pose, costs = Pose(2.0, 2.0, 0.3), CostMap(room(), navigation_with())
    angles = first + turn * np.arange(720)
    there = np.where(np.cos(angles - bearing) > math.cos(0.2), 1.0, 8.0)
    surroundings = Surroundings(navigation_with())
    surroundings.see(make_scan(there, first, turn, 0.1, 8.0, Pose()), pose, costs, 0.0)
    assert len(surroundings.moving_points(pose))
    surroundings.see(make_scan(np.full(720, 4.0), first, turn, 0.1, 4.0, Pose()), pose, costs, 0.1)
    assert not len(surroundings.moving_points(pose))
    wall = room((slice(50, 52), slice(40, 42)))
    assert not len(seen_around(make_scan(np.full(720, 8.0), first, turn, 0.1, 8.0, Pose()), wall))


@pytest.mark.parametrize("ahead, stays", [(0.4, True), (0.8, False), (-0.4, False)])
def test_what_came_too_near_to_be_read_is_forgotten_only_when_something_is_read_behind_it(
    ahead: float, stays: bool
) -> None:
    """Two robots that stood face to face, each nearer than the other reads, forgot each other and drove on."""
    angles, costs = np.linspace(-0.5, 0.5, 101), CostMap(room(), navigation_with())
    surroundings, pose = Surroundings(navigation_with()), Pose(3.0 - ahead, 2.0, 0.0)

    def see(ranges: np.ndarray, at: Pose, now: float) -> None:
        surroundings.see(make_scan(ranges, angles[0], 0.01, 0.45, 8.0, Pose()), at, costs, now)

    see(np.where(abs(angles) < 0.1, 1.0, np.nan), Pose(2.0, 2.0, 0.0), 0.0)
    for now in (0.1, 5.0, 10.0):
        see(np.full(101, np.nan), pose, now)
    assert bool(len(surroundings.moving_points(pose))) == stays
    see(np.full(101, 8.0), pose, 10.1)
    assert not len(surroundings.moving_points(pose))


@pytest.mark.parametrize("turn", [2.0 * math.pi / 720, -2.0 * math.pi / 720])
def test_a_laser_that_sees_all_around_has_no_edge(turn: float) -> None:
    """One that hangs upside down seemed to have: the wall went on from where its first beam hits it."""
    angles = -0.5 * math.pi + turn * np.arange(720)
    with np.errstate(divide="ignore"):
        ranges = np.where(np.sin(angles) < 0.0, np.minimum(-0.205 / np.sin(angles), 0.3), np.inf)
    scan = make_scan(ranges, -0.5 * math.pi, turn, 0.0, 8.0, Pose())
    points = seen_around(scan, OccupancyGrid.of(np.full((80, 80), -1, np.int8), 0.05))
    assert len(points) == len(scan.points)


def test_what_comes_into_the_own_map_is_no_wall_until_it_has_settled() -> None:
    """A robot that stood in a corridor was a wall across it: there was no way, and nothing to give way to."""
    arrivals, empty = Arrivals(30.0), room((slice(0, 80), slice(0, 2)))
    robot = OccupancyGrid.of(empty.cells.copy(), 0.05)
    robot.cells[30:36, 40:46] = 100
    robot.cells[50:56, 2:3] = 100  # the wall, seen better
    arrivals.update(empty, 0.0)
    arrivals.update(robot, 2.0)
    larger = OccupancyGrid.of(np.pad(robot.cells, ((20, 0), (10, 0)), constant_values=-1), 0.05, (-0.5, -1.0))
    for now, present in ((3.0, False), (31.0, False), (33.0, True)):
        arrivals.update(larger, now)
        taken = arrivals.taken_from(larger, now)
        assert (taken.cells[50:56, 50:56] == (100 if present else 0)).all()
        assert (taken.cells[70:76, 10:13] == 100).all()
        assert (arrivals.taken_from(robot, now).cells[30:36, 40:46] == (100 if present else 0)).all()


def test_a_map_without_what_has_come_is_made_once() -> None:
    """It was made anew with each position that another robot told."""
    arrivals, empty = Arrivals(30.0), room()
    robot = OccupancyGrid.of(empty.cells.copy(), 0.05)
    robot.cells[30:36, 40:46] = 100
    arrivals.update(empty, 0.0)
    arrivals.update(robot, 2.0)
    taken = arrivals.taken_from(robot, 3.0)
    assert arrivals.taken_from(robot, 4.0) is taken and not taken.equals(robot)
    assert arrivals.taken_from(robot, 33.0).equals(robot), "it has settled"
    arrivals.update(robot, 34.0)
    assert arrivals.taken_from(robot, 34.0).equals(robot)


def test_walls_that_slam_draws_elsewhere_are_still_walls() -> None:
    """After a loop is closed they stand where there was free ground."""
    arrivals = Arrivals(30.0)
    arrivals.update(room((slice(0, 80), slice(0, 2))), 0.0)
    shifted = room((slice(0, 80), slice(6, 8)))
    arrivals.update(shifted, 2.0)
    assert arrivals.taken_from(shifted, 2.0).equals(shifted)


def test_walls_of_the_map_count_where_the_laser_is_blind() -> None:
    """A wall drawn beside the true one kept robots from passing."""
    points = seen_around(EMPTY, room((slice(40, 42), slice(20, 22), slice(40, 42), slice(56, 58))))
    assert len(points) and (points[:, 0] < 0.0).all()


def test_where_the_laser_is_blind_the_robots_own_map_counts_first() -> None:
    """A wall that another robot had drawn 15 cm off, behind a robot in a door, made it turn into the jamb it saw."""
    merged = room((slice(40, 42), slice(20, 22)))  # at (1, 2), a metre behind the robot
    free, elsewhere = room(), room((slice(42, 44), slice(20, 22)))
    unknown = OccupancyGrid.of(np.full((80, 80), -1, np.int8), 0.05)
    assert len(seen_around(EMPTY, merged, free)) == 0
    assert seen_around(EMPTY, merged, elsewhere)[:, 1] == pytest.approx([0.125, 0.125, 0.175, 0.175])
    assert len(seen_around(EMPTY, merged, unknown)) == len(seen_around(EMPTY, merged)) == 4
    assert len(seen_around(EMPTY, room(), merged)) == 0  # a robot that has driven on, seen gone by others


def test_what_seems_to_be_inside_the_body_frees_no_motion_into_the_rest() -> None:
    """A wall drawn where the robot stood was touched already, and so a jamb beside it might be as well."""
    drawn, jamb = [(2.0 + x, 2.1, 0.02, 0.0) for x in np.arange(-0.15, 0.2, 0.05)], [(2.28, 2.1, 0.05, 0.0)]
    inexact = [(2.0, 2.17, 0.02, 0.0)]
    around = _navigation.outside(Pose(2.0, 2.0, 0.0), np.array(drawn + jamb + inexact), FOOTPRINT)
    assert around.tolist() == np.array(jamb + inexact).tolist()


def test_readings_become_ranges_and_hits() -> None:
    readings = np.array([np.nan, -1.0, 0.05, 2.0, 4.0, np.inf, -np.inf])
    scan = make_scan(readings, 0.0, math.pi / 2, 0.1, 4.0, Pose(0.5, 0.25, 0.0))
    assert scan.ranges.tolist() == [0.0, 0.0, 0.0, 2.0, 4.0, 4.0, 0.0]
    assert scan.points == pytest.approx(np.array([[0.5, -1.75]]))
    with pytest.raises(NavigationError):
        make_scan(readings, 0.0, math.pi / 2, 0.1, math.nan, Pose(0.0, 0.0, 0.0))


def test_giving_way_in_vain_widens_the_chance() -> None:
    """Two robots that know nothing of each other kept step."""

    def wait(held: HeldUp) -> float:
        held.clear()
        return next(t for t in np.arange(0.0, 60.0, 0.1) if held.must_give_way(t, (0.0, 0.0), (1.0, 0.0), {}))

    def waits(times: int) -> List[float]:
        result = []
        for seed in range(60):
            held = HeldUp("robot", navigation_with(), np.random.default_rng(seed))
            for k in range(times):
                held.gave_way(10.0 * k)
            result.append(wait(held))
        return result

    assert max(waits(0)) < 3.6 < 9.0 < max(waits(4)) < 12.6


def test_a_retreat_leads_out_of_a_long_narrow_corridor() -> None:
    """What narrow places cost on other ways ended the search inside."""
    cells = np.full((60, 140), 100, np.int8)
    cells[2:58, 2:40] = 0
    cells[26:35, 40:138] = 0
    costs = CostMap(OccupancyGrid.of(cells, 0.05), navigation_with())
    retreat = find_retreat(costs, np.empty((0, 2)), Pose(5.5, 1.52, math.pi), (6.4, 1.52))
    assert retreat is not None and retreat.goal[0] < 1.9


def test_a_robot_that_cannot_get_to_where_it_gives_way_looks_for_another_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """For twenty seconds it wanted to a place behind the very robot that waited for it."""
    asked: List[float] = []
    now = 0.0

    def found(costs: CostMap, obstacles: np.ndarray, pose: Pose, blocker: Tuple[float, float]) -> Optional[Plan]:
        asked.append(now)
        return plan(costs, obstacles, pose, (0.8, 2.0), 0.3)

    monkeypatch.setattr(engine, "find_retreat", found)
    navigator, pose = Navigator(navigation_with(), name="robot_1"), Pose(2.0, 2.0, 0.0)
    for set_map in (navigator.set_map, lambda grid: navigator.set_own_map(grid, 0.0)):
        set_map(room())
    navigator.set_goal(Pose(3.5, 2.0, 0.0), 0.0)
    readings = np.full(541, np.inf)
    readings[240:301] = 0.5  # a robot that stays before this one
    seen = make_scan(readings, -2.356, 4.712 / 540, 0.0, 8.0, Pose(0.1, 0.0, 0.0))
    for step in range(200):
        now = step * 0.1
        navigator.set_others({"robot_0": (2.8, 2.0)}, now)
        navigator.step(now, pose, seen)  # and does not get away
    assert len(asked) >= 3 and min(np.diff(asked)) >= 2.0 * STANDING


def test_who_gives_way_by_name_does_not_wait_by_chance() -> None:
    """Beside the way of who passes, it stood up to twelve seconds longer than that took."""
    held = HeldUp("robot_1", navigation_with(), np.random.default_rng(0))
    ahead = (1.0, 0.0)
    for _ in range(4):
        held.gave_way(0.0)
    held.must_give_way(0.0, (0.0, 0.0), ahead, {"robot_0": ahead})
    assert held.pause() == 0.5
    held.clear()
    held.must_give_way(1.0, (0.0, 0.0), ahead, {})
    assert len({held.pause() for _ in range(9)}) == 9


def test_a_retreat_leads_on_while_the_robot_comes_nearer_or_gains_room() -> None:
    costs = CostMap(room(), navigation_with())
    way = plan(costs, np.empty((0, 2)), Pose(3.0, 2.0, 0.0), (1.0, 2.0), 0.3)
    assert way is not None
    retreat = Retreat(way, 0.0)
    for now, x, gained_room, leads_on in [
        (0.1, 3.0, False, True),
        (2.0, 2.5, False, True),
        (6.9, 2.5, False, True),
        (7.1, 2.5, False, False),
        (7.2, 2.9, True, True),
        (12.1, 2.6, False, True),
        (12.3, 2.6, False, False),
    ]:
        retreat.advance(now, Pose(x, 2.0, 0.0), gained_room)
        assert retreat.leads_on(now) == leads_on, now


def test_a_retreat_leads_on_while_the_robot_gets_on_steadily() -> None:
    """A way that grew shorter by centimetres from step to step counted as none: every five seconds the robot looked for
    another place."""
    costs = CostMap(room(), navigation_with())
    way = plan(costs, np.empty((0, 2)), Pose(3.5, 2.0, 0.0), (0.8, 2.0), 0.3)
    assert way is not None
    retreat = Retreat(way, 0.0)
    for step in range(1, 100):
        retreat.advance(0.1 * step, Pose(3.5 - 0.025 * step, 2.0, math.pi), False)
        assert retreat.leads_on(0.1 * step)
