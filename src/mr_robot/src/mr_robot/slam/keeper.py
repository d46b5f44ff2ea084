"""What of the map outlives the slam node: a file, whose name the master keeps in a parameter of the node."""

import struct
import time
from pathlib import Path
from typing import Callable, Optional

import rospkg
import rospy

from mr_robot.slam.engine import OdometryHistory, Slam, SlamError
from mr_robot.slam.journal import JournalError, MapJournal

PARAMETER = "~memory"
BEGUN = struct.Struct("<qq")  # s and ns


class MapKeeper:
    """Where the parameter is set: goes on with the map of a slam node that has crashed, and writes the map down as it
    grows. An orderly end removes the file."""

    def __init__(self, slam: Slam, odometry: OdometryHistory) -> None:
        self._slam = slam
        self._journal: Optional[MapJournal] = None
        self._begun: Optional[rospy.Time] = None
        former = rospy.get_param(PARAMETER, None)
        if former is None:
            return
        if former:
            self._recall(str(former), odometry)
        if self._journal is None:
            self._create()
        if self._journal is not None:
            slam.begin_journal()
            rospy.on_shutdown(self._remove)

    def begun(self, stamp: rospy.Time) -> rospy.Time:
        """When the map began; `stamp`: of its present state."""
        if self._begun is None:
            self._begun = stamp
        return self._begun

    def keep_map(self) -> None:
        """What has come since."""
        if self._journal is not None:
            self._write(self._journal.add, self._slam.take_journal())

    def keep_place(self) -> None:
        """Where the robot is: to be called before others are told, who would notice if another process said it lay
        elsewhere."""
        if self._journal is not None:
            self._write(self._journal.set_state, self._state())

    def _write(self, write: Callable[[bytes], None], octets: bytes) -> None:
        try:
            write(octets)
        except OSError as error:
            assert self._journal is not None
            where = f"{self._journal.path} ({error.strerror})"
            rospy.logerr(f"the map is no longer kept in {where}: if slam crashes, a new one begins")
            self._remove()

    def _state(self) -> bytes:
        begun = self._begun or rospy.Time()
        return BEGUN.pack(begun.secs, begun.nsecs) + self._slam.state()

    def _recall(self, former: str, odometry: OdometryHistory) -> None:
        since, told = time.monotonic(), "a new map begins: that of before cannot be read"
        try:
            journal = MapJournal.open(Path(former), len(self._state()))
        except (JournalError, OSError) as error:
            rospy.logwarn(f"{told}: {error}")
            return
        try:
            kept = journal.read()
            used = self._slam.recall(kept.entries, kept.state[BEGUN.size :])
            journal.keep_only(used)
        except (SlamError, OSError) as error:
            rospy.logwarn(f"{told}: {error}")
            journal.close()
            return
        if not used:
            rospy.loginfo("a new map begins: there was none before")
            journal.remove()
            return
        secs, nsecs = BEGUN.unpack_from(kept.state)
        self._begun = rospy.Time(secs, nsecs) if secs or nsecs else None
        self._journal = journal
        odometry.resume(self._slam.matched_odometry)
        rospy.logwarn(f"slam goes on with its map, which was drawn again in {time.monotonic() - since:.1f} s")

    def _create(self) -> None:
        folder = Path(rospkg.get_log_dir())
        try:
            self._journal = MapJournal.create(folder, self._state())
            rospy.set_param(PARAMETER, str(self._journal.path))
        except OSError as error:
            rospy.logerr(f"the map cannot be kept in {folder} ({error.strerror}): if slam crashes, a new one begins")

    def _remove(self) -> None:
        journal, self._journal = self._journal, None
        if journal is not None:
            try:
                journal.remove()
            except OSError as error:
                rospy.logwarn(f"{journal.path} stays behind: {error.strerror}")
