"""Conversion between this package's own messages to other robots and their values."""

import math

import numpy as np
import rospy

from map_merger.msg import RobotTrack, TransformEdge, TransformEdges
from mr_grid import Pose, normalized

from .covariance import as_covariance
from .graph.edges import MOST_EDGES, Edge, EdgeReport
from .meetings.values import Sensor, ToldObject, TrackReport
from .messages import Boot
from .ros_io import MessageError

_MM = 1000.0
_YAW_STEPS = 32768.0 / math.pi
_FARTHEST_MM = 32767


def robot_track_message(report: TrackReport) -> RobotTrack:
    """A track in whole milliseconds and millimetres; places farther than 32 m from the latest pose are left out."""
    origin = report.poses[-1, 1:3] if len(report.poses) else np.zeros(2)
    message = RobotTrack(robot=report.robot, boot=rospy.Time(*report.boot), uptime=report.uptime)
    message.body_radius, message.unplaced = report.body_radius, list(report.unplaced)
    message.view, message.nearest, message.farthest = report.sensor
    message.origin_x, message.origin_y = origin.tolist()
    parts = [_near(report.poses, origin)]
    message.yaw = np.round(parts[0][:, 3] * _YAW_STEPS).astype(np.int64).astype(np.int16).tolist()
    parts += [_near(each.samples, origin) for each in report.objects]
    message.objects = [each.number % 2**32 for each in report.objects]
    message.places = [len(part) for part in parts[1:]]
    rows = np.concatenate([part[:, :3] for part in parts])
    message.ages = np.clip(np.round(rows[:, 0] * 1000.0), 0, 65535).astype(int).tolist()
    message.x, message.y = (np.round((rows[:, 1:3] - origin) * _MM).astype(int).T).tolist()
    return message


def _near(rows: np.ndarray, origin: np.ndarray) -> np.ndarray:
    return rows[(np.abs(rows[:, 1:3] - origin) * _MM < _FARTHEST_MM).all(axis=1)]


def track_report_of(message: RobotTrack) -> TrackReport:
    """Track from its message. MessageError if it cannot be used."""
    count, lengths = len(message.yaw), list(message.places)
    if len({len(message.ages), len(message.x), len(message.y), count + sum(lengths)}) != 1:
        raise MessageError(f"a track of {message.robot!r} with lists of different lengths")
    if len(lengths) != len(message.objects):
        raise MessageError(f"a track of {message.robot!r} with {len(message.objects)} objects in {len(lengths)} parts")
    rows = np.column_stack(
        [
            np.array(message.ages, float) / 1000.0,
            np.array(message.x, float) / _MM + message.origin_x,
            np.array(message.y, float) / _MM + message.origin_y,
        ]
    )
    parts = np.split(rows[count:], np.cumsum(lengths)[:-1]) if lengths else []
    try:
        return TrackReport(
            message.robot,
            message.body_radius,
            (message.boot.secs, message.boot.nsecs),
            message.uptime,
            Sensor(message.view, message.nearest, message.farthest),
            np.column_stack([rows[:count], np.array(message.yaw, float) / _YAW_STEPS]),
            tuple(ToldObject(number, part) for number, part in zip(message.objects, parts)),
            tuple(message.unplaced),
        )
    except ValueError as error:
        raise MessageError(str(error)) from error


def edges_message(report: EdgeReport) -> TransformEdges:
    """A robot's own edges."""
    return TransformEdges(report.robot, rospy.Time(*report.boot), [_edge_message(edge) for edge in report.edges])


def edges_of(message: TransformEdges) -> EdgeReport:
    """Edges as told, not yet checked (graph.edges.check). MessageError for a yaw that cannot be an angle."""
    boot = message.boot.secs, message.boot.nsecs
    edges = tuple(_edge_of(message.robot, boot, edge) for edge in message.edges[: MOST_EDGES + 1])
    return EdgeReport(message.robot, boot, edges)


def _edge_message(edge: Edge) -> TransformEdge:
    covariance = [value for row in edge.covariance for value in row]
    boot = rospy.Time(*edge.target_run)
    return TransformEdge(edge.target, boot, *edge.transform, covariance, edge.shared_wall, edge.met, edge.age)


def _edge_of(robot: str, boot: Boot, message: TransformEdge) -> Edge:
    if not math.isfinite(message.yaw):
        raise MessageError(f"a transform {robot} - {message.target} with a yaw that is not finite")
    return Edge(
        robot,
        message.target,
        boot,
        (message.target_boot.secs, message.target_boot.nsecs),
        Pose(message.x, message.y, normalized(message.yaw)),
        as_covariance(np.array(message.covariance).reshape(3, 3)),
        message.shared_wall,
        message.met,
        message.age,
    )
