"""Navigation of one robot: map, pose, scan and goal in, velocity command and state out.

Pure: time comes from the caller, chance from a generator seeded with the robot's name. Call `step` at a steady pace.
Each step chooses, among the motions the robot can make next (Fox, Burgard and Thrun, The dynamic window approach to
collision avoidance, 1997), the one after which the plan's cost to go leaves the least time.
"""

import math
import zlib
from dataclasses import dataclass
from enum import Enum
from typing import List, Mapping, Optional, Tuple

import numpy as np

from mr_grid import FARTHEST, OccupancyGrid, Pose, is_place
from mr_robot import _navigation
from mr_robot.navigation.arrivals import Arrivals
from mr_robot.navigation.clock import Clock
from mr_robot.navigation.manoeuvre import Manoeuvre, plan_manoeuvre
from mr_robot.navigation.obstacles import KNOWN_WITHIN, ObstacleMemory
from mr_robot.navigation.options import NavigationError, NavigationOptions, Scan
from mr_robot.navigation.planner import CostMap, Plan, path, plan, without_robots
from mr_robot.navigation.stall import StallWatch
from mr_robot.navigation.yielding import HeldUp, find_retreat, nearest_blocker

MOST_ROTATION = 1e-3  # rad: kernels take cells to lie along the axes of the frame
WALL_MARGIN = 0.02  # m to walls known from the map alone: their cells are coarse
POINT_SPACING = 0.03  # m, finer detail of obstacles does not matter
LOOK_AHEAD = 0.5  # m that a robot drives before it is where it has looked: it turns no sharper than it sees
ROBOT_NEAR = 1.5  # m within which a robot that says where it is counts where the laser is blind
ROBOT_RIM = 0.04  # m by which the rim that its footprint takes up lies within the radius of the largest robot
HINT_AGE = 6.0  # s for which reported positions of other robots count
DETOUR = 5.0  # m that a way around something moving may be longer before waiting is better
DETOUR_WAIT = 8.0  # s after which any detour is taken
NO_WAY_CHECKS = 3  # plans that must fail before a goal is called unreachable
NO_WAY_PAUSE = 0.25  # s between them
PROGRESS = 0.1  # m of way that count as progress
STANDING = 2.5  # s without progress, and with nothing in the way, after which a robot plans how to turn and back
STILL = 1.0  # s without driving after which a robot that has to give way does
CREEPING = 0.05  # m/s
TO_AND_FRO = 3.0  # s for which driving without coming nearer counts as getting on
TO_AND_FRO_LIMIT = 2.0  # times the timeout of a blocked way, for which a robot may give way and come back
AWAY = 0.6  # rad to the way from which a robot without room to turn does so at once
TOUCHING = 0.03  # m to what is beside a robot from which it first gains room
MANOEUVRE_PAUSE = 0.5  # s between plans of that kind
GIVE_WAY_TIME, GIVE_WAY_FACTOR, GIVE_WAY_MOST = 10.0, 2.0, 30.0  # s, plus so often the way at full speed, up to s
PASSING_NEAR, PASSING_TIME = 2.5, 8.0  # m within which a robot that passes is waited for, for s more at most
TURN_TIME = 8.0  # s to turn to the heading of a goal
BRAKING = 0.6  # s that it takes at most
BUMPED = 0.03  # m before the side that ran into what the laser does not see, where it is taken to be
INPUT_PATIENCE = 5.0  # s a goal waits for map, pose and scan
TIME_ALLOWED = 30.0  # s for any goal, plus
TIME_FACTOR = 5.0  # times what the way takes at full speed
# Unit vectors (12, 2) all around, for the rim of a robot.
CIRCLE = np.stack([np.cos(np.arange(12) * math.pi / 6.0), np.sin(np.arange(12) * math.pi / 6.0)], axis=1)


class Status(Enum):
    IDLE = "idle"
    ACTIVE = "active"
    SUCCEEDED = "succeeded"
    ABORTED = "aborted"


class Mode(Enum):
    DRIVE = "drive"
    TURN = "turn"
    GIVE_WAY = "give way"
    WAIT = "wait"


@dataclass(frozen=True)
class Command:
    linear: float  # m/s
    angular: float  # rad/s
    status: Status
    text: str = ""  # why, when ABORTED


