"""What one robot's laser and wheels said in a mission, with the truth: to compare SLAM on the same data."""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from mr_grid import Pose
from mr_sim.slam.engine import LaserScan, SlamError

CORRELATION = 5.0  # m or rad after which a random walk has forgotten how odometry erred
_FIELDS = ("world", "geometry", "times", "ranges", "odometry", "truth")


@dataclass(frozen=True)
class ScanLog:
    """`world`: name, as `find_world` takes it. `geometry`: float64 (7,), angle_min, angle_increment, range_min,
    range_max and the pose of the laser in the robot. Of n scans: `times` (n,) in s, `ranges` float32 (n, beams) in m,
    `odometry` and `truth` float64 (n, 3), the robot's pose in the odometry frame and in the world frame."""

    world: str
    geometry: np.ndarray
    times: np.ndarray
    ranges: np.ndarray
    odometry: np.ndarray
    truth: np.ndarray

    def scan(self, index: int) -> LaserScan:
        angle_min, increment, low, high, *mount = self.geometry.tolist()
        return LaserScan(self.ranges[index], angle_min, increment, low, high, Pose(*mount))

    def save(self, path: Path) -> None:
        np.savez_compressed(path, **{name: np.asarray(getattr(self, name)) for name in _FIELDS})

    @classmethod
    def load(cls, path: Path) -> "ScanLog":
        """Raises SlamError for a file that is no log of scans."""
        try:
            with np.load(path) as stored:
                values = {name: stored[name] for name in _FIELDS}
        except (OSError, ValueError, KeyError, BadZipFile) as error:
            raise SlamError(f"{path} is no log of scans: {error}") from None
        count = len(values["times"])
        if count < 2 or any(len(values[name]) != count for name in ("ranges", "odometry", "truth")):
            raise SlamError(f"{path} is no log of scans: its arrays differ in length or hold less than 2 scans")
        return cls(str(values.pop("world")), **values)


def with_random_walk(log: ScanLog, distance_error: float, turn_error: float, seed: int) -> ScanLog:
    """The same drive with wheels whose errors wander: shares of distance and turn (standard deviations) by which they
    count wrong, forgotten over `CORRELATION` m or rad."""
    random = np.random.default_rng(seed)
    by_distance, by_turn = random.normal(0.0, distance_error), random.normal(0.0, turn_error)
    poses = [(0.0, 0.0, 0.0)]
    for before, after in zip(log.truth, log.truth[1:]):
        dx, dy, turn = _between(before, after)
        by_distance = _wander(by_distance, distance_error, abs(dx) / CORRELATION, random)
        by_turn = _wander(by_turn, turn_error, abs(turn) / CORRELATION, random)
        x, y, yaw = poses[-1]
        forward = dx * (1.0 + by_distance)
        x, y = x + forward * math.cos(yaw) - dy * math.sin(yaw), y + forward * math.sin(yaw) + dy * math.cos(yaw)
        poses.append((x, y, math.remainder(yaw + turn * (1.0 + by_turn), 2.0 * math.pi)))
    return replace(log, odometry=np.array(poses))


def _wander(value: float, deviation: float, share: float, random: np.random.Generator) -> float:
    """A step of an Ornstein-Uhlenbeck process."""
    return value - value * share + deviation * math.sqrt(2.0 * share) * float(random.normal())


def _between(before: np.ndarray, after: np.ndarray) -> Pose:
    """The second pose seen from the first."""
    x, y = after[0] - before[0], after[1] - before[1]
    cosine, sine = math.cos(before[2]), math.sin(before[2])
    turn = math.remainder(after[2] - before[2], 2.0 * math.pi)
    return Pose(float(cosine * x + sine * y), float(-sine * x + cosine * y), turn)
