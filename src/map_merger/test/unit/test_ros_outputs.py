"""Conversions of the outputs. They need ROS's message classes, but no master."""

import io

import numpy as np
import pytest

pytest.importorskip("rospy")
pytest.importorskip("map_merger.msg")

import rospy
import tf2_py
from map_merger.msg import MergerStatus as MergerStatusMessage
from map_msgs.msg import OccupancyGridUpdate
from visualization_msgs.msg import Marker

from map_merger import ros_io, ros_outputs
from map_merger.grid import Box
from map_merger.markers import RobotMarker
from map_merger.status import MergerStatus, RobotPlacement
from mr_grid import GridInfo, OccupancyGrid, Pose

STAMP = rospy.Time(7, 5)
NOWHERE = np.empty((0, 2))


def over_the_wire(message, kind):
    """The message as a subscriber without numpy gets it."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return kind().deserialize(buffer.getvalue())


def test_an_update_holds_the_cells_of_its_box():
    cells = np.arange(48, dtype=np.int8).reshape(6, 8)
    message = ros_outputs.update_message(OccupancyGrid(GridInfo(8, 6, 0.05), cells), Box(1, 2, 4, 7), "map", STAMP)
    received = over_the_wire(message, OccupancyGridUpdate)
    assert (received.x, received.y, received.width, received.height) == (2, 1, 5, 3)
    assert received.header.frame_id == "map" and received.header.stamp == STAMP
    assert np.array_equal(np.reshape(received.data, (3, 5)), cells[1:4, 2:7])


@pytest.mark.parametrize("box", [Box(0, 0, 7, 8), Box(-1, 0, 2, 2), Box(2, 2, 2, 4)])
def test_an_update_outside_the_map_is_refused(box):
    grid = OccupancyGrid(GridInfo(8, 6, 0.05), np.zeros((6, 8), np.int8))
    with pytest.raises(ValueError, match="not a part"):
        ros_outputs.update_message(grid, box, "map", STAMP)


def test_the_status_carries_every_figure_and_robots_by_name():
    rows = ((0.0, 1.0, 2.0), (3.0, 4.0, 5.0), (6.0, 7.0, 8.0))
    placed = RobotPlacement("b", "shared wall 41.0 m", Pose(1.0, 2.0, 0.5), "c", rows, 0.9, 41.0, 3.5, 2**40)
    waiting = RobotPlacement("a", "shared wall 7.0 m of 14 m", shared_wall=7.0)
    message = ros_outputs.status_message(MergerStatus("r", "centralized", "base", (placed, waiting)), "map", STAMP)
    received = over_the_wire(message, MergerStatusMessage)
    assert (received.robot, received.topology, received.base_station) == ("r", "centralized", "base")
    assert received.header.frame_id == "map" and received.header.stamp == STAMP
    assert received.text == "waits for the base station base, which was not heard of"
    first, second = received.robots
    assert (first.robot, first.placed, first.why) == ("a", False, "shared wall 7.0 m of 14 m")
    assert (first.x, first.y, first.yaw, first.age_s, first.shared_wall_m) == (0.0, 0.0, 0.0, -1.0, 7.0)
    assert (second.robot, second.placed, second.via) == ("b", True, "c")
    assert (second.x, second.y, second.yaw, second.confidence) == (1.0, 2.0, 0.5, 0.9)
    assert (second.age_s, second.bytes_received, list(second.covariance)) == (3.5, 2**40, list(range(9)))


def test_markers_have_stable_identifiers_and_end_by_themselves():
    outline = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    robots = [
        RobotMarker("robot_1", Pose(1.0, 2.0, 0.5), outline),
        RobotMarker("robot_2", None, outline),
        RobotMarker("robot_3", Pose(), NOWHERE),
    ]
    markers = ros_outputs.team_markers(robots, "map", STAMP).markers
    kinds = {(marker.ns, marker.id): marker.type for marker in markers}
    assert kinds == {
        ("robot_1", 0): Marker.ARROW,
        ("robot_1", 1): Marker.TEXT_VIEW_FACING,
        ("robot_1", 2): Marker.LINE_STRIP,
        ("robot_2", 2): Marker.LINE_STRIP,
        ("robot_3", 0): Marker.ARROW,
        ("robot_3", 1): Marker.TEXT_VIEW_FACING,
    }
    alone = ros_outputs.team_markers(robots[2:], "map", STAMP).markers
    assert [(marker.ns, marker.id) for marker in alone] == [("robot_3", 0), ("robot_3", 1)]
    for marker in markers:
        assert marker.header.frame_id == "map" and marker.color.a == 1.0
        assert 0.0 < marker.lifetime.to_sec() < 60.0
        assert marker.pose.orientation.w != 0.0
    line = markers[2].points
    assert [(point.x, point.y) for point in line] == [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0)]


class Listener:
    """A tf buffer that gets broadcasts of `period` seconds with the given stamps, delayed by 0.1 s on their way."""

    def __init__(self, stamp_of, period=0.5):
        self._buffer = tf2_py.BufferCore(rospy.Duration(10.0))
        self._stamp_of, self._period = stamp_of, period

    def known_at(self, now, last=np.inf, start=100.0):
        """True if a lookup at `now` works. Broadcasts from `start` on; `last`: time of the last one."""
        self._buffer.clear()
        for sent in np.arange(start, min(now - 0.1, last) + 1e-6, self._period):
            stamp = self._stamp_of(rospy.Time.from_sec(sent))
            (message,) = ros_io.transform_messages([("robot_1/map", Pose(1.0, 0.0, 0.0))], "map", stamp)
            self._buffer.set_transform(message, "test")
        try:
            self._buffer.lookup_transform_core("map", "robot_1/map", rospy.Time.from_sec(now))
        except tf2_py.TransformException:
            return False
        return True


def test_a_transform_is_known_at_every_now_while_it_is_broadcast():
    moments = np.arange(101.5, 104.0, 0.07)
    ahead, plain = Listener(ros_outputs.dated_ahead), Listener(lambda stamp: stamp)
    assert all(ahead.known_at(now) for now in moments)
    assert not any(plain.known_at(now) for now in moments)


def test_a_revoked_transform_is_unknown_soon_after():
    listener = Listener(ros_outputs.dated_ahead)
    assert listener.known_at(103.9, last=103.0)
    assert not listener.known_at(104.1, last=103.0)