@dataclass
class _Goal:
    pose: Pose
    since: float
    best: float = math.inf  # least way left so far by the present plan, m
    deadline: float = math.inf
    nearest: float = math.inf  # least way left so far through the map alone, m
    nearest_at: float = -math.inf  # since when
    blocked_since: Optional[float] = None
    failed_plans: int = 0


class Navigator:
    """One robot. `name`: of two robots nose to nose the one whose name sorts later gives way."""

    def __init__(self, options: Optional[NavigationOptions] = None, name: str = "robot", seed: int = 0) -> None:
        self.options = options or NavigationOptions()
        self.name = name
        self.mode = Mode.DRIVE
        self.plan: Optional[Plan] = None
        self._random = np.random.Generator(np.random.PCG64([seed, zlib.crc32(name.encode())]))
        self._grid: Optional[OccupancyGrid] = None
        self._arrivals = Arrivals()
        self._costs: Optional[CostMap] = None
        self._costs_hold = False  # whether they are those of the present map and positions
        self._known: Optional[Plan] = None  # the latest way through the map alone
        self._memory = ObstacleMemory(self.options.obstacle_memory)
        self._others: Mapping[str, Tuple[float, float]] = {}
        self._others_at = -math.inf
        self._goal: Optional[_Goal] = None
        self._planned_at = -math.inf
        self._mode_until = 0.0
        self._retreat: Optional[Plan] = None
        self._gives_way_since: Optional[float] = None
        self._manoeuvre: Optional[Manoeuvre] = None
        self._manoeuvre_at = -math.inf  # when it was planned last
        self._progress_at = 0.0
        self._nearer_at = 0.0  # when it last came nearer to its goal than before
        self._moved_at = 0.0  # when it last drove, other than turning
        self._clock = Clock()
        self._velocity = (0.0, 0.0)
        self._stall = StallWatch()
        self._held_up = HeldUp(name, self.options.yield_patience, self._random, self.options.largest_robot_radius)
        self._footprint = _footprint(self.options)
        self._near = self.options.reach_in(_navigation.Horizon().duration)
        self._rim = round(self.options.largest_robot_radius - ROBOT_RIM, 3)
        self._limits = _limits(self.options)
        self._margins = _navigation.Margins(
            WALL_MARGIN, self.options.obstacle_margin, self.options.moving_margin, self.options.moving_reaction_time
        )
        self._hits = np.empty((0, 2))  # of the latest scan, robot's frame
        self._pose: Optional[Pose] = None  # the latest

    # --- inputs -------------------------------------------------------------------------------------------------------

    def set_map(self, grid: OccupancyGrid) -> None:
        """Raises NavigationError for a grid that is no map."""
        if 0 in grid.cells.shape:
            raise NavigationError(f"map has no cells: shape {grid.cells.shape}")
        x, y, yaw = grid.origin
        if not is_place(x, y) or abs(yaw) > MOST_ROTATION:
            raise NavigationError(
                f"map needs an origin within {FARTHEST:g} m that is not rotated, not ({x:g}, {y:g}, {yaw:g})"
            )
        self._grid = grid
        self._costs_hold = False

    def set_own_map(self, grid: OccupancyGrid, now: float) -> None:
        """What this robot's own SLAM says, in the same frame: it tells what moves. What the others drew shifts with
        where their maps are believed to lie."""
        self._arrivals.update(grid, self._clock(now))
        self._costs_hold = False

    def set_others(self, positions: Mapping[str, Tuple[float, float]], now: float) -> List[str]:
        """Where the other robots say they are, map frame. A hint: nothing depends on it being there or right. Returns
        the names of those whose position cannot be and is ignored."""
        usable = {name: position for name, position in positions.items() if is_place(*position)}
        self._others = {name: position for name, position in usable.items() if name != self.name}
        self._others_at = self._clock(now)
        self._costs_hold = False
        return sorted(set(positions) - set(usable))

    def _cost_map(self, now: float) -> Optional[CostMap]:
        """Of the present map. Robots that stood still long enough to enter it are no walls: what came lately is taken
        out, and them where they report."""
        if self._grid is None or self._costs_hold:
            return self._costs
        self._costs_hold = True
        grid = self._arrivals.taken_from(self._grid, now)
        grid = without_robots(grid, list(self._others.values()), self.options.largest_robot_radius)
        if self._costs is None or not grid.equals(self._costs.grid):
            self._costs = CostMap(grid, self.options, self._costs)
        return self._costs

    def set_goal(self, goal: Pose, now: float) -> None:
        """A new goal replaces the old one; a moving robot goes on without stopping."""
        if not is_place(*goal):
            raise NavigationError(
                f"goal ({goal[0]:g}, {goal[1]:g}, {goal[2]:g}) is not within {FARTHEST:g} m of the map"
            )
        now = self._clock(now)
        if self._goal is None:
            self._progress_at = now  # another goal is none
        self._goal = _Goal(goal, now)
        self._planned_at = -math.inf
        self.plan = None
        if self.mode is Mode.TURN:
            self.mode = Mode.DRIVE

    def cancel(self) -> None:
        """Drops the goal; the robot brakes."""
        self._goal = None
        self.plan = None
        self.mode = Mode.DRIVE
        self._manoeuvre = None

    def path(self, pose: Pose) -> List[Tuple[float, float]]:
        """Points of the present way, empty when there is none."""
        return path(self.plan, pose) if self.plan is not None else []

    def step(self, now: float, pose: Optional[Pose], scan: Optional[Scan]) -> Command:
        """The command for the next period. `pose`: robot in the map frame; `scan`: the latest; None = not known."""
        now = self._clock(now)
        costs = self._cost_map(now)
        if pose is None or scan is None or costs is None:
            return self._without_input(now, pose, scan)
        self._hits, self._pose = scan.points, pose
        self._memory.update(scan, pose, costs.walls, now)
        if self._goal is None:
            self._stall.clear()
            if self._velocity == (0.0, 0.0):
                return Command(0.0, 0.0, Status.IDLE)
            return self._brake_clear(self._brake(Status.IDLE), pose, self._obstacles(costs, pose, scan))
        if self._stall.blocked(now, pose):
            self._stall.clear()
            self._memory.add(self._bumped(pose), now)
            self._velocity, self._manoeuvre, self._manoeuvre_at = (0.0, 0.0), None, -math.inf
        self._limits.curvature = 2.0 * _half_view(scan) / LOOK_AHEAD
        obstacles = self._with_unseen_robots(now, pose, scan, self._obstacles(costs, pose, scan))
        command = self._act(now, pose, obstacles)
        if self._goal is None:
            command = self._brake_clear(command, pose, obstacles)
        self._velocity = (command.linear, command.angular)
        if abs(command.linear) > CREEPING:
            self._moved_at = now
        self._stall.command(now, self._velocity)
        return command

    # --- modes --------------------------------------------------------------------------------------------------------

    def _act(self, now: float, pose: Pose, obstacles: np.ndarray) -> Command:
        if self.mode is Mode.GIVE_WAY:
            return self._give_way(now, pose, obstacles)
        if self.mode is Mode.WAIT and (now < self._mode_until or self._lets_pass(now, pose)):
            return self._brake(Status.ACTIVE)
        if self.mode is not Mode.TURN:
            self._enter_drive(now)
        failure = self._replan(now, pose)
        if failure is not None:
            return failure
        if self.plan is None:
            return self._brake(Status.ACTIVE)
        return self._drive(now, pose, obstacles)

    def _drive(self, now: float, pose: Pose, obstacles: np.ndarray) -> Command:
        assert self._goal is not None and self.plan is not None
        goal, way = self._goal, self.plan
        if self.mode is Mode.TURN or math.dist(pose[:2], way.goal) < self.options.xy_goal_tolerance:
            return self._turn_to_goal(now, pose, obstacles)
        left = way.cost_at(pose[0], pose[1])
        if left < goal.best - PROGRESS:
            if goal.best < math.inf:
                self._progress_at = now
            goal.best, self._nearer_at = left, now
        if now > goal.deadline:
            return self._abort(f"{now - goal.since:.0f} s were not enough to reach the goal, {left:.1f} m are left")
        found, linear, angular = self._follow(now, way, pose, obstacles)
        drives = found and abs(linear) + 0.1 * abs(angular) > CREEPING and now - self._nearer_at < TO_AND_FRO
        if self._held(now, pose, moving=drives):
            return self._begin_to_give_way(now, pose)
        if now - self._progress_at > self.options.blocked_timeout:
            hint = "" if self._blocker(pose) is None else "; an obstacle that is not in the map is near"
            return self._abort(f"stuck at ({pose[0]:.2f}, {pose[1]:.2f}): no progress{hint}")
        # Nothing is safe, not even to brake gently: stop.
        return Command(linear, angular, Status.ACTIVE) if found else Command(0.0, 0.0, Status.ACTIVE)

    def _turn_to_goal(self, now: float, pose: Pose, obstacles: np.ndarray) -> Command:
        assert self._goal is not None
        error = math.remainder(self._goal.pose[2] - pose[2], 2.0 * math.pi)
        if abs(error) <= self.options.yaw_goal_tolerance or self.options.yaw_goal_tolerance >= math.pi:
            self.cancel()
            return self._brake(Status.SUCCEEDED)
        if self.mode is not Mode.TURN:
            self.mode = Mode.TURN
            self._mode_until = now + TURN_TIME
        if now > self._mode_until:
            return self._abort(f"cannot turn to the heading of the goal: {math.degrees(error):.0f} degrees are left")
        rate = min(self.options.max_angular_velocity, math.sqrt(2.0 * abs(error)))
        return self._ramp(pose, obstacles, (0.0, math.copysign(rate, error)))

    def _follow(self, now: float, way: Plan, pose: Pose, obstacles: np.ndarray) -> Tuple[bool, float, float]:
        """Whether anything is safe, m/s and rad/s. Where the way cannot be driven ahead, a manoeuvre leads on."""
        tight = _bare(obstacles, self.options.obstacle_margin)
        if self._manoeuvre is None and self._wants_manoeuvre(now, way, pose, tight):
            self._manoeuvre_at = now
            self._manoeuvre = plan_manoeuvre(way, pose, tight, self._footprint, self.options)
        if self._manoeuvre is not None:
            target = self._manoeuvre.velocity(pose, self.options.controller_period)
            if target is not None:
                if self._is_clear(pose, tight, target, 0.4):
                    return (True, *self._approach(target))
                self._manoeuvre = None
                return (True, *self._approach((0.0, 0.0)))
            self._manoeuvre = None
            self._progress_at = now
        return self._choose(way, pose, obstacles)

    def _wants_manoeuvre(self, now: float, way: Plan, pose: Pose, tight: np.ndarray) -> bool:
        if now - self._manoeuvre_at < MANOEUVRE_PAUSE:
            return False
        if self.mode is Mode.GIVE_WAY:
            if now - self._moved_at > STILL:
                return True
        elif now - self._progress_at > STANDING and self._blocker(pose) is None:
            return True
        if _navigation.has_room_to_turn(pose, tight, self._footprint):
            return False
        if _navigation.clearance(pose, tight, self._footprint) < TOUCHING:
            return True
        off = _navigation.turn_wanted(way.cost, way.grid.resolution, way.grid.origin[:2], way.goal, pose)
        return abs(off) > AWAY

    def _bumped(self, pose: Pose) -> np.ndarray:
        """Points (n, 2) along the side that ran into something."""
        if self._velocity[0] == 0.0:
            return np.empty((0, 2))
        x = math.copysign(self.options.footprint_length / 2.0 + BUMPED, self._velocity[0])
        half = self.options.footprint_width / 2.0
        return pose.apply(np.array([(x, y) for y in np.linspace(-half, half, 9)]))

    def _give_way(self, now: float, pose: Pose, obstacles: np.ndarray) -> Command:
        retreat = self._retreat
        if retreat is None or now >= self._mode_until or math.dist(pose[:2], retreat.goal) < 0.2:
            self.mode = Mode.WAIT
            self._manoeuvre = None
            self._mode_until = now + 1.5 + 3.0 * self._random.random()
            return self._brake(Status.ACTIVE)
        found, linear, angular = self._follow(now, retreat, pose, obstacles)
        return Command(linear, angular, Status.ACTIVE) if found else self._brake(Status.ACTIVE)

    def _enter_drive(self, now: float) -> None:
        if self.mode is Mode.DRIVE:
            return
        assert self._goal is not None
        self.mode = Mode.DRIVE
        self._held_up.clear()
        self._progress_at = now
        self._goal.best = math.inf
        self._planned_at = -math.inf
        if self._gives_way_since is not None and self._goal.blocked_since is not None:
            self._goal.blocked_since += now - self._gives_way_since  # what it left alone did not block it
        self._gives_way_since = None

    # --- decisions ----------------------------------------------------------------------------------------------------

    def _replan(self, now: float, pose: Pose) -> Optional[Command]:
        """Plans when it is time; an ABORTED command when there is no way."""
        assert self._goal is not None and self._costs is not None
        goal = self._goal
        if 0.0 <= now - self._planned_at < self.options.plan_period:
            return None
        self._planned_at = now
        target = (goal.pose[0], goal.pose[1])
        radius = self.options.goal_search_radius
        empty, narrow = np.empty((0, 2)), False
        known = plan(self._costs, empty, pose, target, radius, self._known)
        if known is None:
            narrow = True
            known = plan(self._costs, empty, pose, target, radius, self._known, narrow)
        self._known = known
        if known is None:
            return self._no_way(now, target)
        goal.failed_plans = 0
        moving = self._moving_points(pose)
        around = plan(self._costs, moving, pose, target, radius, known, narrow) if len(moving) else known
        way = self._prefer(now, pose, known, around)
        if way is None:
            waited = now - (goal.blocked_since or now)
            return self._abort(
                f"the way to ({target[0]:.2f}, {target[1]:.2f}) has been blocked for {waited:.0f} s by an obstacle "
                "that is not in the map"
            )
        left = way.cost_at(pose[0], pose[1])
        if self.plan is None or left > goal.best + 1.0:
            goal.best = left + PROGRESS
        if goal.deadline == math.inf:
            goal.deadline = now + TIME_ALLOWED + TIME_FACTOR * left / self.options.max_linear_velocity
        self.plan = way
        return None

    def _prefer(self, now: float, pose: Pose, known: Plan, around: Optional[Plan]) -> Optional[Plan]:
        """Around what moves when that is not far; else up to it, waiting; None when it has not moved for long."""
        assert self._goal is not None
        goal = self._goal
        left, extra = known.cost_at(pose[0], pose[1]), math.inf
        if left < goal.nearest - PROGRESS:
            goal.nearest, goal.nearest_at = left, now
        if around is not None:
            extra = around.cost_at(pose[0], pose[1]) - left
        if extra <= DETOUR:
            goal.blocked_since = None
            return around
        if goal.blocked_since is None:
            goal.blocked_since = now
        timeout = self.options.blocked_timeout
        # Who gives way and comes back comes nearer each time, but not nearer than before.
        goal.blocked_since = max(goal.blocked_since, min(self._nearer_at, goal.nearest_at + TO_AND_FRO_LIMIT * timeout))
        if around is not None and now - goal.blocked_since > DETOUR_WAIT:
            return around
        return known if now - goal.blocked_since <= timeout else None

    def _no_way(self, now: float, target: Tuple[float, float]) -> Optional[Command]:
        assert self._goal is not None
        goal = self._goal
        if self.plan is not None:
            # There was a way: what closed it came later and may go again. The old plan leads up to it.
            if goal.blocked_since is None:
                goal.blocked_since = now
            if now - goal.blocked_since <= self.options.blocked_timeout:
                return None
        goal.failed_plans += 1
        if self._goal.failed_plans >= NO_WAY_CHECKS:
            return self._abort(f"no way to ({target[0]:.2f}, {target[1]:.2f}): {self._why_no_way(target)}")
        self._planned_at = now - self.options.plan_period + NO_WAY_PAUSE
        return None

    def _why_no_way(self, target: Tuple[float, float]) -> str:
        assert self._costs is not None
        grid = self._costs.grid
        row, column = grid.info.cell_of(*target)
        if not grid.info.contains(row, column):
            return "the goal lies outside the map"
        value = int(grid.cells[row, column])
        if 0 <= value <= 50:
            return "walls or unknown cells close it off"
        where = "in the unknown" if value < 0 else "in a wall"
        return f"the goal is {where} and nothing within {self.options.goal_search_radius:g} m of it can be reached"

    def _held(self, now: float, pose: Pose, moving: bool) -> bool:
        """Whether something that moves holds the robot up and it is on this robot to make room."""
        blocker = None if moving else self._blocker(pose)
        others = self._others if now - self._others_at < HINT_AGE else {}
        return self._held_up.must_give_way(now, pose[:2], blocker, others)

    def _blocker(self, pose: Pose) -> Optional[Tuple[float, float]]:
        """What moves ahead of the robot, or, on a way that closed after it was planned, whatever is ahead."""
        assert self._goal is not None
        closed = self._goal.blocked_since is not None and not self._memory.size
        points = self._memory.points
        return nearest_blocker(np.concatenate([points, pose.apply(self._hits)]) if closed else points, pose)

    def _begin_to_give_way(self, now: float, pose: Pose) -> Command:
        assert self._costs is not None
        blocker = self._blocker(pose)
        self._held_up.clear()
        self._retreat = None
        if blocker is not None:
            self._retreat = find_retreat(self._costs, self._moving_points(pose), pose, blocker)
        self.mode = Mode.GIVE_WAY
        self._held_up.gave_way(now)
        self._manoeuvre = None
        self._gives_way_since = now
        left = math.inf if self._retreat is None else self._retreat.cost_at(pose[0], pose[1])
        self._mode_until = now + min(
            GIVE_WAY_TIME + GIVE_WAY_FACTOR * left / self.options.max_linear_velocity, GIVE_WAY_MOST
        )
        return self._brake(Status.ACTIVE)

    def _lets_pass(self, now: float, pose: Pose) -> bool:
        """Whether a robot with the right of way is still near the one that made room for it."""
        others = self._others if now - self._others_at < HINT_AGE else {}
        near = [name for name, place in others.items() if math.dist(place, pose[:2]) < PASSING_NEAR]
        return now - self._mode_until < PASSING_TIME and min(near, default=self.name) < self.name

    def _abort(self, text: str) -> Command:
        self.cancel()
        brake = self._brake(Status.ABORTED)
        return Command(brake.linear, brake.angular, Status.ABORTED, text)

    def _without_input(self, now: float, pose: Optional[Pose], scan: Optional[Scan]) -> Command:
        self._velocity = (0.0, 0.0)
        if self._goal is None:
            return Command(0.0, 0.0, Status.IDLE)
        if now - self._goal.since <= INPUT_PATIENCE:
            return Command(0.0, 0.0, Status.ACTIVE)
        missing = "map" if self._costs is None else "pose in the map" if pose is None else "laser scan"
        return self._abort(f"no {missing} for {INPUT_PATIENCE:g} s")

    # --- motion -------------------------------------------------------------------------------------------------------

    def _moving_points(self, pose: Pose) -> np.ndarray:
        """Remembered obstacles (n, 2) but for what lies inside the robot itself."""
        points = self._memory.points
        return points[np.hypot(points[:, 0] - pose[0], points[:, 1] - pose[1]) > self.options.inscribed_radius]

    def _obstacles(self, costs: CostMap, pose: Pose, scan: Scan) -> np.ndarray:
        """What the next motion must not touch: rows (x, y, margin, reaction time) in the map frame."""
        return _navigation.surroundings(
            scan.points, pose, self._memory.rows, costs.walls, self._margins, KNOWN_WITHIN, self._near, POINT_SPACING,
            scan.ranges, scan.angle_min, scan.angle_increment, scan.mount,
        )  # fmt: skip

    def _with_unseen_robots(self, now: float, pose: Pose, scan: Scan, obstacles: np.ndarray) -> np.ndarray:
        """Behind, and wherever else the laser is blind, also the rims of robots that say they are there."""
        if now - self._others_at >= HINT_AGE:
            return obstacles
        near = np.array([place for place in self._others.values() if math.dist(place, pose[:2]) < ROBOT_NEAR])
        unseen = near[_unseen(pose.apply_inverse(near), scan)] if len(near) else near
        if not len(unseen):
            return obstacles
        rims = (unseen[:, None, :] + self._rim * CIRCLE[None, :, :]).reshape(-1, 2)
        margins = np.tile([self.options.moving_margin, self.options.moving_reaction_time], (len(rims), 1))
        return np.concatenate([obstacles, np.hstack([rims, margins])])

    def _choose(self, way: Plan, pose: Pose, obstacles: np.ndarray) -> Tuple[bool, float, float]:
        horizon = _navigation.Horizon()
        horizon.goal_radius = 0.7 * self.options.xy_goal_tolerance
        found, linear, angular, _, _ = _navigation.choose_velocity(
            way.cost, way.grid.resolution, way.grid.origin[:2], way.goal, pose, self._velocity, obstacles,
            self._limits, self._footprint, horizon, self.options.controller_period,
        )  # fmt: skip
        return found, linear, angular

    def _is_clear(self, pose: Pose, obstacles: np.ndarray, target: Tuple[float, float], duration: float) -> bool:
        horizon = _navigation.Horizon()
        horizon.duration, horizon.slack = duration, 0.002
        return _navigation.is_clear(pose, self._velocity, target, obstacles, self._limits, self._footprint, horizon)

    def _ramp(self, pose: Pose, obstacles: np.ndarray, target: Tuple[float, float]) -> Command:
        """Towards a velocity within the acceleration limits; brakes where that would touch something."""
        if not self._is_clear(pose, obstacles, target, 0.4):
            return self._brake(Status.ACTIVE)
        return Command(*self._approach(target), Status.ACTIVE)

    def _approach(self, target: Tuple[float, float]) -> Tuple[float, float]:
        period = self.options.controller_period
        most = (self.options.linear_acceleration * period, self.options.angular_acceleration * period)
        linear, angular = (v + min(max(t - v, -m), m) for v, t, m in zip(self._velocity, target, most))
        return linear, angular

    def _brake(self, status: Status) -> Command:
        linear, angular = self._approach((0.0, 0.0))
        self._velocity = (linear, angular)
        return Command(linear, angular, status)

    def _brake_clear(self, command: Command, pose: Pose, obstacles: np.ndarray) -> Command:
        """Of a robot without a goal, which brakes on the curve that it was on: at once where that touches something."""
        tight = _bare(obstacles, self.options.obstacle_margin)
        self._velocity = (command.linear, command.angular)
        if self._is_clear(pose, tight, (0.0, 0.0), BRAKING):
            return command
        self._velocity = (0.0, 0.0)
        return Command(0.0, 0.0, command.status, command.text)


