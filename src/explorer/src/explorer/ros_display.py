"""What the node tells people and programs: its publishers, and how often each speaks."""

import io
from typing import Any, Optional

import rospy
from adhoc_communication.msg import ExpAuction
from geometry_msgs.msg import PointStamped
from nav_msgs.msg import GridCells
from visualization_msgs.msg import MarkerArray

from explorer import ros_io
from explorer.msg import ExplorationState, ExplorationStatus
from explorer.names import CLUSTER_GRIDS, Names
from explorer.report import Report
from explorer.ros_markers import FrontierMarkers
from explorer.status import Picture
from mr_grid import Pose

STATE_PERIOD = 1.0  # s of ROS time after which an unchanged ~state is repeated
STATUS_PERIOD = 1.0  # s of ROS time between two messages on ~status
PICTURE_PERIOD = 2.0  # s of ROS time between two updates of the visualisation

TYPES = {
    "state": ExplorationState,
    "status": ExplorationStatus,
    "auctions": ExpAuction,
    "frontiers": MarkerArray,
    "visited": MarkerArray,
    "goal": PointStamped,
    "home": PointStamped,
    "goal_unused": PointStamped,
}


class Display:
    """Times `now` are s of ROS time; a clock that jumps back counts as time that has passed."""

    def __init__(self, names: Names, frame: str) -> None:
        """`frame`: of the map."""
        self._frame = frame
        self._markers = FrontierMarkers(frame)
        self._publishers = {
            key: rospy.Publisher(name, TYPES.get(key, GridCells), latch=key != "auctions", queue_size=10)
            for key, name in names.published.items()
        }
        self._state_sent: Any = None
        self._state_time = 0.0
        self._status_sent = b""
        self._status_time = -STATUS_PERIOD
        self._home_sent = False
        self._drawn = 0
        self._draw_time = -PICTURE_PERIOD

    def auction(self, message: ExpAuction) -> None:
        """One that is sent."""
        self._publishers["auctions"].publish(message)

    def goal(self, pose: Pose, stamp: rospy.Time) -> None:
        """The one on its way from now on."""
        self._publishers["goal"].publish(ros_io.point_to(pose.x, pose.y, self._frame, stamp))

    def state(self, message: ExplorationState, now: float) -> None:
        """When it has changed, and once in a while."""
        essence = (message.state, message.exploration_finished, message.has_goal)
        if essence != self._state_sent or abs(now - self._state_time) >= STATE_PERIOD:
            self._state_sent, self._state_time = essence, now
            self._publishers["state"].publish(message)

    def status_is_due(self, now: float) -> bool:
        """Whether to ask for a report for `status`."""
        return abs(now - self._status_time) >= STATUS_PERIOD

    def status(self, report: Report, now: float) -> None:
        """What is explored and why, when it has changed."""
        self._status_time = now
        message = ros_io.status_to(report, self._frame)
        content = io.BytesIO()
        message.serialize(content)  # NaN differs from itself, its bytes do not
        if content.getvalue() != self._status_sent:
            self._status_sent = content.getvalue()
            message.header.stamp = rospy.Time.from_sec(now)
            self._publishers["status"].publish(message)

    def forget_home(self) -> None:
        """It is somewhere else in the map, and shown anew."""
        self._home_sent = False

    def home(self, place: Optional[Pose], stamp: rospy.Time) -> None:
        """Once it is known."""
        if place is not None and not self._home_sent:
            self._home_sent = True
            self._publishers["home"].publish(ros_io.point_to(place.x, place.y, self._frame, stamp))

    def picture_is_due(self, revision: int, now: float) -> bool:
        """Whether to ask for a picture for `draw`. `revision`: of what is to be seen in it."""
        return revision != self._drawn and abs(now - self._draw_time) >= PICTURE_PERIOD

    def draw(self, picture: Picture, revision: int, now: float, stamp: rospy.Time) -> None:
        """Frontiers, visited ones and clusters."""
        self._drawn, self._draw_time = revision, now
        self._publishers["frontiers"].publish(self._markers.frontiers(picture, stamp))
        self._publishers["visited"].publish(self._markers.visited(picture, stamp))
        for index, grid in enumerate(ros_io.cluster_grids(picture, CLUSTER_GRIDS, self._frame, stamp)):
            self._publishers[f"cluster_{index}"].publish(grid)
