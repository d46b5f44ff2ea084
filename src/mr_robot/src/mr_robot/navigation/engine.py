"""Navigation of one robot: map, pose, scan and goal in, velocity command and state out.

Pure: time comes from the caller, chance from a generator seeded with the robot's name. Call `step` at a steady pace.
"""

import math
import zlib
from enum import Enum
from typing import List, Mapping, Optional, Tuple

import numpy as np

from mr_grid import FARTHEST, OccupancyGrid, Pose, is_place
from mr_robot import _navigation
from mr_robot.navigation.clock import Clock
from mr_robot.navigation.command import Command, GivenUp, Status, Velocity
from mr_robot.navigation.facing import Facing
from mr_robot.navigation.follower import Follower
from mr_robot.navigation.known_map import KnownMap
from mr_robot.navigation.look_around import LookAround
from mr_robot.navigation.motion import STOP, Motion
from mr_robot.navigation.options import (
    AT_REST,
    CREEPING,
    PROGRESS,
    REACH,
    STANDING,
    NavigationError,
    NavigationOptions,
    Scan,
)
from mr_robot.navigation.other_robots import OtherRobots
from mr_robot.navigation.planner import CostMap, Plan, path
from mr_robot.navigation.route import Route
from mr_robot.navigation.stall import StallWatch
from mr_robot.navigation.surroundings import Hazards, Surroundings
from mr_robot.navigation.yielding import HeldUp, Point, Retreat, find_retreat


class Mode(Enum):
    DRIVE = "drive"
    TURN = "turn"
    GIVE_WAY = "give way"
    WAIT = "wait"


