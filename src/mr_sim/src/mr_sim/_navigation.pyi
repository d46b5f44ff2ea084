"""Hot loops of the navigation engine (src/cpp/navigation). SI units, poses as (x, y, yaw)."""

from typing import Sequence

import numpy as np

_Pair = tuple[float, float]
_Pose = tuple[float, float, float]

class Limits:
    linear: float
    reverse: float
    angular: float
    linear_acceleration: float
    angular_acceleration: float
    def __init__(self) -> None: ...

class Footprint:
    half_length: float
    half_width: float
    def __init__(self) -> None: ...

class Horizon:
    duration: float
    step: float
    goal_radius: float
    heading_weight: float
    def __init__(self) -> None: ...

def march(
    slowness: np.ndarray,
    seeds: Sequence[tuple[int, int, float]],
    stop: tuple[int, int] = ...,
    beyond: float = ...,
    limit: float = ...,
) -> np.ndarray: ...
def choose_velocity(
    cost: np.ndarray,
    resolution: float,
    origin: _Pair,
    goal: _Pair,
    pose: _Pose,
    velocity: _Pair,
    obstacles: np.ndarray,
    limits: Limits,
    footprint: Footprint,
    horizon: Horizon,
    period: float,
) -> tuple[bool, float, float, float, float]: ...
def is_clear(
    pose: _Pose,
    velocity: _Pair,
    target: _Pair,
    obstacles: np.ndarray,
    limits: Limits,
    footprint: Footprint,
    horizon: Horizon,
) -> bool: ...
def clearance(pose: _Pose, obstacles: np.ndarray, footprint: Footprint) -> float: ...
