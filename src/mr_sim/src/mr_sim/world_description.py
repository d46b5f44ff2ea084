"""What a world file says, as values. SI units: metres, radians, seconds."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mr_grid import Pose
from mr_robot.platforms.platform import looks_ahead
from mr_sim.bodies import Polygon

FEWEST_BEAMS = 3  # of a scan that SLAM and navigation can use
MAX_CELLS = 100_000_000  # of a world
ENOUGH_CELLS = 80_000_000  # beyond so many a world file's world is drawn coarser


@dataclass(frozen=True)
class RangerDescription:
    """A laser range finder: first and last beam lie at the ends of its field of view, counter-clockwise."""

    mount: Pose  # in the robot's frame
    range_min: float
    range_max: float
    field_of_view: float
    samples: int
    update_interval: float
    noise_variance: float  # m^2; Stage uses the first number of `noise` as a variance
    noise_share: float = 0.0  # of the range: the second number, by which a reading errs at most, evenly spread
    noise_bearing: float = 0.0  # the third in rad: a share of the angle between beams, half of which a beam may err

    @property
    def angle_increment(self) -> float:
        return self.field_of_view / (self.samples - 1) if self.samples > 1 else 0.0

    @property
    def looks_ahead(self) -> bool:
        return looks_ahead(self.mount.yaw, self.field_of_view)

    @property
    def angle_min(self) -> float:
        return -self.field_of_view / 2.0 if self.samples > 1 else 0.0


@dataclass(frozen=True)
class RobotDescription:
    """A `position` model with its rangers."""

    name: str
    start: Pose  # world frame
    footprint: tuple[Polygon, ...]  # robot's frame
    seen: tuple[Polygon, ...]  # of these, what lasers of others see
    ranger_returns: tuple[float, ...]  # of these: intensity of the echo
    linear_bounds: tuple[float, float]
    lateral_bounds: tuple[float, float]  # to the left; both 0 but for drive "omni"
    angular_bounds: tuple[float, float]
    exact_localization: bool  # localization "gps"
    localization_origin: Pose  # world frame
    odom_error: tuple[float, float, float, float]  # shares along x, y, z and of the turn
    update_interval: float
    solid: bool
    rangers: tuple[RangerDescription, ...]

    @property
    def main_ranger(self) -> int:
        """Index of that by which the robot finds its way: of the scanners that look ahead, else of all rangers, the one
        with most beams, the first of them."""

        def rank(index: int) -> tuple[bool, int]:
            ranger = self.rangers[index]
            return ranger.samples >= FEWEST_BEAMS and ranger.looks_ahead, ranger.samples

        return max(range(len(self.rangers)), key=rank, default=0)


@dataclass(frozen=True)
class Obstacle:
    """A thing that does not move: polygons or a bitmap, fitted into the rectangle `size` centred at `pose`."""

    pose: Pose  # world frame, of the body's centre
    size: tuple[float, float]
    polygons: tuple[Polygon, ...]  # in the body's frame
    bitmap: Path | None
    boundary: bool
    visible: bool
    solid: bool
    ranger_return: float = 1.0  # intensity of the echo

    def spans(self, x: float, y: float) -> bool:
        """Whether its rectangle holds that place of the world."""
        x, y = self.pose.inverse().apply_point(x, y)
        return abs(x) <= self.size[0] / 2.0 and abs(y) <= self.size[1] / 2.0


@dataclass(frozen=True)
class WorldDescription:
    """All that a world file says and the simulator uses."""

    path: Path
    resolution: float
    interval: float  # simulated seconds per step
    speedup: float  # real-time factor; <= 0: as fast as possible
    quit_time: float | None  # simulated seconds
    obstacles: tuple[Obstacle, ...]
    robots: tuple[RobotDescription, ...]
    warning: str = ""  # one line: what the file says without effect here


def bounds_of(obstacles: Sequence[Obstacle]) -> tuple[float, float, float, float]:
    """Least x and y, greatest x and y in m."""
    points: list[tuple[float, float]] = [(0.0, 0.0)] if not obstacles else []
    for obstacle in obstacles:
        half_x, half_y = obstacle.size[0] / 2.0, obstacle.size[1] / 2.0
        for corner in ((-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y)):
            points.append(obstacle.pose.apply_point(*corner))
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    return min(xs), min(ys), max(xs), max(ys)


def fitting_resolution(obstacles: Sequence[Obstacle], resolution: float) -> float:
    """m; a coarser one where the world would have too many cells, in tenths of its order of magnitude."""
    left, low, right, high = bounds_of(obstacles)
    width, height = right - left, high - low
    # Two cells more each way, for what begins and ends within one.
    if (width / resolution + 2.0) * (height / resolution + 2.0) <= ENOUGH_CELLS:
        return resolution
    half = (width + height) / (ENOUGH_CELLS - 4.0)
    least = half + math.sqrt(half**2 + width * height / (ENOUGH_CELLS - 4.0))
    unit = 10.0 ** (math.floor(math.log10(least)) - 1)
    return round(math.ceil(least / unit) * unit, 9)
