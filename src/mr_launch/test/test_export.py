"""An exported mission read back by rosbags: counts, times, frames, cells; and what is refused."""

import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from recorded_bags import SECOND, Bag
from rosbags.highlevel import AnyReader

from mr_launch.arguments import parse_arguments
from mr_launch.plan import PLAN_FILE, Plan, RobotPlan
from mr_launch.recordings.export_command import main
from mr_launch.recordings.recording import find_recording

CELLS = {"anna": np.array([[0, 100, -1], [-1, 0, 50]]), "bob": np.array([[100, 100], [0, -1]])}
AHEAD, LATE = 1000 * SECOND, SECOND // 100  # bob's clock before anna's; way of a message on the radio
NAMES = ["anna", "bob"]


def record(path, robot, offset=0, simulated=False, place=(2.0, 1.0, math.pi / 2), hears=True):
    """Half a minute of one robot; `offset`: of its clock, ns; `place`: where anna believes bob's map to be."""
    other = "bob" if robot == "anna" else "anna"
    others_offset = offset - AHEAD if robot == "bob" else offset + AHEAD
    with Bag(path) as bag:
        bag.add(offset + SECOND, "/tf_static", bag.tf(bag.transform(0, "base_footprint", "base_laser_link", 0.1)), 1)
        for second in range(1, 31):
            now = offset + second * SECOND
            if simulated:
                bag.add(now, "/clock", bag.clock(now))
            moved = bag.transform(now, "odom", "base_footprint", 1.0)
            bag.add(now, "/tf", bag.tf(bag.transform(now, "map", "odom", 0.01), moved))
            bag.add(now, "base_scan", bag.scan(now))
            bag.add(now, "odom", bag.odometry(now))
            bag.add(now, "base_pose_ground_truth", bag.odometry(now))
            bag.add(now, "all_positions", bag.positions(other, 3.0, 4.0))
            if hears and not simulated:
                bag.add(now + LATE, "position_other_robots", bag.heard(other, others_offset + second * SECOND))
        bag.add(offset + 30 * SECOND, "map", bag.grid(offset + 30 * SECOND, CELLS[robot]), 1)
        if robot == "anna":
            bag.add(offset + 30 * SECOND, "map_merger/status", bag.status(offset, "anna", "bob", place), 1)


@pytest.fixture
def real(tmp_path):
    """Folders of two real robots, copied side by side, whose clocks disagree."""
    record(tmp_path / "anna" / "topics_2026-01-01.bag", "anna", 5000 * SECOND)
    record(tmp_path / "bob" / "topics_2026-01-01.bag", "bob", 5000 * SECOND + AHEAD)
    return tmp_path


@pytest.fixture
def mission(tmp_path):
    """The output folder of the team runner."""
    for name in NAMES:
        record(tmp_path / name / f"{name}.bag", name, simulated=True)
    robots = [RobotPlan("anna", 0, 11311, (1.0, 2.0, 0.0)), RobotPlan("bob", 1, 11311, (3.0, 4.0, 1.0))]
    plan = Plan(parse_arguments(["--out", str(tmp_path)]), "w", robots, str(tmp_path), "namespaces")
    (tmp_path / PLAN_FILE).write_text(plan.to_json())
    return tmp_path


class Read:
    """All messages of an MCAP by topic: [(time, message)]; `keeps`: topics for late listeners, too."""

    def __init__(self, path):
        self.topics, self.keeps = {}, set()
        with AnyReader([path]) as reader:
            assert reader.is2
            for connection, time, octets in reader.messages():
                assert connection.ext.serialization_format == "cdr"
                message = reader.deserialize(octets, connection.msgtype)
                self.topics.setdefault(connection.topic, []).append((time, message))
                if connection.ext.offered_qos_profiles:
                    self.keeps.add(connection.topic)

    def ties(self):
        """{child: (parent, x, y, yaw)} of what never changes."""
        ((_, message),) = self.topics["/tf_static"]
        return {
            each.child_frame_id: (each.header.frame_id, each.transform.translation.x, each.transform.translation.y,
                                  2 * math.atan2(each.transform.rotation.z, each.transform.rotation.w))
            for each in message.transforms
        }  # fmt: skip


