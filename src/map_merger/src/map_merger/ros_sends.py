"""Calls of adhoc_communication's services, which block: none waits behind one of another purpose."""

import queue
from functools import partial
from typing import Any, Callable, Dict, Iterable, Tuple, Union

import rospy
from adhoc_communication.srv import (
    GetNeighbors,
    SendMessage,
    SendMessageRequest,
    SendMmControl,
    SendMmControlRequest,
    SendMmMapUpdate,
    SendMmMapUpdateRequest,
    SendMmRobotPosition,
    SendMmRobotPositionRequest,
    SendOccupancyGrid,
    SendOccupancyGridRequest,
)
from rospy.numpy_msg import numpy_msg

from mr_grid.ros import CALL_FAILED, typed_fields
from mr_grid.ros_node import begin_thread

from . import ros_io, ros_radio
from .delivery import Delivery
from .effects import AskNeighbors, Purpose, Send
from .messages import Tile
from .options import Options
from .payload import Payload

MOST_SENDS = 256
"""Of one purpose, that wait."""

Client = Tuple[rospy.ServiceProxy, Callable[[str, str, Any], Any]]


class TooLarge(Exception):
    """adhoc_communication does not send a tile of that size."""


class Sends:
    """A queue and a thread for each purpose: a group send waits for its slowest member; positions, requests and answers
    do not wait behind it."""

    def __init__(
        self, options: Options, prefix: str, ended: Callable[[Delivery], None], met: Callable[[Iterable[str]], None]
    ) -> None:
        """`prefix`: of the names of adhoc_communication. `ended` is called with each send that is over, `met` with the
        names of the neighbours that were asked for; both in threads of their own."""
        self._options, self._ended, self._met = options, ended, met
        self._clients = _clients(prefix)
        self._get_neighbors = rospy.ServiceProxy(f"{prefix}adhoc_communication/get_neighbors", GetNeighbors)
        self._waiting: Dict[Purpose, queue.Queue[Union[Send, AskNeighbors]]] = {
            purpose: queue.Queue(MOST_SENDS) for purpose in Purpose
        }

    def begin(self) -> None:
        """Starts the threads, which end with the node."""
        for purpose, waiting in self._waiting.items():
            begin_thread(f"sends ({purpose.value})", partial(self._work, waiting))

    def put(self, send: Send) -> bool:
        """False if there is no room for it."""
        try:
            self._waiting[send.purpose].put_nowait(send)
        except queue.Full:
            return False
        return True

    def ask_neighbors(self) -> None:
        """In turn with the requests."""
        self._waiting[Purpose.REQUEST].put(AskNeighbors())

    def _work(self, waiting: "queue.Queue[Union[Send, AskNeighbors]]") -> None:
        while not rospy.is_shutdown():
            effect = waiting.get()
            if isinstance(effect, AskNeighbors):
                self._ask()
            else:
                self._ended(self._delivered(effect))

    def _delivered(self, send: Send) -> Delivery:
        delivery = Delivery(send)
        while delivery.next is not None:
            try:
                delivery.ended(self._deliver(send.destination, delivery.next))
            except TooLarge:
                delivery.ended(False, too_large=True)
        return delivery

    def _deliver(self, destination: str, payload: Payload) -> bool:
        call = ros_radio.radio_call(payload, self._options, rospy.Time.now())
        client, request = self._clients[call.service]
        try:
            return bool(client(request(destination, call.topic, call.message)).status == 1)
        except CALL_FAILED as error:
            if isinstance(payload, Tile) and ros_io.REFUSED_FOR_SIZE in str(error):
                raise TooLarge from error
            rospy.logdebug(f"send to {destination} failed: {error}")
        return False

    def _ask(self) -> None:
        try:
            names = self._get_neighbors().neigbors
        except CALL_FAILED as error:
            rospy.logdebug(f"get_neighbors failed: {error}")
            return
        self._met(names)


def _clients(prefix: str) -> Dict[str, Client]:
    def client(name: str, kind: type) -> rospy.ServiceProxy:
        return rospy.ServiceProxy(f"{prefix}adhoc_communication/{name}", kind)

    return {
        "send_map_update": (client("send_map_update", SendMmMapUpdate), numpy_msg(SendMmMapUpdateRequest)),
        "send_map": (client("send_map", SendOccupancyGrid), numpy_msg(SendOccupancyGridRequest)),
        "send_control_message": (client("send_control_message", SendMmControl), SendMmControlRequest),
        "send_position": (client("send_position", SendMmRobotPosition), SendMmRobotPositionRequest),
        ros_radio.SEND_TYPED: (client(ros_radio.SEND_TYPED, SendMessage), _typed_request),
    }


def _typed_request(destination: str, topic: str, message: Any) -> SendMessageRequest:
    return SendMessageRequest(dst_robot=destination, topic=topic, **typed_fields(message))
