"""MRPT's reactive navigator in the place of what drives along our ways, for comparison."""

import itertools
import math
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any
from unittest import mock

import numpy as np

from mr_grid import Pose
from mr_robot import _navigation
from mr_robot.navigation.command import Velocity
from mr_robot.navigation.motion import Motion
from mr_robot.navigation.options import NavigationOptions
from mr_robot.navigation.planner import Plan, path
from mr_robot.navigation.surroundings import Hazards

AHEAD = 0.6  # m along the way to the point that MRPT is sent to
ALLOWED = 0.3  # m from that point at which it is sent on
RENEWED = 0.5  # s after which it is sent on in any case
MOST_ROBOTS = 2  # in a scene
SPARE = 0.02  # m that the robot is taken to be larger on each side

_SETTINGS = """
[CAbstractNavigator]
dist_to_target_for_sending_event = 0
alarm_seems_not_approaching_target_timeout = 1000
dist_check_target_is_blocked = 0
[CWaypointsNavigator]
max_distance_to_allow_skip_waypoint = -1
[CAbstractPTGBasedReactive]
robotMax_V_mps = {speed}
robotMax_W_degps = {turn}
holonomic_method = CHolonomicFullEval
motion_decider_method = CMultiObjMotionOpt_Scalarization
ptg_cache_files_directory = {folder}
ref_distance = 2.0
secure_distance_start = 0.02
secure_distance_end = 0.10
use_delays_model = false
max_distance_predicted_actual_path = 0.15
min_normalized_free_space_for_ptg_continuation = 0.2
enable_obstacle_filtering = false
evaluate_clearance = true
[CHolonomicFullEval]
factorWeights = [0.1 , 0.5 , 0.5 , 0.01 , 1 , 1 , 1]
factorNormalizeOrNot = [0 , 0 , 0 , 0 , 1 , 0 , 0]
PHASE_COUNT = 3
PHASE1_FACTORS = [1 , 2]
PHASE1_THRESHOLD = 0.5
PHASE2_FACTORS = [4]
PHASE2_THRESHOLD = 0.6
PHASE3_FACTORS = [0 , 2]
PHASE3_THRESHOLD = 0.7
TOO_CLOSE_OBSTACLE = 0.02
TARGET_SLOW_APPROACHING_DISTANCE = 0.1
OBSTACLE_SLOW_DOWN_DISTANCE = 0.1
HYSTERESIS_SECTOR_COUNT = 5
LOG_SCORE_MATRIX = false
clearance_threshold_ratio = 0.05
gap_width_ratio_threshold = 0.20
[CMultiObjectiveMotionOptimizerBase]
score1_name = of_target
score1_formula = target_d_norm
score2_name = of_free
score2_formula = collision_free_distance
score3_name = of_nearness
score3_formula = (ref_dist - dist_eucl_final) / ref_dist
score4_name = of_keeping
score4_formula = hysteresis
score5_name = of_index
score5_formula = var dif:=abs(target_k-move_k); if (dif>(num_paths/2)) {{ dif:=num_paths-dif; }}; exp(-abs(dif / (num_paths/10.0)));
score6_name = of_priority
score6_formula = ptg_priority
scores_to_normalize = of_target
[CMultiObjMotionOpt_Scalarization]
scalar_score_formula = of_priority*(0.3*of_target + 0.5*of_free + 2.0*of_nearness + 0.1*of_keeping + 0.2*of_index)
[CReactiveNavigationSystem]
min_obstacles_height = -1
max_obstacles_height = 1
PTG_COUNT = {count}
RobotModel_shape2D_xs = -{a} {a} {a} -{a}
RobotModel_shape2D_ys = -{b} -{b} {b} {b}
RobotModel_circular_shape_radius = {radius}
"""  # noqa: E501
_PTG = """
PTG{number}_Type = {kind}
PTG{number}_K = {k}
PTG{number}_cte_a0v_deg = 57
PTG{number}_cte_a0w_deg = 57
PTG{number}_resolution = 0.02
PTG{number}_refDistance = 2.0
PTG{number}_num_paths = 121
PTG{number}_v_max_mps = {speed}
PTG{number}_w_max_dps = {turn}
PTG{number}_score_priority = {priority}
"""
_KINDS = (
    ("CPTG_DiffDrive_C", 1, 1.0, 1.0),
    ("CPTG_DiffDrive_alpha", 1, 1.0, 1.0),
    ("CPTG_DiffDrive_C", 1, 0.4, 0.9),
    ("CPTG_DiffDrive_C", -1, 0.4, 0.5),
)
"""Families of ways: ahead or back (1, -1), share of the speed, priority."""


def settings(options: NavigationOptions, folder: str) -> str:
    """As in MRPT's configuration files; those of its example, but for the robot. `folder`: of its tables."""
    a, b = options.footprint_length / 2.0 + SPARE, options.footprint_width / 2.0 + SPARE
    speed, turn = options.max_linear_velocity, math.degrees(options.max_angular_velocity)
    text = _SETTINGS.format(speed=speed, turn=turn, folder=folder, a=a, b=b, radius=math.hypot(a, b), count=len(_KINDS))
    for number, (kind, k, share, priority) in enumerate(_KINDS):
        text += _PTG.format(number=number, kind=kind, k=k, speed=share * speed, turn=turn, priority=priority)
    return text


@lru_cache(maxsize=None)
def _navigator(options: NavigationOptions, number: int) -> Any:
    """Takes seconds to make: kept for all scenes."""
    import _mrpt_peer as core

    with tempfile.TemporaryDirectory() as folder:
        return core.Navigator(settings(options, folder))


_spent: list[float] = []
_NUMBERS = itertools.cycle(range(MOST_ROBOTS))


class MrptFollower:
    """In the place of `Follower`: MRPT's navigator drives to a point on the way, over and over again."""

    def __init__(self, motion: Motion, *others: Any) -> None:
        self.gained_room = False
        self._motion = motion
        self._options: NavigationOptions = others[-1]
        self._core = _navigator(self._options, next(_NUMBERS))
        self._target = (math.inf, math.inf)
        self._sent_at = -math.inf

    def drop_manoeuvre(self) -> None:
        self._sent_at = -math.inf

    def plan_anew(self) -> None:
        self._sent_at = -math.inf

    def follow(
        self, now: float, way: Plan, pose: Pose, hazards: Hazards, stuck: bool, slack: float = _navigation.SLACK
    ) -> Velocity:
        if now - self._sent_at >= RENEWED or math.dist(pose[:2], self._target) < ALLOWED:
            self._send(now, way, pose)
        obstacles = hazards.obstacles
        near = obstacles[np.hypot(obstacles[:, 0] - pose.x, obstacles[:, 1] - pose.y) < 3.0]
        begun = time.process_time()
        linear, angular, drives = self._core.step(now, pose, self._motion.velocity, near)
        _spent.append(time.process_time() - begun)
        if not drives:
            self._sent_at = -math.inf
        return self._motion.towards((linear, angular))

    def _send(self, now: float, way: Plan, pose: Pose) -> None:
        beyond = (point for point in path(way, pose) if math.dist(point, pose[:2]) > AHEAD)
        self._target, self._sent_at = next(beyond, way.goal), now
        self._core.go(self._target, 0.1, 0.5)


@contextmanager
def driving_with_mrpt() -> Iterator[list[float]]:
    """Lets all navigation of this process drive so; gives the processor time of each step of MRPT's, s."""
    _spent.clear()
    with mock.patch("mr_robot.navigation.engine.Follower", MrptFollower):
        yield _spent