def test_a_mission_of_the_team_runner(mission):
    assert main([str(mission)]) == 0
    read = Read(mission / "mission.mcap")
    counts = {topic: len(messages) for topic, messages in read.topics.items()}
    own = {"base_scan": 30, "odom": 30, "base_pose_ground_truth": 30, "positions": 30, "map": 1}
    expected = {f"/{name}/{topic}": count for name in NAMES for topic, count in own.items()}
    assert counts == {**expected, "/tf": 60, "/tf_static": 1, "/anna/map_merger/status": 1}
    assert {"/tf_static", "/anna/map", "/bob/map", "/anna/map_merger/status"} == read.keeps
    ties = read.ties()
    assert ties["anna/map"] == ("world", 1.0, 2.0, 0.0)
    assert ties["bob/map"] == pytest.approx(("world", 3.0, 4.0, 1.0))
    assert ties["bob/base_laser_link"] == ("bob/base_footprint", 0.1, 0.0, 0.0)
    _, truth = read.topics["/bob/base_pose_ground_truth"][0]
    assert (truth.header.frame_id, truth.child_frame_id) == ("world", "bob/base_footprint")
    assert (truth.pose.pose.position.x, truth.pose.pose.position.y) == (1.5, 2.5)


def test_times_frames_and_cells(mission):
    assert main([str(mission), "--out", str(mission / "x.mcap"), "--compress"]) == 0
    read = Read(mission / "x.mcap")
    for name, cells in CELLS.items():
        ((time, grid),) = read.topics[f"/{name}/map"]
        assert time == 30 * SECOND and grid.header.stamp.sec == 30 and grid.header.frame_id == f"{name}/map"
        assert np.array_equal(grid.data.reshape(grid.info.height, grid.info.width), cells)
        assert (grid.info.origin.position.x, grid.info.origin.position.y) == (-1, -2)
        times = [time for time, _ in read.topics[f"/{name}/base_scan"]]
        assert times == [second * SECOND for second in range(1, 31)]
        _, scan = read.topics[f"/{name}/base_scan"][4]
        assert scan.header.frame_id == f"{name}/base_laser_link" and scan.header.stamp.sec == 5
        assert scan.ranges.tolist() == [0, 1, 2, 3, 4]
        _, poses = read.topics[f"/{name}/positions"][0]
        place = poses.poses[0].position
        assert poses.header.frame_id == f"{name}/map" and (place.x, place.y) == (3, 4)
    links = {(each.header.frame_id, each.child_frame_id) for _, tf in read.topics["/tf"] for each in tf.transforms}
    assert links == {
        link for name in NAMES for link in ((f"{name}/map", f"{name}/odom"), (f"{name}/odom", f"{name}/base_footprint"))
    }


def test_real_robots_get_one_time_and_the_merged_frames(real):
    assert main([str(real), "--out", str(real / "x.mcap")]) == 0
    read = Read(real / "x.mcap")
    scans = {name: [time for time, _ in read.topics[f"/{name}/base_scan"]] for name in NAMES}
    assert scans["anna"] == scans["bob"] == [(5000 + second) * SECOND for second in range(1, 31)]
    assert read.topics["/bob/odom"][0][1].header.stamp.sec == 5001
    ties = read.ties()
    assert ties["anna/map"] == ("world", 0.0, 0.0, 0.0)
    assert ties["bob/map"] == pytest.approx(("world", 2.0, 1.0, math.pi / 2))
    assert "/bob/base_pose_ground_truth" not in read.topics, "nobody knows a world here"