def _bare(obstacles: np.ndarray, margin: float) -> np.ndarray:
    """Rows (x, y, margin, reaction time) with `margin`, m, less: as near as the body can come."""
    bare = obstacles - (0.0, 0.0, margin, 0.0)
    bare[:, 2:] = np.maximum(bare[:, 2:], 0.0) * (1.0, 0.0)
    return bare


def _unseen(points: np.ndarray, scan: Scan) -> np.ndarray:
    """bool (n,), of points (n, 2) in the robot's frame: behind the robot, or beside the field of view."""
    middle = scan.angle_min + 0.5 * (len(scan.ranges) - 1) * scan.angle_increment
    from_laser = scan.mount.apply_inverse(points)
    bearing = np.arctan2(from_laser[:, 1], from_laser[:, 0]) - middle
    beside = np.abs(np.remainder(bearing + math.pi, 2.0 * math.pi) - math.pi) > _half_view(scan)
    unseen: np.ndarray = (points[:, 0] < 0.0) | beside
    return unseen


def _half_view(scan: Scan) -> float:
    """rad to each side of where the laser looks."""
    return abs(0.5 * (len(scan.ranges) - 1) * scan.angle_increment)


def _limits(options: NavigationOptions) -> _navigation.Limits:
    limits = _navigation.Limits()
    limits.linear = options.max_linear_velocity
    limits.angular = options.max_angular_velocity
    limits.linear_acceleration = options.linear_acceleration
    limits.angular_acceleration = options.angular_acceleration
    return limits


def _footprint(options: NavigationOptions) -> _navigation.Footprint:
    footprint = _navigation.Footprint()
    footprint.half_length = options.footprint_length / 2.0
    footprint.half_width = options.footprint_width / 2.0
    return footprint
