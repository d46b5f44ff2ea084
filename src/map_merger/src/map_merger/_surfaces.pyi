"""Walls as oriented points (src/cpp). Lengths in metres, transforms as (x, y, yaw)."""

from typing import Sequence

import numpy as np

_Pose = tuple[float, float, float]
_Box = tuple[int, int, int, int]

class Comparison:
    inside: int
    matched: int
    contradicted: int
    minor: float
    mean_square: float
    middle: tuple[float, float]
    information: list[list[float]]

class SurfaceIndex:
    def __init__(self, points: np.ndarray, normals: np.ndarray, normal_weight: float) -> None: ...
    def nearest(self, points: np.ndarray, normals: np.ndarray, bound: float) -> np.ndarray: ...
    def refined(self, points: np.ndarray, normals: np.ndarray, start: _Pose, reaches: Sequence[float]) -> _Pose: ...
    def compare(
        self,
        known: np.ndarray,
        clear: np.ndarray,
        resolution: float,
        origin: _Pose,
        points: np.ndarray,
        normals: np.ndarray,
        solid: np.ndarray,
        transform: _Pose,
        tolerance: float,
    ) -> Comparison: ...

def border(
    obstacles: np.ndarray, free: np.ndarray, resolution: float, origin: _Pose
) -> tuple[np.ndarray, np.ndarray, np.ndarray]: ...
def walls(cells: np.ndarray, smallest: int, largest_mover: float) -> tuple[np.ndarray, np.ndarray]: ...
def without_discs(cells: np.ndarray, places: np.ndarray, radius: float) -> np.ndarray: ...
def raster(
    points: np.ndarray,
    transform: _Pose,
    corner: tuple[float, float],
    cell: float,
    shape: tuple[int, int],
    weight: float,
) -> np.ndarray: ...
def draw(
    cells: np.ndarray,
    to_source: Sequence[float],
    to_target: Sequence[float],
    part: Sequence[int],
    box: Sequence[int],
    all_walls: bool,
) -> np.ndarray: ...
def box_of_true(mask: np.ndarray) -> _Box: ...
def box_of_others(cells: np.ndarray, value: int) -> _Box: ...
def box_of_changes(before: np.ndarray, after: np.ndarray) -> _Box: ...
def write_cells(
    store: np.ndarray,
    stamps: np.ndarray | None,
    top: int,
    left: int,
    cells: np.ndarray,
    stamp: int,
    known_only: bool,
) -> _Box: ...

class GhostRules:
    def __init__(
        self,
        resolution: float,
        body: float,
        touching: float,
        near: float,
        largest: float,
        confirmed: float,
        off: int,
    ) -> None: ...

def weighed(maps: Sequence[np.ndarray], locked: bool, same_wall: int, seen_through: int) -> np.ndarray: ...
def without_ghosts(
    maps: Sequence[np.ndarray], tracks: Sequence[tuple[int, np.ndarray]], box: Sequence[int], rules: GhostRules
) -> list[np.ndarray | None]: ...
def may_be_ghost(cells: np.ndarray, places: np.ndarray, box: Sequence[int], rules: GhostRules) -> bool: ...
def solve_poses(
    first: np.ndarray,
    second: np.ndarray,
    mean: np.ndarray,
    covariance: np.ndarray,
    start: np.ndarray,
    held: np.ndarray,
    steps: int,
    small_step: float,
) -> tuple[np.ndarray, np.ndarray]: ...
def pose_gaps(
    first: np.ndarray,
    second: np.ndarray,
    mean: np.ndarray,
    covariance: np.ndarray,
    in_solution: np.ndarray,
    poses: np.ndarray,
    pose_covariance: np.ndarray,
) -> list[float]: ...
