"""What one robot's laser and wheels said in a mission, with the truth: to compare SLAM on the same data."""

import math
import os
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import NamedTemporaryFile
from zipfile import BadZipFile

import numpy as np

from mr_grid import Pose
from mr_robot.slam.engine import LaserScan, SlamError

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
        """At once: whoever stops meanwhile, or writes the same log, leaves no part of it there."""
        with NamedTemporaryFile(dir=path.parent, prefix=path.name, delete=False) as partial:
            try:
                np.savez_compressed(partial, **{name: np.asarray(getattr(self, name)) for name in _FIELDS})
            except BaseException:
                os.unlink(partial.name)
                raise
        os.replace(partial.name, path)

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
    """The same drive with wheels that err anew at each step, as under the simulator's `random_walk`: standard
    deviations of the sum after 1 m, in m, and after 1 rad, in rad."""
    random = np.random.default_rng(seed)
    odometry = Pose(0.0, 0.0, 0.0)
    poses = [odometry]
    truth = [Pose(*each) for each in log.truth.tolist()]
    for before, after in zip(truth, truth[1:]):
        step = before.between(after)
        along, around = random.normal(size=2).tolist()
        ahead = step.x + along * distance_error * math.sqrt(abs(step.x))
        odometry = odometry.compose(Pose(ahead, step.y, step.yaw + around * turn_error * math.sqrt(abs(step.yaw))))
        poses.append(odometry)
    return replace(log, odometry=np.array(poses))