def test_robots_that_nothing_ties_are_named(tmp_path, capsys):
    record(tmp_path / "anna" / "topics_1.bag", "anna", place=None)
    record(tmp_path / "carl" / "topics_1.bag", "bob", AHEAD, hears=False)
    assert main([str(tmp_path)]) == 0
    said = capsys.readouterr().err
    assert "nothing tells where carl was" in said and "nothing ties the clock of carl" in said
    assert "carl/map" not in Read(tmp_path / "mission.mcap").ties()


def test_one_bag_and_chosen_topics(real):
    bag = real / "anna" / "topics_2026-01-01.bag"
    assert main([str(bag), "--topics", "map", "/tf"]) == 0
    assert set(Read(bag.with_suffix(".mcap")).topics) == {"/anna/map", "/tf", "/tf_static"}
    assert main([str(bag), "--all", "--out", str(real / "all.mcap")]) == 0
    told = Read(real / "all.mcap").topics["/anna/position_other_robots"]
    assert len(told) == 30 and told[0][1].position.header.frame_id == "anna/map"


def test_what_is_refused(mission, capsys):
    def refused(*arguments):
        assert main([str(argument) for argument in arguments]) == 2
        return capsys.readouterr().err

    assert "does not exist" in refused(mission / "nothing")
    (mission / "empty").mkdir()
    assert "no bags in" in refused(mission / "empty")
    assert "has to end with .mcap" in refused(mission, "--out", "x.bag")
    assert "there is no folder" in refused(mission, "--out", mission / "no" / "x.mcap")
    assert "no robot has recorded scan; there are " in refused(mission, "--topics", "scan")
    (mission / "anna" / "anna.bag").write_bytes(b"something else")
    assert "anna.bag is no bag of ROS 1" in refused(mission)
    (mission / "anna" / "anna.bag").rename(mission / "anna" / "anna.bag.active")
    assert "was not closed: wait until its mission is over; if a crash left it so, 'rosbag reindex" in refused(mission)
    (mission / "mission.mcap").touch()
    assert "is there already" in refused(mission)
    assert not list(mission.glob(".*"))


def test_what_reindex_keeps_is_no_bag(tmp_path):
    """Once a bag that had been mended was refused for ever for the copy beside it."""
    with Bag(tmp_path / "topics_1.bag"):
        pass
    for name in ("topics_1.bag.orig.active", "topics_1.orig.bag", "topics_1.bag.orig"):
        (tmp_path / name).touch()
    (robot,) = find_recording(tmp_path).robots
    assert robot.bags == (tmp_path / "topics_1.bag",)


def test_a_bag_without_messages_is_as_good_as_none(mission, capsys):
    bag = mission / "anna" / "anna.bag"
    bag.unlink()
    with Bag(bag):
        pass
    assert main([str(mission)]) == 0
    assert "export: the bags of anna hold no message" in capsys.readouterr().err
    assert not any(topic.startswith("/anna/") for topic in Read(mission / "mission.mcap").topics)
    assert main([str(bag)]) == 2
    assert capsys.readouterr().err == f"export: no message in any bag of {bag.parent}\n"


def test_a_bag_of_two_clocks_is_refused(mission, capsys):
    """Once the file spanned half a century. The recorder had begun before time was simulated."""
    wall = 1_795_831_000 * SECOND
    record(mission / "bob" / "bob_of_now.bag", "bob", wall, simulated=True)
    (mission / "bob" / "bob_of_now.bag").rename(mission / "bob" / "bob.bag.1.bag")
    assert main([str(mission)]) == 2
    told = "export: bob: nothing was recorded from second 30 to 1795831001 of its clock, so times are those of"
    said = capsys.readouterr().err
    assert said.startswith(told) and "rosbag filter BAG PART.bag 't.to_sec() > 31' keeps" in said
    assert not list(mission.glob(".*")) and not (mission / "mission.mcap").exists()


def test_a_robot_whose_simulated_time_is_real_is_refused(mission, capsys):
    (mission / "bob" / "bob.bag").unlink()
    record(mission / "bob" / "bob.bag", "bob", 1_795_831_000 * SECOND, simulated=True)
    assert main([str(mission)]) == 2
    assert "export: anna: nothing was recorded from second 30 to 1795831030 of its clock" in capsys.readouterr().err


