"""Calls of the services of adhoc_communication and map_merger, each in threads that may wait for the answer."""

from functools import partial
from typing import Any, Callable, Dict, Optional, Tuple

import numpy as np
import rospy
from adhoc_communication.srv import SendExpAuction, SendExpFrontier, SendMessage
from map_merger.srv import LogMaps, TransformPoint

from explorer import ros_io, ros_team, ros_verdicts
from explorer.call_queue import CALLS, HANDOVER, CallQueue
from explorer.messages import SendState, SendStatement
from explorer.names import Names
from explorer.ros_worker import Worker
from mr_grid.ros import typed_fields

SERVICES = {
    "send_frontier": SendExpFrontier,
    "send_auction": SendExpAuction,
    "send_message": SendMessage,
    "transform_point": TransformPoint,
    "log_output": LogMaps,
}
MESSAGE_FIELDS = {"send_frontier": "frontier", "send_auction": "auction"}  # of the services' requests

OnTransform = Callable[[str, Optional[np.ndarray]], None]


class Calls:
    """Returns at once; what fails is reported once in a while. Messages to the group keep their order."""

    def __init__(self, names: Names, group: str) -> None:
        """`group`: of the own robot, in adhoc_communication."""
        self._names, self._group = names, group
        self._services = {key: rospy.ServiceProxy(name, SERVICES[key]) for key, name in names.called.items()}
        self._radio = Worker("adhoc_communication", 3, CallQueue(CALLS, HANDOVER))
        # Bids depend on nothing that is sent before, and an auctioneer waits for them.
        self._bids = Worker("adhoc_communication", 2, CallQueue(CALLS, HANDOVER))
        self._merger = Worker("map_merger", 1, CallQueue(20))

    def send(self, service: str, topic: str, message: Any, is_bid: bool) -> None:
        """To the group, by a service for messages of that type."""
        (self._bids if is_bid else self._radio).do(partial(self._send, service, topic, message))

    def say_statement(self, effect: SendStatement) -> None:
        """To the group."""
        said = ros_verdicts.verdicts_to(effect)
        self._radio.do(partial(self._say, self._group, ros_verdicts.TOPIC, said))

    def say_state(self, effect: SendState, merging: str) -> None:
        """To a mission control. `merging`: what map_merger says of itself."""
        told = ros_team.state_to(effect.state, merging)
        self._radio.do(partial(self._say, effect.to, ros_team.STATES_TOPIC, told))

    def ask_transform(self, robot: str, take: OnTransform) -> None:
        """`take` gets the name and the transform of a robot's map frame to the own one, shape (2, 3), or None while
        there is none; in the thread of the call."""
        self._merger.do(partial(self._ask_transform, robot, take))

    def log_output(self, mask: int) -> None:
        """Lets map_merger write its log."""
        self._merger.do(partial(self._services["log_output"], mask))

    def _send(self, service: str, topic: str, message: Any) -> None:
        fields: Dict[str, Any] = {MESSAGE_FIELDS[service]: message}
        answer = self._services[service](dst_robot=self._group, topic=topic, **fields)
        if answer.status == 0:
            rospy.logwarn_throttle(30.0, f"explorer: {self._names.called[service]} could not deliver {topic}")

    def _say(self, destination: str, topic: str, message: Any) -> None:
        self._services[ros_verdicts.SERVICE](dst_robot=destination, topic=topic, **typed_fields(message))

    def _ask_transform(self, robot: str, take: OnTransform) -> None:
        images = [self._transform_point(robot, probe) for probe in ros_io.PROBES]
        take(robot, ros_io.transform_from(images))

    def _transform_point(self, robot: str, point: Tuple[float, float]) -> Optional[Tuple[float, float]]:
        try:
            answer = self._services["transform_point"](ros_io.named_point(robot, point))
        except rospy.ServiceException:
            # The contract's answer while no transform to that robot is known.
            return None
        return (answer.point.x, answer.point.y)
