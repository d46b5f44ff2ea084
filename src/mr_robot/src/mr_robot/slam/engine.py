"""Local SLAM of one robot: odometry and scans in, pose and map out.

Pure and deterministic: no clock, no randomness, no ROS. The map is an occupancy grid; poses come from matching
scans to the surfaces in it (point-to-line, Gauss-Newton), with odometry where scan and wheels agree and without it
where they do not. The hot loops are C++ (`mr_robot._slam`).
"""

import math
from bisect import bisect_left
from collections import deque
from dataclasses import asdict, dataclass
from typing import Deque, Optional, Tuple

import numpy as np

from mr_grid import IDENTITY, OccupancyGrid, Pose
from mr_robot import _slam
from mr_robot.slam.options import SlamError, SlamOptions

ODOMETRY_TIME = 3.0  # s of it that are kept, and
LEAST_ODOMETRY, MOST_ODOMETRY = 100, 4000  # messages whatever their rate
OUT_OF_ORDER = 1.0  # s by which a message may come too late; one that is older yet is of a clock that was set back
FASTEST, FASTEST_TURN = 5.0, 10.0  # m/s, rad/s: odometry that says more has jumped
SHORTEST_STEP, LONGEST_STEP = 0.1, 1.0  # s that a step counts at least, for stamps jitter, and at most
ELSEWHERE = 1000.0  # m from the last pose that no robot is when the clock was set back
BEGUN_ANEW = 0.05  # m or rad to exactly 0, from which on it is the driver that begins
MAP_UPDATE_INTERVAL = 2.0  # s between maps that are handed out


@dataclass(frozen=True)
class LaserScan:
    """`ranges`: float32 (n,), metres, NaN or below `range_min` = invalid, `range_max` or above = nothing there."""

    ranges: np.ndarray
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    mount: Pose  # laser in the robot's frame
    swept: Pose = IDENTITY  # robot at the last beam, by odometry, seen from where it was at the first


@dataclass(frozen=True)
class SlamUpdate:
    pose: Pose  # robot in the map frame, at the time of the scan
    matched: bool  # whether the scan confirmed it; otherwise odometry alone
    inserted: bool  # whether the map that is handed out changed
    share: float  # of the scan that lies on known surfaces
    beyond: float = 0.0  # m to the farthest thing that was too far away to be drawn; 0: there is none


class OdometryHistory:
    """Recent odometry, to know where the wheels say the robot was at the time of a scan. Bounded.

    A driver that is started again begins at 0 again. What jumps is no motion: it goes on from where it was, and
    `offset` says where the driver's frame lies in that of this history.
    """

    def __init__(self) -> None:
        self.offset = IDENTITY
        self._times: Deque[float] = deque(maxlen=MOST_ODOMETRY)
        self._poses: Deque[Pose] = deque(maxlen=MOST_ODOMETRY)
        self._resumed: Optional[Pose] = None

    def resume(self, pose: Pose) -> None:
        """Goes on from where the robot was by a history of before; only before anything is added."""
        self._resumed = pose

    def add(self, time: float, pose: Pose) -> bool:
        """Whether the driver's `pose` follows from the one before; if not it has jumped. What is out of order is of no
        use; a time long before the last one (the clock was set back) starts the history anew. SlamError for what is not
        finite."""
        if not np.isfinite((time, *pose)).all():
            raise SlamError("odometry is not finite: mend its driver")
        if self._resumed is not None:
            self._times.append(time - LONGEST_STEP)
            self._poses.append(self._resumed)
            self._resumed = None
        last = self._poses[-1] if self._poses else None
        if self._times and time <= self._times[-1]:
            if time >= self._times[-1] - OUT_OF_ORDER:
                return True
            self._times.clear()
            self._poses.clear()
        follows = self._follows(time, pose) if self._times else last is None or self._is_near(last, pose)
        if last is not None and not follows:
            self.offset = last.compose(pose.inverse())
        self._times.append(time)
        self._poses.append(self.offset.compose(pose))
        while len(self._times) > LEAST_ODOMETRY and time - self._times[0] > ODOMETRY_TIME:
            self._times.popleft()
            self._poses.popleft()
        return follows

    def _is_near(self, last: Pose, pose: Pose) -> bool:
        """Whether the driver's `pose` is no other place altogether, however long it took to get there."""
        return math.dist(self.offset.compose(pose)[:2], last[:2]) < ELSEWHERE

    def _follows(self, time: float, pose: Pose) -> bool:
        motion = self.offset.inverse().compose(self._poses[-1]).between(pose)
        way, turn = math.hypot(motion.x, motion.y), abs(motion.yaw)
        # From anywhere else exactly to 0 goes no robot, but a driver that begins; it may have taken its time.
        if pose == IDENTITY and (way > BEGUN_ANEW or turn > BEGUN_ANEW):
            return False
        seconds = min(max(time - self._times[-1], SHORTEST_STEP), LONGEST_STEP)
        return way <= FASTEST * seconds and turn <= FASTEST_TURN * seconds

    def newest(self) -> Optional[Tuple[float, Pose]]:
        return (self._times[-1], self._poses[-1]) if self._times else None

    def at(self, time: float) -> Optional[Pose]:
        """None when the history does not reach `time` on both sides."""
        index = bisect_left(self._times, time)
        if index == len(self._times):
            return None
        if self._times[index] == time:
            return self._poses[index]
        if index == 0:
            return None
        before, after = self._times[index - 1], self._times[index]
        return self._poses[index - 1].interpolate(self._poses[index], (time - before) / (after - before))


