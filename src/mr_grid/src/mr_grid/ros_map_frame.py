"""tf as nodes listen to it, and whether the map frame has become another one. Only nodes import this."""

import threading
import xmlrpc.client
from typing import Any, Callable, Dict, Optional, Tuple

import rosgraph
import rospy
import tf2_ros
from geometry_msgs.msg import Pose as PoseMessage

from mr_grid.grid import GridError
from mr_grid.map_frame import MapFrame, NewFrame, Run, run_named
from mr_grid.ros import pose_value

MASTER_FAILED = (OSError, rosgraph.MasterException, xmlrpc.client.Error)
MOST_CONNECTIONS = 100


class FrameListener(tf2_ros.TransformListener):
    """Listens to tf, and calls `begun` when another process than before tells where the robot is in the map frame:
    after tf has it, in the thread in which it came."""

    def __init__(self, buffer: tf2_ros.Buffer, frame: MapFrame, begun: Callable[[NewFrame], None]) -> None:
        self.frame = frame
        self._begun = begun
        self._lock = threading.Lock()
        self._processes: Dict[int, Tuple[Any, str]] = {}
        super().__init__(buffer)

    def callback(self, data: Any) -> None:
        super().callback(data)
        with self._lock:
            new = self._look(data)
        if new is not None:
            self._begun(new)

    def static_callback(self, data: Any) -> None:
        super().static_callback(data)
        with self._lock:
            for transform in data.transforms:
                self.frame.link(*_frames_of(transform))

    def _look(self, data: Any) -> Optional[NewFrame]:
        new = None
        for transform in data.transforms:
            parent, child = _frames_of(transform)
            self.frame.link(parent, child)
            if parent == self.frame.map_frame and self.frame.is_way(child):
                new = self._told(data._connection_header, child, transform) or new
        return new

    def _told(self, connection: Any, child: str, transform: Any) -> Optional[NewFrame]:
        teller = self._process_of(connection)
        try:
            pose = pose_value(PoseMessage(transform.transform.translation, transform.transform.rotation))
        except GridError:
            return None
        return self.frame.take(teller, child, pose, transform.header.stamp.to_sec()) if teller else None

    def _process_of(self, connection: Any) -> str:
        """Names it; empty while that cannot be found out."""
        known = self._processes.get(id(connection))
        if known is not None:
            return known[1]
        node = connection.get("callerid", "")
        try:
            address = str(rosgraph.Master(rospy.get_name()).lookupNode(node))
        except MASTER_FAILED:
            return ""
        if len(self._processes) >= MOST_CONNECTIONS:
            self._processes.clear()
        self._processes[id(connection)] = (connection, f"{node} {address}")  # held, so that no other has its id
        return f"{node} {address}"


def run_of_map(message: Any) -> Optional[Run]:
    """The run that a map names; None where it names none."""
    load_time = message.info.map_load_time
    return run_named((load_time.secs, load_time.nsecs), message.header.stamp.to_sec())


def _frames_of(transform: Any) -> Tuple[str, str]:
    return transform.header.frame_id.lstrip("/"), transform.child_frame_id.lstrip("/")