class Navigator:
    """One robot. `name`: of two robots nose to nose the one whose name sorts later gives way."""

    def __init__(self, options: NavigationOptions, name: str = "robot", seed: int = 0) -> None:
        self.options = options
        self.name = name
        self.mode = Mode.DRIVE
        self._random = np.random.Generator(np.random.PCG64([seed, zlib.crc32(name.encode())]))
        self._map = KnownMap(self.options)
        self._surroundings = Surroundings(self.options)
        self._others = OtherRobots(self.options, name)
        self._route = Route(self.options)
        self._motion = Motion(self.options)
        self._look_around = LookAround(self._motion, self.options)
        self._follower = Follower(self._motion, self.options)
        self._held_up = HeldUp(name, self.options, self._random)
        self._stall = StallWatch(self.options.controller_period)
        self._clock = Clock()
        self._facing = Facing()
        self._mode_until = 0.0
        self._retreat: Optional[Retreat] = None
        self._gives_way_since: Optional[float] = None
        self._moved_at = 0.0  # when it last drove, other than turning
        self._complete_at = -math.inf  # when map, pose and scan were last there

    # --- inputs -------------------------------------------------------------------------------------------------------

    def set_map(self, grid: OccupancyGrid) -> None:
        """Raises NavigationError for a grid that is no map."""
        self._map.set_grid(grid)

    def set_own_map(self, grid: OccupancyGrid, now: float) -> None:
        """What this robot's own SLAM says, in the same frame: it tells what moves. What the others drew shifts with
        where their maps are believed to lie."""
        self._map.set_own_grid(grid, self._clock(now))

    def set_others(self, positions: Mapping[str, Tuple[float, float]], now: float) -> List[str]:
        """Where the other robots say they are, map frame. A hint: nothing depends on it being there or right. Returns
        the names of those whose position cannot be and is ignored."""
        ignored = self._others.hear(positions, self._clock(now))
        self._map.set_robots(self._others.places)
        return ignored

    def set_goal(self, goal: Pose, now: float) -> None:
        """A new goal replaces the old one; a moving robot goes on without stopping."""
        if not is_place(*goal):
            raise NavigationError(
                f"goal ({goal[0]:g}, {goal[1]:g}, {goal[2]:g}) is not within {FARTHEST:g} m of the map"
            )
        self._route.set_goal(goal, self._clock(now))
        if self.mode is Mode.TURN:
            self.mode = Mode.DRIVE

    def cancel(self) -> None:
        """Drops the goal; the robot brakes."""
        self._route.clear()
        self._follower.drop_manoeuvre()
        self.mode = Mode.DRIVE

    def path(self, pose: Pose) -> List[Tuple[float, float]]:
        """Points of the present way, empty when there is none."""
        return path(self._route.plan, pose) if self._route.plan is not None else []

    def step(self, now: float, pose: Optional[Pose], scan: Optional[Scan]) -> Command:
        """The command for the next period. `pose`: robot in the map frame; `scan`: the latest; None = not known."""
        if scan is not None:
            self._facing.see(scan)
        faced = None if pose is None else self._facing.pose(pose), None if scan is None else self._facing.scan(scan)
        return self._facing.command(self._step(self._clock(now), *faced))

    def _step(self, now: float, pose: Optional[Pose], scan: Optional[Scan]) -> Command:
        """In the frame of a robot that drives where its sensor looks."""
        costs = self._map.costs(now)
        if pose is None or scan is None or costs is None:
            missing = "map" if costs is None else "pose in the map" if pose is None else "laser scan"
            return self._without_input(now, missing)
        self._complete_at = now
        self._map.be_at(pose)
        self._surroundings.see(scan, pose, costs, now)
        if not self._route.has_goal:
            return self._come_to_rest(costs, pose, scan)
        if self._stall.blocked(now, pose):
            self._stall.clear()
            self._surroundings.bump(pose, self._motion.velocity, now)
            self._motion.velocity = STOP
            self._follower.plan_anew()
        self._motion.see(scan)
        obstacles = self._surroundings.obstacles(costs, self._map.own, pose, scan)
        obstacles = self._others.settle(np.concatenate([obstacles, self._others.unseen(now, pose, scan)]), now)
        obstacles = _navigation.outside(pose, obstacles, self._motion.footprint)
        hazards = Hazards(obstacles, lambda: self._surroundings.followers(now, costs, pose))
        try:
            command = self._turn_around(now, pose, scan, obstacles) or self._act(now, pose, costs, hazards)
        except GivenUp as reason:
            command = self._abort(str(reason))
        if not self._route.has_goal:
            velocity = self._motion.brake_clear((command.linear, command.angular), pose, obstacles)
            command = Command(*velocity, command.status, command.text)
        self._motion.velocity = (command.linear, command.angular)
        if abs(command.linear) > CREEPING:
            self._moved_at = now
        self._stall.command(now, self._motion.velocity)
        return command

    def _without_input(self, now: float, missing: str) -> Command:
        self._motion.velocity = STOP
        if not self._route.has_goal:
            return Command(*STOP, Status.IDLE)
        if now - max(self._route.since, self._complete_at) <= AT_REST:
            return Command(*STOP, Status.ACTIVE)
        return self._abort(f"no {missing} for {AT_REST:g} s")

    def _come_to_rest(self, costs: CostMap, pose: Pose, scan: Scan) -> Command:
        self._stall.clear()
        if self._motion.velocity == STOP:
            return Command(*STOP, Status.IDLE)
        obstacles = self._surroundings.obstacles(costs, self._map.own, pose, scan)
        return Command(*self._motion.brake_clear(self._motion.brake(), pose, obstacles), Status.IDLE)

    def _abort(self, text: str) -> Command:
        self.cancel()
        return Command(*self._motion.brake(), Status.ABORTED, text)

    # --- modes --------------------------------------------------------------------------------------------------------

    def _turn_around(self, now: float, pose: Pose, scan: Scan, obstacles: np.ndarray) -> Optional[Command]:
        velocity = self._look_around.velocity(pose, scan, obstacles)
        if velocity is None:
            return None
        self._route.progress_at = now
        return Command(*velocity, Status.ACTIVE)

    def _act(self, now: float, pose: Pose, costs: CostMap, hazards: Hazards) -> Command:
        if self.mode is Mode.GIVE_WAY:
            return self._give_way(now, pose, costs, hazards)
        if self.mode is Mode.WAIT and (now < self._mode_until or self._lets_pass(now, pose)):
            return self._brake(pose, hazards.obstacles)
        if self.mode is Mode.WAIT:
            self._drive_on(now)
        self._route.update(now, pose, costs, self._surroundings.moving_points(pose))
        if self._route.plan is None:
            return self._brake(pose, hazards.obstacles)
        return self._drive(now, pose, costs, self._route.plan, hazards)

    def _drive(self, now: float, pose: Pose, costs: CostMap, way: Plan, hazards: Hazards) -> Command:
        if self.mode is Mode.TURN or math.dist(pose[:2], way.goal) < self.options.xy_goal_tolerance:
            return self._turn_to_goal(now, pose, hazards.obstacles)
        self._route.advance(now, pose)
        standing = now - self._route.progress_at if self._blocker(pose) is None else 0.0
        # After a while what the robot seems to touch is taken for an error of map and scan: else it stands for ever.
        slack = _navigation.TOUCHING if standing > AT_REST else _navigation.SLACK
        velocity = self._follow(now, way, pose, hazards, standing > STANDING, slack)
        drives = velocity is not None and abs(velocity[0]) + PROGRESS * abs(velocity[1]) > CREEPING
        if self._held(now, pose, drives and now - self._route.nearer_at < STANDING):
            return self._begin_to_give_way(now, pose, costs, hazards)
        if now - self._route.progress_at > self.options.blocked_timeout:
            hint = "" if self._blocker(pose) is None else "; an obstacle that is not in the map is near"
            raise GivenUp(f"stuck at ({pose[0]:.2f}, {pose[1]:.2f}): no progress{hint}")
        return Command(*(velocity or STOP), Status.ACTIVE)

    def _turn_to_goal(self, now: float, pose: Pose, obstacles: np.ndarray) -> Command:
        error = math.remainder(self._route.goal[2] + self._facing.yaw - pose[2], 2.0 * math.pi)
        if abs(error) <= self.options.yaw_goal_tolerance or self.options.yaw_goal_tolerance >= math.pi:
            self.cancel()
            return Command(*self._motion.brake(), Status.SUCCEEDED)
        if self.mode is not Mode.TURN:
            self.mode = Mode.TURN
            self._mode_until = now + self.options.blocked_timeout
        if now > self._mode_until:
            raise GivenUp(f"cannot turn to the heading of the goal: {math.degrees(error):.0f} degrees are left")
        rate = min(self.options.max_angular_velocity, math.sqrt(2.0 * abs(error)))
        target = (0.0, math.copysign(rate, error))
        if not self._motion.is_clear(pose, obstacles, target):
            return self._brake(pose, obstacles)
        return Command(*self._motion.towards(target), Status.ACTIVE)

    def _follow(
        self,
        now: float,
        way: Plan,
        pose: Pose,
        hazards: Hazards,
        stuck: bool,
        slack: float = _navigation.SLACK,
    ) -> Optional[Velocity]:
        velocity = self._follower.follow(now, way, pose, hazards, stuck, slack)
        if self._follower.gained_room:
            self._route.progress_at = now
        return velocity

    def _brake(self, pose: Pose, obstacles: np.ndarray) -> Command:
        return Command(*self._motion.brake_clear(self._motion.brake(), pose, obstacles), Status.ACTIVE)

    # --- giving way ---------------------------------------------------------------------------------------------------

    def _held(self, now: float, pose: Pose, moving: bool) -> bool:
        """Whether something that moves holds the robot up and it is on this robot to make room."""
        blocker = None if moving else self._blocker(pose)
        return self._held_up.must_give_way(now, pose[:2], blocker, self._others.lately(now))

    def _blocker(self, pose: Pose) -> Optional[Point]:
        return self._surroundings.blocker(pose, self._route.closed)

    def _begin_to_give_way(self, now: float, pose: Pose, costs: CostMap, hazards: Hazards) -> Command:
        self._held_up.clear()
        self.mode = Mode.GIVE_WAY
        self._held_up.gave_way(now)
        self._gives_way_since = now
        self._mode_until = now + self.options.blocked_timeout
        return self._retreat_anew(now, pose, costs, hazards)

    def _retreat_anew(self, now: float, pose: Pose, costs: CostMap, hazards: Hazards) -> Command:
        blocker = self._blocker(pose)
        way = None
        if blocker is not None:
            way = find_retreat(costs, self._surroundings.moving_points(pose), pose, blocker)
        self._retreat = None if way is None else Retreat(way, now)
        self._follower.drop_manoeuvre()
        return self._brake(pose, hazards.obstacles)

    def _give_way(self, now: float, pose: Pose, costs: CostMap, hazards: Hazards) -> Command:
        retreat = self._retreat
        near = self.options.xy_goal_tolerance
        if retreat is None or now >= self._mode_until or math.dist(pose[:2], retreat.way.goal) < near:
            self.mode = Mode.WAIT
            self._follower.drop_manoeuvre()
            self._mode_until = now + self._held_up.pause()
            return self._brake(pose, hazards.obstacles)
        if not retreat.leads_on(now):
            return self._retreat_anew(now, pose, costs, hazards)
        velocity = self._follow(now, retreat.way, pose, hazards, now - self._moved_at > self.options.yield_patience)
        retreat.advance(now, pose, self._follower.gained_room)
        if velocity is None:
            return self._brake(pose, hazards.obstacles)
        return Command(*velocity, Status.ACTIVE)

    def _lets_pass(self, now: float, pose: Pose) -> bool:
        """Whether a robot with the right of way is still near the one that made room for it."""
        others = self._others.lately(now)
        near = [name for name, place in others.items() if math.dist(place, pose[:2]) < REACH]
        return now - self._mode_until < AT_REST and min(near, default=self.name) < self.name

    def _drive_on(self, now: float) -> None:
        self.mode = Mode.DRIVE
        self._held_up.clear()
        self._route.resume(now, self._gives_way_since)
        self._gives_way_since = None
