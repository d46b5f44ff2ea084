"""Poses and maps in ROS messages. Only nodes and the modules that convert messages for them import this."""

import ast
import math
import re
from io import BytesIO
from typing import Any, Dict

import numpy as np
import rospy
from geometry_msgs.msg import Point, Quaternion
from geometry_msgs.msg import Pose as PoseMessage
from nav_msgs.msg import MapMetaData
from nav_msgs.msg import OccupancyGrid as OccupancyGridMessage
from rospy.exceptions import TransportException
from rospy.numpy_msg import numpy_msg

from mr_grid.grid import GridError, GridInfo, OccupancyGrid, grid_of
from mr_grid.pose import FARTHEST, Pose, is_place

NumpyOccupancyGrid = numpy_msg(OccupancyGridMessage)
CALL_FAILED = (rospy.ServiceException, rospy.ROSException, TransportException, OSError)
"""What a call of a service may raise; the third one where its node ends while the request is being written."""
REFUSED = re.compile(r"service \[\S+\] responded with an error: (b(['\"]).*\2)", re.DOTALL)


def reason_of(error: BaseException) -> str:
    """Why a call has failed; where the service has refused it, in its words alone."""
    refused = REFUSED.fullmatch(str(error))
    return ast.literal_eval(refused[1]).decode(errors="replace") if refused else str(error)


def yaw_of(q: Quaternion) -> float:
    """Heading of a quaternion of any length but 0, rad."""
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), q.w * q.w + q.x * q.x - q.y * q.y - q.z * q.z)


def quaternion(yaw: float) -> Quaternion:
    return Quaternion(0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0))


def pose_value(message: PoseMessage) -> Pose:
    """Planar part. GridError if it is not finite, absurdly far away, or has next to no quaternion."""
    q = message.orientation
    if not is_place(message.position.x, message.position.y, q.x, q.y, q.z, q.w):
        raise GridError(f"a pose with values that are not finite or above {FARTHEST:g}")
    norm = math.sqrt(q.x**2 + q.y**2 + q.z**2 + q.w**2)
    if 0.0 < norm < 1e-6:
        raise GridError("a pose with a quaternion of length 0")
    # Maps often leave the orientation of their origin at all zeros, meaning no rotation.
    return Pose(message.position.x, message.position.y, yaw_of(q) if norm else 0.0)


def pose_message(pose: Pose) -> PoseMessage:
    """Pose in the plane."""
    return PoseMessage(Point(pose.x, pose.y, 0.0), quaternion(pose.yaw))


def info_value(message: MapMetaData) -> GridInfo:
    """Placement of a map. GridError if it cannot be used."""
    return GridInfo(int(message.width), int(message.height), float(message.resolution), pose_value(message.origin))


def info_message(info: GridInfo, stamp: rospy.Time) -> MapMetaData:
    return MapMetaData(stamp, info.resolution, info.width, info.height, pose_message(info.origin))


def grid_value(message: Any) -> OccupancyGrid:
    """From a nav_msgs/OccupancyGrid; of a numpy_msg the data are not copied. GridError if it cannot be used."""
    return grid_of(info_value(message.info), np.asarray(message.data, dtype=np.int8))


def grid_message(grid: OccupancyGrid, frame: str, stamp: rospy.Time) -> OccupancyGridMessage:
    """As message for a publisher of `NumpyOccupancyGrid`."""
    message = NumpyOccupancyGrid()
    message.header.frame_id, message.header.stamp = frame, stamp
    message.info = info_message(grid.info, stamp)
    message.data = np.ascontiguousarray(grid.cells, dtype=np.int8).ravel()
    return message


def typed_fields(message: Any) -> Dict[str, Any]:
    """`type`, `md5sum`, `definition` and `data`: how services that take messages of any type are given one."""
    octets = BytesIO()
    message.serialize(octets)
    kind = {"type": message._type, "md5sum": message._md5sum, "definition": message._full_text}
    return {**kind, "data": octets.getvalue()}
