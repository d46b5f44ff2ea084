"""Conversion between ROS messages and the values of this package. Nothing else here touches ROS types."""

from dataclasses import replace
from typing import Iterable, Tuple

import numpy as np
import rospy
from adhoc_communication.msg import MmControl, MmListOfPoints, MmMapUpdate, MmPoint, MmRobotPosition
from geometry_msgs.msg import Point, PoseStamped, Quaternion, TransformStamped
from geometry_msgs.msg import Pose as PoseMessage
from nav_msgs.msg import MapMetaData
from nav_msgs.msg import OccupancyGrid as OccupancyGridMessage
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import LaserScan as LaserScanMessage
from visualization_msgs.msg import Marker, MarkerArray

from mr_grid import GridError, GridInfo, OccupancyGrid, Pose, grid_of
from mr_grid.ros import NumpyOccupancyGrid, grid_value, info_message, info_value, pose_message, pose_value
from mr_grid.ros_laser import Mount, mount_value

from .meetings.values import LaserScan
from .messages import USUAL_RESOLUTION_M, Anchor, Boot, Position, Request, Tile
from .whereabouts import Place

NumpyMapUpdate = numpy_msg(MmMapUpdate)


REFUSED_FOR_SIZE = "max_packet_size"
"""Only in the text with which adhoc_communication refuses a message for its size."""


class MessageError(ValueError):
    """A message that cannot be used, with the reason."""


def transform_of_pose(pose: PoseMessage) -> Pose:
    """Planar part of a pose. MessageError if it is not finite, absurdly far away, or has next to no quaternion."""
    try:
        return pose_value(pose)
    except GridError as error:
        raise MessageError(str(error)) from error


def info_of(message: MapMetaData) -> GridInfo:
    """Placement. MessageError if it cannot be used."""
    try:
        return info_value(message)
    except GridError as error:
        raise MessageError(str(error)) from error


def grid_of_message(message: OccupancyGridMessage) -> OccupancyGrid:
    """A map. MessageError if placement and data do not fit."""
    try:
        return grid_value(message)
    except GridError as error:
        raise MessageError(str(error)) from error


def anchor_message(anchor: Anchor) -> OccupancyGridMessage:
    """An anchor: geometry without cells; map_load_time names the run, header.seq counts the updates."""
    message = NumpyOccupancyGrid()
    message.header.frame_id, message.header.seq = anchor.robot, anchor.updates
    message.info = info_message(replace(anchor.info, width=0, height=0), rospy.Time(*anchor.boot))
    message.data = np.empty(0, np.int8)
    return message


def anchor_of(message: OccupancyGridMessage) -> Anchor:
    """Anchor from its announcement. MessageError if it cannot be used."""
    if message.info.width or message.info.height or len(message.data):
        raise MessageError(f"an anchor of {message.header.frame_id!r} with cells")
    return Anchor(message.header.frame_id, info_of(message.info), _boot_of(message.info), message.header.seq)


def tile_message(tile: Tile) -> MmMapUpdate:
    """A tile (contract 2.4): first row in origin.position.x, first column in origin.position.y, in cells; a z of 1 says
    that it is whole."""
    rows, columns = tile.cells.shape
    message = NumpyMapUpdate()
    message.src_robot = tile.robot
    message.update_numbers = np.array(tile.numbers, np.int32)
    message.map.header.frame_id, message.map.header.seq = tile.robot, tile.updates
    message.map.info = MapMetaData(
        rospy.Time(*tile.boot),
        tile.resolution,
        columns,
        rows,
        PoseMessage(Point(float(tile.row), float(tile.column), float(tile.whole)), Quaternion(0.0, 0.0, 0.0, 1.0)),
    )
    message.map.data = np.ascontiguousarray(tile.cells, dtype=np.int8).ravel()
    return message


