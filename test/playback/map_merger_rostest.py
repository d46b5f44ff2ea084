#!/usr/bin/env python3
"""What robot_0's map_merger saw and heard in the recording is played to it again: merged map and transform have to be
those it had come to then."""

import math
import sys
import unittest
from typing import Any, Dict, Iterator, List, Optional

import numpy as np
import rospy
import rostest
from adhoc_communication.msg import MmPoint
from comparison import cells_of, differences, plain, planar, report, stored
from map_merger.srv import TransformPoint
from nav_msgs.msg import OccupancyGrid
from playback import FOLDER, Listener, played
from tf2_msgs.msg import TFMessage

CHILD = "robot_1/map"
# Registration sees other intermediate maps each time, according to its pace, and ends near the same optimum.
DISTANCE_M, ANGLE_RAD, DIFFERENT_CELLS = 0.05, math.radians(0.5), 0.005
PROBES = ((0.0, 0.0), (3.0, -1.0))
SETTLED_S = 8.0  # without another difference, of wall time


class MapMerger(unittest.TestCase):
    def test_merged_map_and_transform_are_those_of_the_recording(self) -> None:
        expected = stored(FOLDER / "map_merger.expected.bag")
        grid, transform = expected["map_merger/global_map"][-1], expected["tf"][-1]["transforms"][0]["transform"]
        maps, transforms = Listener("map_merger/global_map", OccupancyGrid), Listener("tf", TFMessage)
        with played("map_merger.bag", "--rate=4"):
            self.wait_for(
                "transform", transforms, lambda message: differences_of_transform(transform, message), has_child
            )
            self.wait_for("merged map", maps, lambda message: differences_of_map(grid, plain(message)))
            lines = list(differences_of_points(transform))
        if lines:
            self.fail(report("transformPoint", lines))

    def wait_for(self, what: str, listener: Listener, compare: Any, counts: Any = lambda message: True) -> None:
        """Until the newest message that counts is the expected one, else fails with what the newest differs in.

        However slow the computer, the first one is waited for; afterwards as long as differences are not the same ones.
        """
        if not listener.wait_for(lambda messages: any(map(counts, messages))):
            self.fail(report(what, ["nothing came"]))
        lines: List[str] = []
        seen = 0

        def matches(messages: List[Any]) -> bool:
            nonlocal lines, seen
            for message in filter(counts, messages[seen:]):
                lines = list(compare(message))
            seen = len(messages)
            return not lines

        before: Optional[List[str]] = None
        while not listener.wait_for(matches, SETTLED_S):
            if lines == before:
                self.fail(report(what, lines))
            before = lines


def has_child(message: TFMessage) -> bool:
    """The recording holds other transforms, too; which message is the last one depends on how busy the machine is."""
    return any(entry.child_frame_id == CHILD for entry in message.transforms)


def differences_of_transform(expected: Dict[str, Any], message: TFMessage) -> Iterator[str]:
    found = next(entry for entry in message.transforms if entry.child_frame_id == CHILD)
    x, y, yaw = planar(expected)
    observed_x, observed_y, observed_yaw = planar(plain(found.transform))
    yield from differences([x, y], [observed_x, observed_y], DISTANCE_M, f"map -> {CHILD}")
    turn = math.remainder(observed_yaw - yaw, math.tau)
    yield from differences(0.0, turn, ANGLE_RAD, f"turn of map -> {CHILD}")


def differences_of_map(expected: Dict[str, Any], observed: Dict[str, Any]) -> Iterator[str]:
    geometry = [{**grid["info"], "map_load_time": 0} for grid in (expected, observed)]
    lines = list(differences(*geometry, 1e-3, "global_map.info"))
    yield from lines
    if not lines:
        different = np.count_nonzero(cells_of(expected) != cells_of(observed))
        known = np.count_nonzero(cells_of(expected) >= 0)
        if different > DIFFERENT_CELLS * known:
            yield f"global_map: {different} of {known} known cells are different"


def differences_of_points(transform: Dict[str, Any]) -> Iterator[str]:
    x, y, yaw = planar(transform)
    service = rospy.ServiceProxy("map_merger/transformPoint", TransformPoint)
    for probe in PROBES:
        answer = service(MmPoint("robot_1", *probe)).point
        expected = [
            x + math.cos(yaw) * probe[0] - math.sin(yaw) * probe[1],
            y + math.sin(yaw) * probe[0] + math.cos(yaw) * probe[1],
        ]
        yield from differences(expected, [answer.x, answer.y], DISTANCE_M, f"point {probe} of robot_1")


if __name__ == "__main__":
    rospy.init_node("map_merger_rostest")
    rostest.rosrun("mr_test", "playback_map_merger", MapMerger, sys.argv)
