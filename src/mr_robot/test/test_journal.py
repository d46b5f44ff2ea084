"""Files in which maps are kept, and the node that goes on with them."""

import errno
import os
import struct
from pathlib import Path
from typing import Any, Callable, Dict, List

import pytest
import rospkg
import rospy
from test_slam_node import scan
from usual_robot import slam_with

from mr_grid import Pose
from mr_grid.ros_laser import Mount
from mr_robot.slam import journal as module
from mr_robot.slam.engine import OdometryHistory
from mr_robot.slam.journal import JournalError, MapJournal
from mr_robot.slam.keeper import MapKeeper
from mr_robot.slam.ros_io import scan_value


def test_what_was_written_is_read(tmp_path: Path) -> None:
    written = MapJournal.create(tmp_path / "new" / "folder", b"state 0")
    written.set_state(b"state 1")
    written.add(b"one")
    written.set_state(b"state 2")
    written.add(b"two")
    again = MapJournal.open(written.path, 7)
    assert again.read() == (b"state 2", b"onetwo")
    again.keep_only(4)
    again.add(b"ree")
    again.set_state(b"state 3")
    assert MapJournal.open(written.path, 7).read() == (b"state 3", b"onetree")
    again.remove()
    assert not written.path.exists()


def test_two_files_in_one_folder_are_two(tmp_path: Path) -> None:
    assert MapJournal.create(tmp_path, b"").path != MapJournal.create(tmp_path, b"").path


@pytest.mark.parametrize("content", [b"", b"mr_robot map  9\nstate 0", b"mr_robot map  2\nsta"])
def test_another_file_is_named(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "slam.map"
    path.write_bytes(content)
    with pytest.raises(JournalError, match=r"slam\.map is no map of this version"):
        MapJournal.open(path, 7)
    with pytest.raises(JournalError, match=r"missing\.map: No such file"):
        MapJournal.open(tmp_path / "missing.map", 7)


class Master:
    """The parameters of a node, what it says, and what it does at its end."""

    def __init__(self) -> None:
        self.parameters: Dict[str, Any] = {"~memory": ""}
        self.said: List[str] = []
        self.at_the_end: List[Callable[[], None]] = []


@pytest.fixture
def master(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Master:
    made = Master()
    monkeypatch.setattr(rospy, "get_param", made.parameters.get)
    monkeypatch.setattr(rospy, "set_param", made.parameters.__setitem__)
    monkeypatch.setattr(rospy, "on_shutdown", made.at_the_end.append)
    monkeypatch.setattr(rospkg, "get_log_dir", lambda: str(tmp_path))
    for level in ("logerr", "logwarn", "loginfo"):
        monkeypatch.setattr(rospy, level, made.said.append)
    return made


class Node:
    """What the node does with a keeper. The robot drives ahead at 0.5 m/s."""

    def __init__(self) -> None:
        self.slam, self.history = slam_with(), OdometryHistory()
        self.keeper = MapKeeper(self.slam, self.history)

    def drive(self, steps: range, driver: Callable[[float], Pose] = lambda x: Pose(x, 0.0, 0.0)) -> None:
        """`driver`: what odometry says at a place."""
        for step in steps:
            time, x = 1000.0 + 0.1 * step, 0.05 * step
            self.history.add(time, driver(x))
            self.slam.process(scan_value(scan(time, x), Mount()), self.history.at(time), time)
            self.keeper.keep_map()
            self.keeper.keep_place()
            self.keeper.begun(rospy.Time.from_sec(time))

    def pose(self) -> Pose:
        return self.slam.pose_at(self.history.newest()[1])


def test_a_node_goes_on_with_the_map_of_one_that_crashed(master: Master) -> None:
    first = Node()
    first.drive(range(30))
    again = Node()
    assert again.slam.map_to_odometry() == first.slam.map_to_odometry()
    again.drive(range(30, 50))
    assert again.pose() == pytest.approx(Pose(0.05 * 49, 0.0, 0.0), abs=0.02)
    third = Node()
    third.drive(range(50, 60))
    assert third.pose() == pytest.approx(Pose(0.05 * 59, 0.0, 0.0), abs=0.02)
    assert third.keeper.begun(rospy.Time(2000)) == rospy.Time(1000)
    assert [text[:26] for text in master.said] == ["slam goes on with its map,"] * 2


def test_a_driver_that_crashed_too_moves_no_robot(master: Master) -> None:
    Node().drive(range(30))
    again = Node()
    again.drive(range(30, 50), lambda x: Pose(x - 1.5, 0.0, 0.0))
    assert again.pose() == pytest.approx(Pose(0.05 * 49, 0.0, 0.0), abs=0.1)


def test_the_end_of_a_node_that_was_told_to_end_leaves_no_map(master: Master, tmp_path: Path) -> None:
    Node().drive(range(5))
    assert len(list(tmp_path.glob("slam_*.map"))) == 1
    master.at_the_end[0]()
    assert not list(tmp_path.glob("slam_*.map"))
    again = Node()
    again.drive(range(5))
    assert "a new map begins" in master.said[0] and again.slam.revision < 6


def test_a_map_that_makes_no_sense_is_told_and_another_one_begins(master: Master) -> None:
    first = Node()
    first.drive(range(30))
    there = struct.pack("<?6d", False, 0.0, 0.0, 0.0, 5000.0, 5000.0, 0.0)
    first.keeper._journal.add(b"P" + struct.pack("<I", len(there)) + there)
    again = Node()
    again.drive(range(30))
    assert len(master.said) == 1 and "cannot be read" in master.said[0] and "too many cells" in master.said[0]
    assert again.pose() == pytest.approx(Pose(0.05 * 29, 0.0, 0.0), abs=0.02)
    assert again.keeper._journal.path != first.keeper._journal.path


def test_without_the_parameter_nothing_is_kept(master: Master, tmp_path: Path) -> None:
    del master.parameters["~memory"]
    Node().drive(range(5))
    assert not list(tmp_path.iterdir()) and not master.said and not master.at_the_end


def test_a_full_disk_is_said_once_and_the_map_goes_on(
    master: Master, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    node = Node()

    def full(*_: Any) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr(os, "write", full)
        node.drive(range(20))
    node.drive(range(20, 40))
    assert len(master.said) == 1 and "No space left on device" in master.said[0]
    assert node.pose() == pytest.approx(Pose(0.05 * 39, 0.0, 0.0), abs=0.02) and not list(tmp_path.iterdir())


def test_a_write_that_was_short_goes_on(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    written = MapJournal.create(tmp_path, b"state")
    write = os.write
    monkeypatch.setattr(module.os, "write", lambda descriptor, octets: write(descriptor, octets[:2]))
    written.add(b"entries")
    assert MapJournal.open(written.path, 5).read().entries == b"entries"