def tile_of(message: MmMapUpdate) -> Tile:
    """Tile from a map update. MessageError if it cannot be used."""
    robot = message.map.header.frame_id or message.src_robot
    if message.src_robot and message.src_robot != robot:
        raise MessageError(f"a map update of {robot!r} sent by {message.src_robot!r}")
    offset = message.map.info.origin.position
    if not (abs(offset.x) < 2**30 and abs(offset.y) < 2**30):
        raise MessageError(f"a map update of {robot!r} at offset {offset.x:g}, {offset.y:g}")
    resolution = message.map.info.resolution
    try:
        info = GridInfo(message.map.info.width, message.map.info.height, resolution or USUAL_RESOLUTION_M)
        cells = grid_of(info, np.asarray(message.map.data, dtype=np.int8)).cells
    except GridError as error:
        raise MessageError(f"a map update of {robot!r}: {error}") from error
    numbers = tuple(int(number) for number in message.update_numbers)
    return Tile(
        robot,
        numbers,
        round(offset.x),
        round(offset.y),
        cells,
        resolution,
        _boot_of(message.map.info),
        message.map.header.seq,
        offset.z == 1.0,
    )


def request_message(request: Request) -> MmControl:
    """A request for updates."""
    return MmControl(request.robot, list(request.numbers))


def request_of(message: MmControl) -> Request:
    """Request from its message."""
    return Request(message.src_robot, tuple(message.update_numbers))


def position_message(position: Position, frame: str, stamp: rospy.Time) -> MmRobotPosition:
    """A pose in the sender's map frame."""
    message = MmRobotPosition(position.robot, PoseStamped())
    message.position.header.frame_id, message.position.header.stamp = frame, stamp
    message.position.pose = pose_message(position.pose)
    return message


def position_of(message: MmRobotPosition) -> Position:
    """Position from its message. MessageError if the pose is not finite."""
    stamped = message.position
    return Position(message.src_robot, transform_of_pose(stamped.pose), stamped.header.stamp.to_sec())


def points_message(places: Iterable[Place]) -> MmListOfPoints:
    """The other robots' places in the own frame."""
    return MmListOfPoints([MmPoint(place.robot, place.x, place.y) for place in places])


def transform_messages(transforms: Iterable[Tuple[str, Pose]], frame: str, stamp: rospy.Time) -> list:
    """tf2 messages `frame` -> given child frames."""
    messages = []
    for child, transform in transforms:
        message = TransformStamped()
        message.header.frame_id, message.header.stamp, message.child_frame_id = frame, stamp, child
        message.transform.translation.x, message.transform.translation.y = transform.x, transform.y
        message.transform.rotation = pose_message(transform).orientation
        messages.append(message)
    return messages


def transform_of_message(message: TransformStamped) -> Pose:
    """Planar part of a tf2 transform."""
    return transform_of_pose(PoseMessage(message.transform.translation, message.transform.rotation))


def track_message(points: np.ndarray, frame: str, stamp: rospy.Time) -> MarkerArray:
    """Places (n, 2) in metres as spheres of 0.2 m."""
    marker = Marker(type=Marker.SPHERE_LIST, action=Marker.ADD, ns="positions")
    marker.header.frame_id, marker.header.stamp = frame, stamp
    marker.scale.x = marker.scale.y = marker.scale.z = 0.2
    marker.color.g = marker.color.a = 1.0
    marker.pose.orientation.w = 1.0
    marker.points = [Point(float(x), float(y), 0.0) for x, y in points]
    return MarkerArray([marker])


def _boot_of(info: MapMetaData) -> Boot:
    return info.map_load_time.secs, info.map_load_time.nsecs


def mount_of(message: TransformStamped) -> Mount:
    """How the sensor is mounted, from the robot's frame to the sensor's. MessageError if it cannot be used so."""
    try:
        return mount_value(message)
    except GridError as error:
        raise MessageError(str(error)) from error


def scan_of(message: LaserScanMessage, mount: Mount) -> LaserScan:
    """A scan. MessageError if its geometry cannot be used."""
    ranges = np.array(message.ranges, np.float32)
    geometry = (*mount.beams(message), message.range_min, message.range_max)
    try:
        return LaserScan(ranges, *geometry, mount.pose)
    except ValueError as error:
        raise MessageError(str(error)) from error
