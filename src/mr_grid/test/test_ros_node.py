"""What happens to a node whose output goes to a full disk, and to one that is interrupted while it sends."""

import errno
import logging
import signal
import subprocess
import sys
import threading
from typing import List

import pytest
import rospy
from rosgraph.roslogging import RosStreamHandler

from mr_grid import ros_node
from mr_grid.ros_node import begin_thread, lose_what_cannot_be_written, until_shutdown


class FullDisk:
    def write(self, _: str) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")


class Kept(logging.Handler):
    def __init__(self) -> None:
        super().__init__()
        self.messages: List[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.messages.append(record.getMessage())


def test_a_full_disk_does_not_reach_who_logs() -> None:
    """A robot explored an old map for six minutes: the timer of its map_merger had ended by a warning."""
    logger, others = logging.Logger("rosout"), Kept()
    logger.addHandler(RosStreamHandler(False, FullDisk(), FullDisk()))
    logger.addHandler(others)
    with pytest.raises(OSError):
        logger.warning("as rospy does it")
    lose_what_cannot_be_written(logger)
    logger.warning("no room")
    assert others.messages == ["no room"]


def test_what_can_be_written_is(capfd: pytest.CaptureFixture) -> None:
    logger = logging.Logger("rosout")
    logger.addHandler(RosStreamHandler(False))
    lose_what_cannot_be_written(logger)
    logger.warning("a wheel is stuck")
    assert "a wheel is stuck" in capfd.readouterr().err


@pytest.mark.parametrize("shuts_down", [False, True])
def test_a_thread_that_ends_by_an_exception_ends_the_node(monkeypatch: pytest.MonkeyPatch, shuts_down: bool) -> None:
    """A node whose thread had ended went on, and did the other half of its work."""
    told: List[str] = []
    monkeypatch.setattr(rospy, "logfatal", told.append)
    monkeypatch.setattr(rospy, "signal_shutdown", told.append)
    monkeypatch.setattr(rospy.core, "is_shutdown_requested", lambda: shuts_down)
    before = set(threading.enumerate())
    begin_thread("arithmetic", lambda: print(1 // 0))
    for thread in set(threading.enumerate()) - before:
        thread.join(10.0)
    assert [text.partition(":")[0] for text in told] == (
        [] if shuts_down else ["the thread for arithmetic has ended, and the node ends", "arithmetic"]
    )
    assert shuts_down or "ZeroDivisionError" in told[0]


SENDING = """
import sys, threading, time
import rospy
from mr_grid.ros_node import end_beside_the_main_thread
lock = threading.Lock()  # as a connection has one
rospy.core.register_signals()  # as rospy.init_node does
end_beside_the_main_thread()
rospy.on_shutdown(lambda: lock.acquire())
with lock:
    print("sends", flush=True)
    time.sleep(1.0)
while not rospy.is_shutdown():
    time.sleep(0.01)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_while_the_node_sends_ends_it(number: signal.Signals) -> None:
    with subprocess.Popen([sys.executable, "-c", SENDING], stdout=subprocess.PIPE, text=True) as node:
        assert node.stdout is not None and node.stdout.readline() == "sends\n"
        node.send_signal(number)
        try:
            assert node.wait(timeout=20.0) == 0
        finally:
            node.kill()


@pytest.mark.parametrize("ended", [False, True])
def test_topics_that_are_closed_matter_only_until_shutdown(monkeypatch: pytest.MonkeyPatch, ended: bool) -> None:
    """Nodes that were publishing at a Ctrl-C ended with a traceback."""
    monkeypatch.setattr(rospy.core, "is_shutdown_requested", lambda: ended)
    told = []
    try:
        with until_shutdown():
            raise rospy.ROSException("publish() to a closed topic")
    except rospy.ROSException as error:
        told.append(str(error))
    assert told == ([] if ended else ["publish() to a closed topic"])


def test_a_node_waits_for_its_master_and_says_so_once(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    answers, slept = iter([False, False, True]), []
    monkeypatch.setattr(ros_node.rosgraph, "is_master_online", lambda: next(answers))
    monkeypatch.setattr(ros_node.time, "sleep", slept.append)
    monkeypatch.setenv("ROS_MASTER_URI", "http://robot:11311")
    ros_node.wait_for_master("slam")
    assert len(slept) == 2 and capsys.readouterr().err == (
        "slam: waits for a ROS master, none answers at http://robot:11311: start robot.launch or roscore, or set"
        " ROS_MASTER_URI\n"
    )


def test_an_address_that_no_master_can_have_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", "robot")
    with pytest.raises(SystemExit, match=r"^slam: invalid master URI: robot: set ROS_MASTER_URI to one such as http:"):
        ros_node.wait_for_master("slam")
