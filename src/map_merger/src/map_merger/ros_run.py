"""The run of the own map on the robot's ROS master, and who makes that map."""

import contextlib
from typing import Any, Optional, Tuple

import rosgraph
import rospy

from mr_grid.map_frame import MapFrame, Run
from mr_grid.ros_map_frame import MASTER_FAILED, run_of_map

from . import kept_run
from .messages import Anchor


class OwnRun:
    """Keeps the run beside the node, and tells when the local map is made by another process than so far. `frame`: that
    of the local map, which tf tells."""

    def __init__(self, robot: str, topic: str, map_frame: str) -> None:
        """`topic`: of the local map; empty: there is none, and nothing is kept."""
        self.frame = MapFrame(map_frame.lstrip("/"))
        self._robot, self._topic = robot, rospy.resolve_name(topic) if topic else ""
        self._parameter = rospy.get_name() + "_run"
        self._source = self._publisher()
        self._connection: Optional[dict] = None
        self._begun: Optional[Run] = None  # when the local map was begun, if it says so, as that of `slam` does
        self._kept: Tuple[int, str] = (-1, "")

    def former(self) -> Optional[Anchor]:
        """The run that the node left when it ended, if the local map has been made by the same process since. One that
        came by way of a relay may be another one all the same: then tf tells."""
        value = rospy.get_param(self._parameter, None)
        anchor = kept_run.anchor_of(value, self._robot, self._source)
        if anchor is not None:
            self.frame = MapFrame(self.frame.map_frame, teller=kept_run.teller_of(value))
        return anchor

    def end(self) -> None:
        """Nobody is to go on with it."""
        with contextlib.suppress(*MASTER_FAILED, KeyError):
            rospy.delete_param(self._parameter)

    def keep(self, anchor: Optional[Anchor]) -> None:
        """To be called again and again."""
        teller = self.frame.teller
        if anchor is None or not self._source or (anchor.updates, teller) == self._kept:
            return
        with contextlib.suppress(*MASTER_FAILED):
            rospy.set_param(self._parameter, kept_run.value_of(anchor, self._source, teller))
            self._kept = (anchor.updates, teller)

    def is_over(self, message: Any) -> bool:
        """Whether a message of the local map comes from another process that does not go on with the map: its frame is
        another one then."""
        begun = message.info.map_load_time.secs, message.info.map_load_time.nsecs
        goes_on = run_of_map(message) is not None and begun == self._begun
        self._begun = begun
        if message._connection_header is self._connection:
            return False
        self._connection = message._connection_header
        before, self._source = self._source, self._publisher() or self._source
        return bool(before) and before != self._source and not goes_on

    def _publisher(self) -> str:
        """Names the process that publishes the local map; empty if that is none, several, or cannot be found out."""
        if not self._topic:
            return ""
        master = rosgraph.Master(rospy.get_name())
        try:
            nodes = [node for name, nodes in master.getSystemState()[0] if name == self._topic for node in nodes]
            return str(master.lookupNode(nodes[0])) if len(nodes) == 1 else ""
        except MASTER_FAILED:
            return ""