def test_a_robot_whose_clock_was_never_set_and_that_nothing_ties_is_exported(tmp_path, capsys):
    """It keeps its own time, as decades apart as that may be, and is no reason to refuse the others."""
    record(tmp_path / "anna" / "topics_1.bag", "anna", 1_795_831_000 * SECOND, hears=False)
    record(tmp_path / "bob" / "topics_1.bag", "bob", hears=False)
    assert main([str(tmp_path)]) == 0
    assert "export: nothing ties the clock of bob to the others" in capsys.readouterr().err


def test_messages_that_cannot_be_decoded_are_counted_and_left_out(mission, capsys):
    """Once one of them ended the export with a traceback."""
    bag, frame = mission / "anna" / "anna.bag", b"\x0f\0\0\0base_laser_link"
    octets = bag.read_bytes()
    place = octets.index(frame, octets.index(b"sensor_msgs/LaserScan"))
    status = octets.index(b"\x04\0\0\0anna\x0b\0\0\0distributed")
    octets = bytearray(octets)
    octets[place : place + 4] = octets[status : status + 4] = b"\xff\xff\xff\x7f"
    bag.write_bytes(octets)
    assert main([str(mission)]) == 0
    said = capsys.readouterr().err
    for topic in ("base_scan", "map_merger/status"):
        assert f"{bag}, {topic}: left out what cannot be decoded, messages: 1\n" in said
    assert len(Read(mission / "mission.mcap").topics["/anna/base_scan"]) == 29


def test_a_mission_that_cannot_be_read_is_not_said_to_be_unwritable(mission, capsys, monkeypatch):
    def refuse(path, **_):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(Path, "read_text", refuse)
    assert main([str(mission)]) == 2
    assert capsys.readouterr().err == f"export: {mission / PLAN_FILE} cannot be read: Permission denied\n"


def test_a_file_that_cannot_be_written_is_called_as_it_was_asked_for(mission, capsys):
    """It was called /proc/.mine.part."""
    assert main([str(mission), "--out", "/proc/mine.mcap"]) == 1
    said = capsys.readouterr().err.splitlines()[-1]
    assert said.startswith("export: /proc/mine.mcap cannot be written: ") and said.endswith("another place with --out")


def test_a_bag_that_ends_in_the_middle(mission, capsys):
    bag = mission / "anna" / "anna.bag"
    bag.write_bytes(bag.read_bytes()[:-2000])
    assert main([str(mission)]) == 2
    said = capsys.readouterr().err
    assert said.startswith("export: ") and "anna.bag cannot be read" in said and "rosbag reindex" in said
    assert not list(mission.glob(".*")) and not (mission / "mission.mcap").exists()


def test_without_rosbags_one_line_says_what_to_do(mission):
    paths = [path for path in os.environ["PYTHONPATH"].split(os.pathsep) if "python_environment" not in path]
    program = Path(__file__).resolve().parents[1] / "nodes" / "export"
    done = subprocess.run(
        [sys.executable, program, mission], env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 2 and done.stderr.startswith("export: the Python package rosbags is missing: run")


def test_robots_are_called_as_they_called_themselves(tmp_path):
    """Without robot_name:= the folder of each robot's records is called robot."""
    record(tmp_path / "robot" / "topics_1.bag", "anna")
    record(tmp_path / "bob" / "topics_1.bag", "bob")  # whose map_merger says nothing
    assert [robot.name for robot in find_recording(tmp_path).robots] == ["bob", "anna"]
    assert find_recording(tmp_path / "robot" / "topics_1.bag").robots[0].name == "anna"
    record(tmp_path / "attic" / "topics_1.bag", "anna")
    assert [robot.name for robot in find_recording(tmp_path).robots] == ["attic", "bob", "robot"]
