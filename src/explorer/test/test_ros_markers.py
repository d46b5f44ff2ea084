"""Frontiers in rviz: a robot keeps its identifier, and what is gone is deleted."""

import pkgutil

import pytest

import explorer

# The generated messages lie in a folder of their own, and where ROS is not installed there are none.
explorer.__path__ = pkgutil.extend_path(explorer.__path__, "explorer")
for package in ("rospy", "visualization_msgs.msg"):
    pytest.importorskip(package, reason="ROS is not here")

import rospy  # noqa: E402
from visualization_msgs.msg import Marker  # noqa: E402

from explorer.ros_markers import MOST_ROBOTS, FrontierMarkers  # noqa: E402
from explorer.status import Picture  # noqa: E402

NOW = rospy.Time(5)


def picture(own=(), **others):
    return Picture(tuple(own), (), {name: tuple(places) for name, places in others.items()}, {})


def by_identifier(markers):
    return {marker.id: (marker.action, [(point.x, point.y) for point in marker.points]) for marker in markers.markers}


def test_a_robot_keeps_its_identifier_and_is_deleted_when_it_is_gone():
    made = FrontierMarkers("map")
    first = by_identifier(made.frontiers(picture([(1.0, 2.0)], anna=[(3.0, 4.0)], bob=[(5.0, 6.0)]), NOW))
    assert first == {0: (Marker.ADD, [(1.0, 2.0)]), 1: (Marker.ADD, [(3.0, 4.0)]), 2: (Marker.ADD, [(5.0, 6.0)])}
    second = by_identifier(made.frontiers(picture(bob=[(5.0, 6.0)], carl=[(7.0, 8.0)]), NOW))
    assert second == {
        0: (Marker.DELETE, []), 1: (Marker.DELETE, []), 2: (Marker.ADD, [(5.0, 6.0)]), 3: (Marker.ADD, [(7.0, 8.0)]),
    }  # fmt: skip


def test_all_lists_are_in_the_namespace_and_frame_of_the_contract():
    markers = FrontierMarkers("map").frontiers(picture([(1.0, 2.0)], robot_1=[(3.0, 4.0)], robot_2=[(3.0, 4.0)]), NOW)
    assert {(m.ns, m.header.frame_id, m.scale.x) for m in markers.markers} == {("my_namespace", "map", 0.2)}
    colours = [(m.color.r, m.color.g, m.color.b) for m in markers.markers]
    assert colours == [(1, 0, 0), (0, 1, 0), (0, 0, 1)]


def test_there_is_an_end_of_robots():
    made = FrontierMarkers("map")
    many = picture(**{f"r{number}": [(0.0, 0.0)] for number in range(2 * MOST_ROBOTS)})
    assert len(made.frontiers(many, NOW).markers) == 1 + MOST_ROBOTS
