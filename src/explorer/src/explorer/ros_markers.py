"""Frontiers as rviz shows them."""

from typing import Dict, Sequence, Tuple

import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from explorer.options import number_of
from explorer.status import Picture

Colour = Tuple[float, float, float]

NAMESPACE = "my_namespace"  # contract 3.2
OWN = 0  # identifier of the own list
RED: Colour = (1, 0, 0)
COLOURS: Sequence[Colour] = ((0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1))
SIZE = 0.2  # m
MOST_ROBOTS = 100


class FrontierMarkers:
    """One list of spheres per robot, own red. A robot keeps its identifier; a list without points is deleted."""

    def __init__(self, frame: str) -> None:
        self._frame = frame
        self._identifiers: Dict[str, int] = {}

    def frontiers(self, picture: Picture, stamp: rospy.Time) -> MarkerArray:
        """Own ones come first, then those of each robot that was ever heard of, at most MOST_ROBOTS."""
        for robot in picture.others:
            if len(self._identifiers) < MOST_ROBOTS:
                self._identifiers.setdefault(robot, len(self._identifiers) + 1)
        lists = [self._spheres(OWN, RED, picture.own, stamp)]
        for robot, identifier in self._identifiers.items():
            colour = COLOURS[((number_of(robot) or identifier) - 1) % len(COLOURS)]
            lists.append(self._spheres(identifier, colour, picture.others.get(robot, ()), stamp))
        return MarkerArray(lists)

    def visited(self, picture: Picture, stamp: rospy.Time) -> MarkerArray:
        """Own ones."""
        return MarkerArray([self._spheres(OWN, RED, picture.visited, stamp)])

    def _spheres(
        self, identifier: int, colour: Colour, points: Sequence[Tuple[float, float]], stamp: rospy.Time
    ) -> Marker:
        action = Marker.ADD if points else Marker.DELETE
        marker = Marker(ns=NAMESPACE, id=identifier, type=Marker.SPHERE_LIST, action=action)
        marker.header.frame_id, marker.header.stamp = self._frame, stamp
        marker.pose.orientation.w = 1.0
        marker.scale.x = marker.scale.y = marker.scale.z = SIZE
        marker.color = ColorRGBA(*colour, 1.0)
        marker.points = [Point(x, y, 0.0) for x, y in points]
        return marker
