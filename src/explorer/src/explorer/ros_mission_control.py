"""ROS node of a mission control: the state of the whole team on a topic, services that order it about."""

import functools
import queue
import socket
import threading
import time
from typing import Any

import rospy
from adhoc_communication.msg import Status
from adhoc_communication.srv import SendMessage
from std_srvs.srv import Trigger, TriggerResponse

from explorer import ros_team
from explorer.limits import Limits
from explorer.mission_control import MissionControl, SendOrder
from explorer.msg import TeamOverview, TeamState
from explorer.srv import OrderRobots, OrderRobotsResponse, SetLimits, SetLimitsResponse
from explorer.team_state import ORDERS, SET_LIMITS
from mr_grid.ros import CALL_FAILED, typed_fields
from mr_grid.ros_node import begin_thread, init_node

TICK = 0.5  # s of wall time
OVERVIEW_PERIOD = 1.0  # s
MOST_SENDS = 200


class MissionControlNode:
    """Owns the control; a lock guards it. Sends wait in a thread of their own, so a slow radio delays no service."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._control = MissionControl(name, int(time.time() * 1000.0))
        self._lock = threading.Lock()
        self._sends: queue.Queue[SendOrder] = queue.Queue(MOST_SENDS)
        self._send = rospy.ServiceProxy("adhoc_communication/send_message", SendMessage)
        self._overview = rospy.Publisher("~team", TeamOverview, queue_size=2, latch=True)
        rospy.Subscriber("adhoc_communication/status", Status, self._on_status, queue_size=2)
        rospy.Subscriber(ros_team.STATES_TOPIC, TeamState, self._on_state, queue_size=100)
        for order in ORDERS:
            rospy.Service(f"~{order}", Trigger, functools.partial(self._on_trigger, order))
        rospy.Service(f"~{SET_LIMITS}", SetLimits, self._on_limits)
        rospy.Service("~order", OrderRobots, self._on_order)
        begin_thread("orders", self._send_all)

    def run(self) -> None:
        shown = float("-inf")
        while not rospy.is_shutdown():
            time.sleep(TICK)
            now = time.monotonic()
            with self._lock:
                orders, members = self._control.tick(now), self._control.members(now)
            for order in orders:
                if not self._sends.full():
                    self._sends.put(order)
            if now - shown >= OVERVIEW_PERIOD:
                shown = now
                message = ros_team.overview_of(members)
                message.header.stamp = rospy.Time.now()
                self._overview.publish(message)

    def _on_status(self, message: Status) -> None:
        with self._lock:
            self._control.on_robots([robot for robot in message.robots if robot != self._name], time.monotonic())

    def _on_state(self, message: TeamState) -> None:
        with self._lock:
            self._control.on_state(ros_team.state_from(message), time.monotonic())

    def _on_trigger(self, order: str, _: Any) -> TriggerResponse:
        with self._lock:
            answer = self._control.order(order)
        return TriggerResponse(answer.done, answer.text)

    def _on_order(self, request: Any) -> OrderRobotsResponse:
        with self._lock:
            limits = Limits(request.time, request.distance)
            answer = self._control.order(request.order, list(request.robots), limits)
        return OrderRobotsResponse(answer.done, answer.text)

    def _on_limits(self, request: Any) -> SetLimitsResponse:
        with self._lock:
            answer = self._control.order(SET_LIMITS, limits=Limits(request.time, request.distance))
        return SetLimitsResponse(answer.done, answer.text)

    def _send_all(self) -> None:
        while not rospy.is_shutdown():
            robot, order = self._sends.get()
            try:
                self._send(dst_robot=robot, topic=ros_team.ORDERS_TOPIC, **typed_fields(ros_team.order_to(order)))
            except CALL_FAILED as error:
                rospy.logdebug(f"mission_control: order to {robot}: {error}")


def main() -> int:
    init_node("mission_control")
    MissionControlNode(str(rospy.get_param("~robot_name", "")) or socket.gethostname()).run()
    return 0
