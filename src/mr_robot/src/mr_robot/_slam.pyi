"""Core of the SLAM engine (src/cpp/slam). SI units, poses as (x, y, yaw)."""

import numpy as np

_Pose = tuple[float, float, float]

class SlamOptions:
    resolution: float
    search_window: float
    surface_deviation: float
    match_distance: float
    match_angle: float
    insert_distance: float
    insert_angle: float
    insert_interval: float
    surface_window: float
    free_range: float
    def __init__(self) -> None: ...

class SquareWalls:
    def __init__(self) -> None: ...
    def add(
        self,
        ranges: np.ndarray,
        angle_min: float,
        angle_increment: float,
        range_min: float,
        range_max: float,
        yaw: float,
    ) -> None: ...
    def direction(self) -> float | None: ...

def edges(
    ranges: np.ndarray, mount: _Pose, angle_min: float, angle_increment: float, range_min: float, range_max: float
) -> np.ndarray: ...

class PoseGraph:
    def __init__(self) -> None: ...
    def add(self, pose: _Pose) -> None: ...
    def link_odometry(self, next: int, motion: _Pose, deviation: _Pose) -> None: ...
    def link(self, start: int, to: int, relative: _Pose, information: np.ndarray) -> None: ...
    def see_walls(self, pose: int, heading: float) -> None: ...
    def see_edge(
        self,
        pose: int,
        x: float,
        y: float,
        off_x: float,
        off_y: float,
        normal_x: float,
        normal_y: float,
        deviation: float,
    ) -> None: ...
    def match_edges(self) -> None: ...
    def direction_of_walls(self) -> float | None: ...
    def solve(self, iterations: int = 8) -> bool: ...
    def pose(self, index: int) -> _Pose: ...

class Slam:
    def __init__(self, options: SlamOptions) -> None: ...
    def process(
        self,
        ranges: np.ndarray,
        odometry: _Pose,
        mount: _Pose,
        angle_min: float,
        angle_increment: float,
        range_min: float,
        range_max: float,
        time: float,
        swept: _Pose = ...,
    ) -> tuple[_Pose, bool, bool, float]: ...
    @property
    def reach(self) -> float: ...
    def pose_at(self, odometry: _Pose) -> _Pose: ...
    def map_to_odometry(self) -> _Pose: ...
    def occupancy(self) -> tuple[np.ndarray, int, int]: ...
    def surfaces(self) -> np.ndarray: ...
