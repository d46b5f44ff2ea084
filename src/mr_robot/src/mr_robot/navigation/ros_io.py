"""ROS messages to and from the navigation engine's values."""

import math
from typing import Any, List, Sequence, Tuple

import rospy
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import MoveBaseFeedback
from nav_msgs.msg import Path

from mr_grid import GridError, OccupancyGrid, Pose, ros
from mr_grid.ros import quaternion, yaw_of
from mr_grid.ros_laser import Mount
from mr_robot.navigation.options import NavigationError, Scan, make_scan


def goal_value(message: PoseStamped) -> Pose:
    """Raises NavigationError for a quaternion that is no rotation or numbers that are not finite."""
    q, position = message.pose.orientation, message.pose.position
    norm = math.sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w)
    if not abs(norm - 1.0) < 0.1:
        raise NavigationError(f"orientation of the goal is no rotation (norm {norm:.3f}): set orientation.w to 1")
    goal = Pose(position.x, position.y, yaw_of(q))
    if not all(math.isfinite(value) for value in goal):
        raise NavigationError("goal has coordinates that are not finite")
    return goal


def grid_value(message: Any) -> OccupancyGrid:
    """`message`: OccupancyGrid whose data may be an array. Raises NavigationError for one that cannot be used."""
    try:
        return ros.grid_value(message)
    except GridError as error:
        raise NavigationError(f"map cannot be used: {error}") from error


def scan_value(message: Any, mount: Mount) -> Scan:
    return make_scan(message.ranges, *mount.beams(message), message.range_min, message.range_max, mount.pose)


def pose_message(pose: Sequence[float], frame: str, stamp: rospy.Time) -> PoseStamped:
    message = PoseStamped()
    message.header.frame_id = frame
    message.header.stamp = stamp
    message.pose.position.x, message.pose.position.y = pose[0], pose[1]
    message.pose.orientation = quaternion(pose[2])
    return message


def feedback_message(pose: Pose, frame: str, stamp: rospy.Time) -> MoveBaseFeedback:
    return MoveBaseFeedback(base_position=pose_message(pose, frame, stamp))


def path_message(points: List[Tuple[float, float]], frame: str, stamp: rospy.Time) -> Path:
    message = Path()
    message.header.frame_id = frame
    message.header.stamp = stamp
    message.poses = [pose_message((x, y, 0.0), frame, stamp) for x, y in points[::4] + points[-1:]]
    return message
