"""The action move_base of a robot that is played back: it drives where it drove then, so a goal is reached when it
comes by, and stays open until the explorer wants another one."""

import math

import actionlib
import rospy
import tf2_ros
from move_base_msgs.msg import MoveBaseAction

from mr_grid.ros_node import init_node

NEAR = 0.35  # m; navigation reaches goals to 0.2 m, and SLAM moves them a little
PERIOD = 0.1  # s of recorded time


class ReplayedNavigation:
    def __init__(self) -> None:
        self._frames = (rospy.get_param("~map_frame", "map"), rospy.get_param("~base_frame", "base_footprint"))
        self._buffer = tf2_ros.Buffer(rospy.Duration(10.0))
        self._listener = tf2_ros.TransformListener(self._buffer)
        self._server = actionlib.SimpleActionServer("move_base", MoveBaseAction, self._follow, auto_start=False)
        self._server.start()

    def _follow(self, goal: MoveBaseAction) -> None:
        target = goal.target_pose.pose.position
        while not rospy.is_shutdown():
            if self._server.is_preempt_requested():
                self._server.set_preempted()
                return
            if self._distance(target.x, target.y) < NEAR:
                self._server.set_succeeded(text="the robot came by")
                return
            rospy.sleep(PERIOD)

    def _distance(self, x: float, y: float) -> float:
        try:
            place = self._buffer.lookup_transform(*self._frames, rospy.Time(0)).transform.translation
        except tf2_ros.TransformException:
            return math.inf
        return math.hypot(place.x - x, place.y - y)


def main() -> int:
    init_node("move_base")
    ReplayedNavigation()
    rospy.spin()
    return 0
