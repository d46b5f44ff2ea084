"""Which process tells tf where the robot is: one and the same over several connections, or another one."""

import threading

import pytest
import rosgraph
import rospy
import tf2_ros
from geometry_msgs.msg import Quaternion, TransformStamped, Vector3
from nav_msgs.msg import OccupancyGrid
from tf2_msgs.msg import TFMessage

from mr_grid import Pose
from mr_grid.map_frame import MapFrame
from mr_grid.ros_map_frame import FrameListener, run_of_map


class Master:
    """Knows where nodes are; `addresses` by name."""

    def __init__(self):
        self.addresses = {"/slam": "http://here:1/", "/robot": "http://here:2/"}
        self.asked = 0

    def lookupNode(self, node):
        self.asked += 1
        if node not in self.addresses:
            raise rosgraph.MasterError("unknown node")
        return self.addresses[node]


class Subscriber:
    def unregister(self):
        pass


@pytest.fixture
def master(monkeypatch):
    made = Master()
    monkeypatch.setattr(rosgraph, "Master", lambda _: made)
    return made


@pytest.fixture
def heard(master, monkeypatch):
    """A listener, and the frames that it says are new."""
    monkeypatch.setattr(tf2_ros.TransformListener, "callback", lambda *_: None)
    monkeypatch.setattr(tf2_ros.TransformListener, "static_callback", lambda *_: None)
    made, new = FrameListener.__new__(FrameListener), []
    made.tf_sub = made.tf_static_sub = Subscriber()
    made.frame, made._begun, made._lock, made._processes = MapFrame("map", "base"), new.append, threading.Lock(), {}
    made.callback(told({"callerid": "/robot"}, ("odom", "base", 0.0)))
    return made, new


def told(connection, *transforms, at=10.0):
    message = TFMessage()
    for parent, child, x in transforms:
        each = TransformStamped(child_frame_id=child)
        each.header.frame_id, each.header.stamp = parent, rospy.Time(at)
        each.transform.translation, each.transform.rotation = Vector3(x, 0.0, 0.0), Quaternion(0.0, 0.0, 0.0, 1.0)
        message.transforms.append(each)
    message._connection_header = connection
    return message


def test_another_process_of_the_same_name_is_told_from_another_connection(master, heard):
    listener, new = heard
    first = {"callerid": "/slam"}
    for number in range(5):
        listener.callback(told(first, ("/map", "odom", 1.0), at=10.0 + number))
    listener.callback(told({"callerid": "/slam"}, ("map", "odom", 1.0), at=20.0))
    assert new == [] and master.asked == 2, "the master is asked once for each connection"
    master.addresses["/slam"] = "http://here:3/"
    listener.callback(told({"callerid": "/slam"}, ("map", "odom", 4.0), at=30.0))
    assert [each.shift for each in new] == [Pose(3.0, 0.0, 0.0)]


def test_where_the_master_does_not_answer_nothing_is_concluded(master, heard):
    listener, new = heard
    listener.callback(told({"callerid": "/slam"}, ("map", "odom", 1.0)))
    connection = {"callerid": "/slam"}
    known = master.addresses.pop("/slam")
    listener.callback(told(connection, ("map", "odom", 4.0), at=20.0))
    master.addresses["/slam"] = known
    listener.callback(told(connection, ("map", "odom", 4.0), at=21.0))
    assert new == []


def test_transforms_that_cannot_be_are_no_news(master, heard):
    listener, new = heard
    connection = {"callerid": "/slam"}
    listener.callback(told(connection, ("map", "odom", 1.0)))
    listener.callback(told(connection, ("map", "odom", float("nan")), at=20.0))
    assert new == [] and listener.frame.teller == "/slam http://here:1/"


def test_static_transforms_belong_to_the_way(master, heard):
    listener, new = heard
    listener.frame.base_frame = "base_link"
    listener.static_callback(told({"callerid": "/robot"}, ("/base", "base_link", 0.0)))
    listener.callback(told({"callerid": "/slam"}, ("map", "odom", 1.0)))
    assert listener.frame.teller == "/slam http://here:1/" and new == []


def test_the_run_of_a_map():
    message = OccupancyGrid()
    message.header.stamp, message.info.map_load_time = rospy.Time(5.0), rospy.Time(1_700_000_000, 7)
    assert run_of_map(message) == (1_700_000_000, 7)
    message.info.map_load_time = message.header.stamp
    assert run_of_map(message) is None
