"""What goes out by which service of adhoc_communication, and what comes in on which topic."""

from typing import Any, Callable, Dict, NamedTuple

import rospy
from adhoc_communication.msg import MmControl, MmRobotPosition

from map_merger.msg import RobotTrack, TransformEdges
from mr_grid.ros import NumpyOccupancyGrid

from .graph.edges import EdgeReport
from .meetings.values import TrackReport
from .messages import Anchor, Request, Tile
from .options import Options
from .payload import Payload
from .ros_io import (
    NumpyMapUpdate,
    anchor_message,
    anchor_of,
    position_message,
    position_of,
    request_message,
    request_of,
    tile_message,
    tile_of,
)
from .ros_team import edges_message, edges_of, robot_track_message, track_report_of

SEND_TYPED = "send_message"
"""The service that sends messages of any type."""
TRACK_TOPIC = "map_merger/robot_track"
EDGES_TOPIC = "map_merger/transform_edges"


class RadioCall(NamedTuple):
    """A call of one of adhoc_communication's send services."""

    service: str
    topic: str
    message: Any


def radio_call(payload: Payload, options: Options, stamp: rospy.Time) -> RadioCall:
    """How a payload goes to another robot or a group."""
    if isinstance(payload, Tile):
        return RadioCall("send_map_update", options.map_topic_over_network, tile_message(payload))
    if isinstance(payload, Anchor):
        return RadioCall("send_map", options.meta_topic_over_network, anchor_message(payload))
    if isinstance(payload, Request):
        return RadioCall("send_control_message", options.control_topic, request_message(payload))
    if isinstance(payload, TrackReport):
        return RadioCall(SEND_TYPED, TRACK_TOPIC, robot_track_message(payload))
    if isinstance(payload, EdgeReport):
        return RadioCall(SEND_TYPED, EDGES_TOPIC, edges_message(payload))
    message = position_message(payload, options.local_map_frame_id, stamp)
    return RadioCall("send_position", options.position_other_robots_topic, message)


class Incoming(NamedTuple):
    """What arrives on a topic: its message type, and the conversion to a payload, which `delivery.take` hands on."""

    kind: type
    value_of: Callable[[Any], Payload]


def incoming(options: Options) -> Dict[str, Incoming]:
    """Everything that other robots send, by topic."""
    topics = {
        options.map_topic_over_network: Incoming(NumpyMapUpdate, tile_of),
        options.meta_topic_over_network: Incoming(NumpyOccupancyGrid, anchor_of),
        options.control_topic: Incoming(MmControl, request_of),
        TRACK_TOPIC: Incoming(RobotTrack, track_report_of),
        EDGES_TOPIC: Incoming(TransformEdges, edges_of),
    }
    if options.exchange_position:
        topics[options.position_other_robots_topic] = Incoming(MmRobotPosition, position_of)
    return topics
