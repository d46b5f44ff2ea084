"""Where the robot and its laser are, from tf."""

from typing import Any, Dict, Optional, Tuple

import rospy
import tf2_ros

from mr_grid import GridError, Pose
from mr_grid.ros_laser import Mount, mount_value
from mr_robot.navigation.dates import Dates
from mr_robot.ros_poses import frame_name, transform_pose


class TfPoses:
    """The robot's pose is as old as its last odometry; a scan is of another moment, and a robot that turns has moved
    since. What the laser saw is told as seen from where the pose says the robot is."""

    def __init__(self, buffer: Any, frames: Dict[str, str], dates: Dates) -> None:
        """`buffer`: tf2_ros.BufferInterface; `frames`: map_frame, odom_frame, base_frame."""
        self._dates = dates
        self._buffer = buffer
        self._frames = frames
        self._mounts: Dict[str, Mount] = {}

    def robot(self, now: float) -> Optional[Tuple[Pose, rospy.Time]]:
        """The latest pose of the base in the map frame and its time; None where tf has none of the last half second.
        `now`: s."""
        try:
            message = self._buffer.lookup_transform(
                self._frames["map_frame"], self._frames["base_frame"], rospy.Time(0)
            )
        except tf2_ros.TransformException as error:
            rospy.logwarn_throttle(10.0, f"pose of the robot is unknown: {error}")
            return None
        stamp = message.header.stamp
        return (transform_pose(message), stamp) if self.is_recent("pose of the robot", stamp, now) else None

    def is_recent(self, what: str, stamp: rospy.Time, now: float) -> bool:
        recent, complaint = self._dates.look(what, stamp.to_sec(), now)
        if complaint is not None:
            rospy.logwarn_throttle(60.0, complaint)
        return recent

    def laser(self, frame: str, taken: rospy.Time, stamp: rospy.Time) -> Optional[Mount]:
        """Of the laser when it took its scan, in the frame of the base at `stamp`. Without odometry of that moment, or
        any odometry frame: as it is mounted. None where tf does not say that either, or that it
        cannot be used."""
        mount = self._mount(frame)
        if mount is None:
            return None
        base, odometry = self._frames["base_frame"], self._frames["odom_frame"]
        try:
            moved = self._buffer.lookup_transform_full(base, stamp, base, taken, odometry)
        except tf2_ros.TransformException:
            return mount
        return mount._replace(pose=transform_pose(moved).compose(mount.pose))

    def _mount(self, frame: str) -> Optional[Mount]:
        frame = frame_name(frame)
        if frame not in self._mounts:
            try:
                message = self._buffer.lookup_transform(self._frames["base_frame"], frame, rospy.Time(0))
                self._mounts[frame] = mount_value(message)
            except tf2_ros.TransformException as error:
                rospy.logwarn_throttle(10.0, f"place of the laser is unknown: {error}")
                return None
            except GridError as error:
                rospy.logwarn_throttle(10.0, f"scans are ignored: {error}")
                return None
        return self._mounts[frame]
