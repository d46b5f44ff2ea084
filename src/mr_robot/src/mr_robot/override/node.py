"""The velocity_override node: parameters and topics of the override engine."""

import sys
import threading
import time
from typing import Any, Callable, Optional

import rospy
from geometry_msgs.msg import Twist

from mr_grid.ros_node import init_node
from mr_robot.override.engine import HOLD, Override, Velocity
from mr_robot.ros_poses import ParameterError, topic_parameters

PERSON, NAVIGATION = "teleop/cmd_vel", "navigation/cmd_vel"
TICK = 0.1  # s of wall time: a joystick is silent in real seconds, whatever the simulation does


class VelocityOverrideNode:
    def __init__(self, hold: float, topic: str) -> None:
        self._override = Override(hold)
        self._lock = threading.Lock()
        self._base = rospy.Publisher(topic, Twist, queue_size=1)
        rospy.Subscriber(PERSON, Twist, self._take, callback_args=self._override.on_person, queue_size=1)
        rospy.Subscriber(NAVIGATION, Twist, self._take, callback_args=self._override.on_navigation, queue_size=1)

    def run(self) -> None:
        while not rospy.is_shutdown():
            time.sleep(TICK)
            with self._lock:
                self._publish(self._override.tick(time.monotonic()))

    def _take(self, message: Any, decide: Callable[[Velocity, float], Optional[Velocity]]) -> None:
        velocity = Velocity(message.linear.x, message.linear.y, message.angular.z)
        with self._lock:
            self._publish(decide(velocity, time.monotonic()))

    def _publish(self, velocity: Optional[Velocity]) -> None:
        if velocity is not None:
            twist = Twist()
            twist.linear.x, twist.linear.y, twist.angular.z = velocity
            self._base.publish(twist)


def main() -> int:
    init_node("velocity_override")
    hold = rospy.get_param("~hold", HOLD)
    if isinstance(hold, bool) or not isinstance(hold, (int, float)) or not 0.1 <= hold <= 60.0:
        rospy.logfatal(f"velocity_override: parameter ~hold must be a number from 0.1 to 60 s, not {hold!r}")
        return 1
    try:
        topic = topic_parameters({"velocity_topic": "cmd_vel"})["velocity_topic"]
    except ParameterError as error:
        rospy.logfatal(f"velocity_override: {error}")
        return 1
    if rospy.resolve_name(topic) in (rospy.resolve_name(PERSON), rospy.resolve_name(NAVIGATION)):
        rospy.logfatal(f"velocity_override: parameter ~velocity_topic must not be {topic!r}, which it reads itself")
        return 1
    VelocityOverrideNode(float(hold), topic).run()
    return 0


if __name__ == "__main__":
    sys.exit(main())