class Slam:
    def __init__(self, options: SlamOptions) -> None:
        self.options = options
        self._core = self._new_core()
        self.revision = 0  # counts changes of the map

    def _new_core(self) -> _slam.Slam:
        return _slam.Slam(_slam.SlamOptions(**asdict(self.options)))

    def process(self, scan: LaserScan, odometry: Pose, time: float) -> SlamUpdate:
        """`odometry`: robot in the odometry frame at the first beam. `time`: s, of that; only differences
        count. Raises SlamError for unusable input."""
        ranges = np.ascontiguousarray(scan.ranges, dtype=np.float32)
        if ranges.ndim != 1 or ranges.size < 3:
            raise SlamError(f"a scan needs at least 3 ranges, not {ranges.size}")
        if not (0.0 < scan.range_max < 1000.0):
            raise SlamError(f"range_max of the scan must lie between 0 and 1000 m, not {scan.range_max!r}")
        numbers = (*odometry, *scan.mount, *scan.swept, scan.angle_min, scan.angle_increment, scan.range_min, time)
        if not all(map(math.isfinite, numbers)):
            raise SlamError("odometry, time or geometry of the scan is not finite")
        pose, matched, inserted, share = self._core.process(
            ranges, odometry, scan.mount, scan.angle_min, scan.angle_increment, scan.range_min, scan.range_max, time,
            scan.swept,
        )  # fmt: skip
        self.revision += inserted
        return SlamUpdate(Pose(*pose), matched, inserted, share, self._beyond(ranges, scan.range_max))

    @property
    def reach(self) -> float:
        """m from the laser, from which on what is hit counts as nothing: 1600 cells."""
        return float(self._core.reach)

    def _beyond(self, ranges: np.ndarray, range_max: float) -> float:
        if range_max <= self.reach:
            return 0.0
        return float(ranges[(ranges >= self.reach) & (ranges < range_max)].max(initial=0.0))

    def pose_at(self, odometry: Pose) -> Pose:
        """Robot in the map frame when its odometry says `odometry`."""
        return Pose(*self._core.pose_at(odometry))

    def map_to_odometry(self) -> Pose:
        """Odometry frame in the map frame."""
        return Pose(*self._core.map_to_odometry())

    def begin_journal(self) -> None:
        """From now on what has to be kept of the map is written down, for `take_journal`."""
        self._core.begin_journal()

    def take_journal(self) -> bytes:
        """What is to be kept of the map, and came since this was last called."""
        return self._core.take_journal()

    def state(self) -> bytes:
        """Where the robot is, and what odometry is worth; always of one size."""
        return self._core.state()

    def recall(self, journal: bytes, state: bytes) -> int:
        """Goes on with a map of before, in its frame, if all of that can be read. Only before the first scan. Returns
        how much of the journal can be read; 0: none, and the map begins anew. SlamError: likewise, for it makes no
        sense."""
        try:
            used = self._core.recall(journal, state)
        except (MemoryError, ValueError) as error:
            self._core = self._new_core()
            raise SlamError(f"what was kept of the map cannot be drawn: {error}") from error
        self.revision += used > 0
        return used

    @property
    def matched_odometry(self) -> Pose:
        """Robot in the odometry frame when a scan was last matched."""
        return Pose(*self._core.odometry)

    def map(self) -> OccupancyGrid:
        """The pose at the start is (0, 0, 0), and the origin a multiple of the resolution away from it, not turned: a
        growing map keeps its lattice."""
        cells, column, row = self._core.occupancy()
        resolution = self.options.resolution
        return OccupancyGrid.of(cells, resolution, Pose(column * resolution, row * resolution))
