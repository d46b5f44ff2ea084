"""Subscribers that rospy has left without their publisher get it."""

import os
import subprocess
import sys

import pytest
from rosmaster.master import Master

from mr_grid.ros_connections import Missed

SUBSCRIBER = """
import sys, threading
import rospy
from rospy.impl.registration import RegManager
from std_msgs.msg import Empty
from mr_grid import ros_connections

def overtaken(manager, topic, uris):
    # The publisher registers while the node subscribes: the master's update comes, then its older answer.
    with manager.cond:
        manager.updates += [(topic, uris), (topic, [])]
        manager.cond.notify_all()

rospy.init_node("reader", disable_rostime=True)
if "watch" in sys.argv:
    ros_connections.FIRST_LOOK = 0.1
    ros_connections.watch_connections()
writer = rospy.Publisher("map", Empty, latch=True, queue_size=1)
writer.publish()
RegManager.publisher_update, update = overtaken, RegManager.publisher_update
heard = threading.Event()
rospy.Subscriber("map", Empty, lambda _: heard.set())
RegManager.publisher_update = update
print(heard.wait(20.0 if "watch" in sys.argv else 2.0))
"""


@pytest.fixture(scope="module")
def master_uri():
    master = Master(port=0)
    master.start()
    yield master.uri
    master.stop()


@pytest.mark.parametrize("argument, heard", [("bare", "False"), ("watch", "True")])
def test_an_update_that_an_older_answer_has_overtaken_is_made_good(master_uri, argument, heard):
    """A robot of a team stood for ever: its monitor had no connection to the map, which was told once."""
    environment = {**os.environ, "ROS_MASTER_URI": master_uri, "ROS_HOSTNAME": "localhost"}
    command = [sys.executable, "-c", SUBSCRIBER, argument]
    reader = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60, check=True)
    assert reader.stdout.split()[-1] == heard


def test_what_is_missing_twice_in_a_row_is_told_once():
    missed, published = Missed(), {"map": ["a", "b"], "odom": ["c"]}
    assert missed.told_now(published, {"map": ["a"], "odom": ["c"]}) == {}, "it may be connecting"
    assert missed.told_now(published, {"map": ["a"]}) == {"map": ["a", "b"]}
    assert missed.told_now(published, {"map": ["a"]}) == {"odom": ["c"]}
    assert missed.told_now(published, {"map": ["a"]}) == {}, "nobody answers there"


def test_a_publisher_that_was_gone_is_told_again():
    missed, published = Missed(), {"map": ["a"]}
    assert [missed.told_now(published, {}) for _ in range(3)] == [{}, published, {}]
    assert missed.told_now({}, {}) == {}
    assert [missed.told_now(published, {}) for _ in range(2)] == [{}, published]
