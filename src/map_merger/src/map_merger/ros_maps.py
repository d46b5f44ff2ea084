"""Publishers of the contract: the merged map and the other robots in it."""

import re
from typing import Dict, Optional

import rospy
import tf2_ros
from adhoc_communication.msg import MmListOfPoints
from visualization_msgs.msg import MarkerArray

from mr_grid import GridInfo
from mr_grid.ros import NumpyOccupancyGrid, grid_message

from . import ros_io
from .effects import BroadcastTransforms, PublishMap, PublishPositions, PublishTrack
from .ros_outputs import Outputs, dated_ahead


class Maps:
    """Publishes each effect at once, in the own map frame."""

    def __init__(self, frame: str, prefix: str, outputs: Outputs) -> None:
        """`frame`: the own map frame. `prefix`: of the names of the network, empty or ending in a slash. `outputs` show
        which part of the map has changed."""
        self._frame, self._prefix, self._outputs = frame, prefix, outputs
        self._global = rospy.Publisher("~global_map", NumpyOccupancyGrid, queue_size=3, latch=True)
        self._shown: Optional[GridInfo] = None
        self._positions = rospy.Publisher(f"{prefix}all_positions", MmListOfPoints, queue_size=3)
        self._tracks: Dict[str, rospy.Publisher] = {}
        self._broadcaster = tf2_ros.TransformBroadcaster()

    def publish_map(self, effect: PublishMap, stamp: rospy.Time) -> None:
        """The whole map, and the part that changed where its size is that of the one before."""
        message = grid_message(effect.grid, self._frame, stamp)
        message.info.map_load_time = rospy.Time(*effect.boot)
        self._global.publish(message)
        if effect.grid.info == self._shown:
            self._outputs.show_update(effect.grid, effect.changed, stamp)
        self._shown = effect.grid.info

    def publish_positions(self, effect: PublishPositions) -> None:
        """All at once."""
        self._positions.publish(ros_io.points_message(effect.places))

    def publish_track(self, effect: PublishTrack, stamp: rospy.Time) -> None:
        """On a topic of the robot's own, while somebody looks."""
        if effect.robot not in self._tracks:
            name = "~position_" + re.sub(r"[^A-Za-z0-9_]", "_", effect.robot)
            self._tracks[effect.robot] = rospy.Publisher(name, MarkerArray, queue_size=3, latch=True)
        publisher = self._tracks[effect.robot]
        if publisher.get_num_connections():
            publisher.publish(ros_io.track_message(effect.points, self._frame, stamp))

    def broadcast(self, effect: BroadcastTransforms, stamp: rospy.Time) -> None:
        """To tf, dated a little ahead."""
        children = [(self._child_frame(robot), transform) for robot, transform in effect.transforms]
        messages = ros_io.transform_messages(children, self._frame.lstrip("/"), dated_ahead(stamp))
        self._broadcaster.sendTransform(messages)

    def _child_frame(self, robot: str) -> str:
        """Under one master the other robots' own map frames are roots of their trees, so copies are broadcast."""
        own = self._prefix.strip("/")
        return f"{own}/{robot}/map" if own else f"{robot}/map"
