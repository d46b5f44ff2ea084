"""Core of the world engine (src/cpp/world): raster of walls, ray casting, robots. SI units, angles in radians."""

from typing import Any, Sequence

import numpy as np

_Pose = tuple[float, float, float]
_Pair = tuple[float, float]

class Raster:
    def __init__(
        self, cells: np.ndarray, resolution: float, origin: _Pair, intensities: np.ndarray | None = None
    ) -> None: ...
    def cast(self, origin: _Pair, angles: Any, max_range: float) -> np.ndarray: ...
    def touches(self, a: _Pair, b: _Pair) -> bool: ...

class Ranger:
    def __init__(
        self,
        mount: _Pose,
        range_max: float,
        field_of_view: float,
        samples: int,
        noise_variance: float,
        noise_share: float,
        noise_bearing: float = 0.0,
    ) -> None: ...

class World:
    def __init__(self, obstacles: Raster, visible: Raster, interval: float) -> None: ...
    def add_robot(
        self,
        *,
        start: _Pose,
        footprint: Sequence[Sequence[_Pair]],
        seen: Sequence[Sequence[_Pair]],
        intensities: Sequence[float],
        linear_bounds: _Pair,
        lateral_bounds: _Pair,
        angular_bounds: _Pair,
        localization_origin: _Pose,
        exact_localization: bool,
        bias: _Pose,
        walk: _Pose,
        walk_seed: int,
        base_steps: int,
        command_timeout: float,
        solid: bool,
        noise_seed: int,
        rangers: list[Ranger],
    ) -> int: ...
    def command(self, robot: int, linear: float, lateral: float, angular: float) -> None: ...
    def reset_positions(self) -> None: ...
    def step(self) -> None: ...
    @property
    def time(self) -> float: ...
    @property
    def steps(self) -> int: ...
    def states(self) -> np.ndarray: ...
    def contact_at(self, robot: int, pose: _Pose) -> int: ...
    def scan(self, robot: int, ranger: int) -> np.ndarray: ...
    def scan_with_intensities(self, robot: int, ranger: int) -> tuple[np.ndarray, np.ndarray]: ...
