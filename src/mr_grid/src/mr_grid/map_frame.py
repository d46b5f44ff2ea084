"""When the frame of a robot's map is another one than before: SLAM that is started anew may begin it elsewhere.

What tells is tf: another process says where the odometry lies in the map frame. The odometry goes on meanwhile, so the
two frames can be compared."""

import math
from typing import Dict, NamedTuple, Optional, Tuple

from .pose import Pose

SILENCE = 0.5  # s for which the process before has told nothing when another one takes its place
MOST_FRAMES = 1000  # of tf that are remembered
# m, rad between frames that are the same: SLAM goes on with its map, and may have used a scan more.
SAME_PLACE, SAME_TURN = 0.02, 0.01
STAMPED = 1.0  # s from a map's load time to its stamp, below which the former is but a stamp

Run = Tuple[int, int]
"""Names who makes a map, from when on; s and ns."""


class NewFrame(NamedTuple):
    """`shift`: the former map frame in the new one; None where nothing ties them. `until`: s, stamp of what the former
    process told last."""

    shift: Optional[Pose]
    until: float


class Told(NamedTuple):
    """Who told tf where `child` lies in the map frame, and when, s."""

    teller: str
    child: str
    pose: Pose
    stamp: float


class MapFrame:
    """Follows tf from the map frame to the robot. `teller`: names the process that tells where the robot is in it,
    empty until one does."""

    def __init__(self, map_frame: str, base_frame: str = "", teller: str = "") -> None:
        """`base_frame`: of the robot; may be set later. `teller`: of before this process was started, if that is
        known."""
        self.map_frame, self.base_frame = map_frame, base_frame
        self._parents: Dict[str, str] = {}
        self._told = Told(teller, "", Pose(), -SILENCE) if teller else None

    @property
    def teller(self) -> str:
        return "" if self._told is None else self._told.teller

    def link(self, parent: str, child: str) -> None:
        """tf says where a frame is in another one."""
        if child in self._parents or len(self._parents) < MOST_FRAMES:
            self._parents[child] = parent

    def is_way(self, child: str) -> bool:
        """Whether the way from the map frame to the robot begins with that frame."""
        frame = self.base_frame
        for _ in range(len(self._parents)):
            parent = self._parents.get(frame)
            if parent is None or parent == self.map_frame:
                return parent is not None and frame == child
            frame = parent
        return False

    def take(self, teller: str, child: str, pose: Pose, stamp: float) -> Optional[NewFrame]:
        """A process says where the frame on the way to the robot is in the map frame; `stamp`, s. The new frame, if it
        is one."""
        before, told = self._told, Told(teller, child, pose, stamp)
        if before is not None and before.teller != teller:
            if abs(stamp - before.stamp) < SILENCE:
                return None  # two tell: that is for tf to settle
            self._told = told
            shift = self._shift(before, told)
            return None if shift is not None and _is_none(shift) else NewFrame(shift, before.stamp)
        self._told = told
        return None

    def _shift(self, before: Told, told: Told) -> Optional[Pose]:
        """Only where both told the place of one odometry."""
        if before.child != told.child or told.child == self.base_frame:
            return None
        return told.pose.compose(before.pose.inverse())


def _is_none(shift: Pose) -> bool:
    return math.hypot(shift.x, shift.y) <= SAME_PLACE and abs(shift.yaw) <= SAME_TURN


class MapRuns:
    """Tells maps of the present frame from those of the one before, which may still come. Maps of map_merger and of
    `slam` name their run; those of others say nothing, and are taken."""

    def __init__(self) -> None:
        self._run: Optional[Run] = None
        self._since = 0.0
        self._former: Optional[Run] = None

    def begin(self, until: float) -> None:
        """The frame is a new one; `until`: s, to which the former one lasted."""
        if self._run is not None and self._since <= until:
            self._former = self._run

    def take(self, run: Optional[Run], stamp: float) -> bool:
        """Whether a map of that run and stamp, s, is of the present frame."""
        if run is None:
            return True
        if run != self._run:
            self._run, self._since = run, stamp
        return run != self._former


def run_named(load_time: Run, stamp: float) -> Optional[Run]:
    """The run that the load time of a map names; None where it is none, or the same as the map's stamp, s."""
    seconds = load_time[0] + 1e-9 * load_time[1]
    return load_time if seconds > 0.0 and abs(seconds - stamp) > STAMPED else None
