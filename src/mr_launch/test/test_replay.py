"""What a replay plays: stretches of time, topics, robots; and what it refuses. No ROS process is started."""

import math
import shlex
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest
from recorded_bags import SECOND, Bag
from test_launch_files import parameters_of

from mr_grid import Pose
from mr_launch.arguments import parse_arguments
from mr_launch.errors import UserError
from mr_launch.plan import PLAN_FILE, Plan, RobotPlan
from mr_launch.recordings import replay_command
from mr_launch.recordings.bags import Span, opened
from mr_launch.recordings.cut import cut, is_played
from mr_launch.recordings.inside import delay, look_inside
from mr_launch.recordings.recording import find_recording
from mr_launch.recordings.replay_command import COMPUTED, main, make_parser, make_plan, played_spans

PACKAGE = Path(__file__).resolve().parents[1]
ARGUMENTS = ("robot_name:=robot_0", "bag:=/x", "report_socket:=/x", "map_merger:=true", "explorer:=true")


def record(path, first, last, clock=True):
    """A static transform, the time, scans once a second; decisions of the nodes."""
    with Bag(path) as bag:
        bag.add(first * SECOND, "/tf_static", bag.tf(bag.transform(0, "base", "laser", 0.1)), 1, "/robot")
        for second in range(first, last + 1):
            if clock:
                bag.add(second * SECOND, "/clock", bag.clock(second * SECOND), 0, "/robot")
            bag.add(second * SECOND, "base_scan", bag.scan(second * SECOND), 0, "/robot")
            merged = bag.transform(second * SECOND, "map", "robot_1/map", 0.1)
            bag.add(second * SECOND, "/tf", bag.tf(merged), 0, "/map_merger")
            bag.add(second * SECOND, "move_base/status", bag.clock(second * SECOND), 1, "/move_base")
            bag.add(second * SECOND, "explorer/verdicts", bag.clock(second * SECOND), 1, "/adhoc_communication")
            bag.add(second * SECOND, "goalPoint/goalPoint", bag.clock(second * SECOND), 1, "/explorer")


def played(path, span, compute, folder):
    """{topic: times in s} of what is cut out of a bag."""
    with opened([path]) as reader:
        cut(reader, folder / "cut.bag", span, is_played(compute))
    found = {}
    with opened([folder / "cut.bag"]) as reader:
        for connection, time, _ in reader.messages():
            found.setdefault(connection.topic.strip("/"), []).append(time / SECOND)
        latching = {connection.topic.strip("/") for connection in reader.connections if connection.ext.latching}
    assert ("tf_static" in latching) == ("tf_static" in found) and "base_scan" not in latching
    return found


def test_a_stretch_begins_with_what_was_latched(tmp_path):
    record(tmp_path / "robot_0.bag", 1, 20)
    found = played(tmp_path / "robot_0.bag", Span(5 * SECOND + 1, 8 * SECOND), (), tmp_path)
    start = 5.0 + 1.0 / SECOND
    assert found["clock"] == [start], "the player tells the time"
    assert found["tf_static"] == [start]
    assert found["base_scan"] == [6, 7, 8]
    assert found["move_base/status"] == [start, 6, 7, 8]


def test_a_robot_that_began_late_has_the_same_stretch(tmp_path):
    record(tmp_path / "robot_0.bag", 10, 12)
    found = played(tmp_path / "robot_0.bag", Span(5 * SECOND, 20 * SECOND), (), tmp_path)
    assert found["clock"] == [5] and found["tf_static"] == [10] and found["base_scan"] == [10, 11, 12]


@pytest.mark.parametrize(
    ("compute", "gone"),
    [
        (["map_merger"], {"tf"}),
        (["explorer"], {"goalPoint/goalPoint", "move_base/status"}),
        (["map_merger", "explorer"], {"tf", "goalPoint/goalPoint", "move_base/status"}),
    ],
)
def test_what_is_computed_again_is_not_played(tmp_path, compute, gone):
    record(tmp_path / "robot_0.bag", 1, 3)
    span = Span(SECOND, 3 * SECOND)
    everything = set(played(tmp_path / "robot_0.bag", span, (), tmp_path))
    (tmp_path / "cut.bag").unlink()
    assert everything - set(played(tmp_path / "robot_0.bag", span, compute, tmp_path)) == gone


def test_stretches_count_from_the_first_message_of_any_robot(tmp_path):
    record(tmp_path / "a" / "a.bag", 3, 20)
    record(tmp_path / "b" / "b.bag", 5, 30)
    recording = find_recording(tmp_path)
    assert played_spans(recording, 0.0, math.inf) == dict.fromkeys("ab", Span(3 * SECOND, 30 * SECOND))
    assert played_spans(recording, 4.0, 10.0) == dict.fromkeys("ab", Span(7 * SECOND, 13 * SECOND))
    with pytest.raises(UserError, match=r"--from 40: the recording has 27\.0 s"):
        played_spans(recording, 40.0, math.inf)


def test_a_bag_of_two_clocks_is_refused_and_each_part_can_be_played(tmp_path):
    """Once its replay never came to the end. The recorder had begun before time was simulated."""
    wall = 1_795_831_000
    with Bag(tmp_path / "a" / "a.bag") as bag:
        for second in (*range(3, 20), *range(wall, wall + 5)):
            bag.add(second * SECOND, "base_scan", bag.scan(second * SECOND))
    recording = find_recording(tmp_path)
    told = (
        rf"a: nothing was recorded from second 16 to {wall - 3}, .*two clocks.*: --to 16 plays .*, --from {wall - 3} "
    )
    with pytest.raises(UserError, match=told):
        played_spans(recording, 0.0, math.inf)
    assert played_spans(recording, 0.0, 16.0) == {"a": Span(3 * SECOND, 19 * SECOND)}
    assert played_spans(recording, wall - 3.0, math.inf) == {"a": Span(wall * SECOND, (wall + 4) * SECOND)}


def test_a_robot_whose_simulated_time_is_real_is_named(tmp_path):
    record(tmp_path / "a" / "a.bag", 3, 20)
    record(tmp_path / "b" / "b.bag", 1_795_831_000, 1_795_831_009)
    with pytest.raises(UserError, match="a: nothing was recorded from second 17 to 1795831006"):
        played_spans(find_recording(tmp_path), 0.0, math.inf)


def test_robots_whose_clocks_nothing_ties_begin_together(tmp_path):
    record(tmp_path / "a" / "a.bag", 3, 20, clock=False)
    record(tmp_path / "b" / "b.bag", 1005, 1030, clock=False)
    spans = played_spans(find_recording(tmp_path), 1.0, math.inf)
    assert spans == {"a": Span(4 * SECOND, 28 * SECOND), "b": Span(1006 * SECOND, 1030 * SECOND)}


def test_what_is_refused(tmp_path, capsys):
    record(tmp_path / "a" / "a.bag", 3, 4)
    out = tmp_path / "out"

    def refused(*arguments):
        assert main([str(argument) for argument in (tmp_path / "a", "--out", out, *arguments)]) == 2
        assert not out.exists()
        return capsys.readouterr().err

    assert "--rate 0 is out of range: 0.01 to 20" in refused("--rate", 0)
    assert "--from -5 is no time of a recording, which begins at 0" in refused("--from", -5)
    assert "--from nan is no time of a recording" in refused("--from", "nan")
    assert "--from 5 --to 4: nothing lies between" in refused("--from", 5, "--to", 4)
    assert "--from 5: the recording has 1.0 s" in refused("--from", 5)
    assert "--strategy: strategy 99 is unknown; there are 0 " in refused("--strategy", 99)
    assert "--robot" in refused("--robot", "turtle") and "turtlebot" in refused("--robot", "turtle")
    out = tmp_path / "out,put"
    assert "out,put has a , in it, which launch files do not take" in refused()
    out = tmp_path / "out"
    (tmp_path / "a" / "a.bag").unlink()
    with Bag(tmp_path / "a" / "a.bag"):
        pass
    assert f"no message in any bag of {tmp_path / 'a'}" in refused()
    assert main([str(tmp_path / "a"), "--out", str(tmp_path / "a")]) == 2
    assert "is not an empty folder" in capsys.readouterr().err
    (tmp_path / "a" / "a.bag").write_bytes(b"x")
    assert "a.bag is no bag of ROS 1" in refused()


def test_presets_are_those_of_the_plan(tmp_path):
    """Once a file that was gone from the mission was said to be unwritable."""
    mission, out = tmp_path / "it,s", tmp_path / "out"
    record(mission / "a" / "a.bag", 3, 4)
    robots = [RobotPlan("a", 0, 11311, Pose(1.0, 2.0, 0.0), "a")]
    plan = Plan(parse_arguments(["--out", str(out)]), "w", robots, str(mission), "hub", presets={"a": "text"})
    (mission / PLAN_FILE).write_text(plan.to_json())
    options = make_parser().parse_args([str(mission), "--compute", "explorer", "--isolation", "hub"])
    (out / "played").mkdir(parents=True)
    (played_robot,) = make_plan(find_recording(mission), options, out, {}).robots
    preset = out / "robots" / "a.yaml"
    assert preset.read_text() == "text"
    assert {played_robot.arguments["robot"], played_robot.arguments["team"]} == {str(preset)}


@pytest.mark.parametrize(("first", "run"), [(0, "5.000000000"), (6, "9.000000000"), (13, "")])
def test_a_merger_runs_again_under_the_name_of_its_run_then(tmp_path, first, run):
    """What others told of its frame names that run: under another name a merger placed nobody by it, and where its own
    search came late the map lacked what the others had seen."""
    record(tmp_path / "a" / "a.bag", 1, 20)
    with Bag(tmp_path / "a" / "b.bag") as bag:
        for second, begun in ((2, 0), (6, 5), (9, 9), (12, 9)):
            grid = bag.grid(begun * SECOND, np.zeros((2, 3)))
            bag.add(second * SECOND, "map_merger/global_map", grid, 1, "/map_merger")
    arguments = [str(tmp_path / "a"), "--compute", "map_merger", "--isolation", "hub", "--from", str(first)]
    (tmp_path / "out" / "played").mkdir(parents=True)
    plan = make_plan(find_recording(tmp_path / "a"), make_parser().parse_args(arguments), tmp_path / "out", {})
    assert plan.robots[0].arguments["run"] == run
    parameters = parameters_of("replayed_robot.launch", *ARGUMENTS, f"run:={run}")
    assert parameters.get("/map_merger/run", "") == run


def test_nodes_run_again_as_on_a_robot(tmp_path):
    """Parameters of both nodes are those of robot.launch, but for the end of exploration and what needs a radio."""
    given = ("robot:=turtlebot", "team:=pioneer,turtlebot", "simulated:=true", f"robot_parameters:={tmp_path}")
    live = parameters_of("robot.launch", "robot_name:=robot_0", *given)
    again = parameters_of("replayed_robot.launch", *ARGUMENTS, *given)
    assert again["/use_sim_time"] is True
    for node in COMPUTED:
        own = [{key: value for key, value in found.items() if key.startswith(f"/{node}/")} for found in (live, again)]
        assert own[0] == own[1] and len(own[0]) > 5


def test_only_what_is_asked_for_runs_again():
    names = {
        node.get("name"): node
        for node in ElementTree.parse(PACKAGE / "launch" / "replayed_robot.launch").getroot().iter("node")
    }
    assert set(names) == {"player", "replay_monitor", "map_merger", "explorer", "move_base"}
    parameters = parameters_of("replayed_robot.launch", *ARGUMENTS[:3])
    assert parameters["/replay_monitor/nodes"] == "" and not any(key.startswith("/explorer") for key in parameters)


@pytest.mark.parametrize(("code", "told"), [(0, True), (130, True), (1, False)])
def test_after_a_failure_nothing_is_said_to_have_been_made(tmp_path, capsys, monkeypatch, code, told):
    record(tmp_path / "a" / "a.bag", 3, 4)
    monkeypatch.setattr(replay_command, "run_inside", lambda *_: code)
    arguments = [tmp_path / "a", "--out", tmp_path / "out", "--compute", "explorer", "--isolation", "hub"]
    assert main([str(argument) for argument in arguments]) == code
    assert ("what explorer made of it" in capsys.readouterr().out) == told


def test_a_replay_that_took_longer_than_asked_says_so():
    assert delay(18.0, 20.0) == delay(0.1, 0.3) == ""
    assert delay(2.0, 5.1) == " in 5 s, not 2 s: time waits for nodes that need longer"


def test_the_command_to_look_inside_can_be_copied(tmp_path, monkeypatch):
    """Also where the folder has a blank."""
    record(tmp_path / "my records" / "a" / "a" / "a.bag", 3, 4)
    plan = planned(tmp_path / "my records", "a")
    monkeypatch.chdir(tmp_path)
    assert shlex.split(look_inside(plan)) == [
        "rosrun", "mr_launch", "enter", "--team", "my records/out", "a", "rostopic", "list",
    ]  # fmt: skip


def record_base(path):
    """What a base station hears and merges."""
    with Bag(path) as bag:
        bag.add(3 * SECOND, "map_merger/global_map", bag.grid(3 * SECOND, np.zeros((2, 3))))
        bag.add(4 * SECOND, "all_positions", bag.positions("a", 3.0, 4.0))


def test_a_base_station_is_not_played(tmp_path, capsys):
    """Once the replay of the whole team failed for want of its map."""
    record(tmp_path / "records" / "a" / "a.bag", 3, 4)
    record_base(tmp_path / "records" / "base" / "topics_1.bag")
    assert [robot.name for robot in planned(tmp_path, "records").robots] == ["a"]
    assert capsys.readouterr().err == "replay: base has no body; it is not played\n"
    (tmp_path / "records" / "a" / "a.bag").unlink()
    with pytest.raises(UserError, match="base stations are not played"):
        planned(tmp_path, "records")


def planned(folder, mission, *arguments):
    out = folder / "out"
    (out / "played").mkdir(parents=True, exist_ok=True)
    options = make_parser().parse_args([str(folder / mission), "--isolation", "hub", *arguments])
    return make_plan(find_recording(folder / mission), options, out, {})


FRAMES = {"base_frame": "base", "odom_frame": "wheels"}


@pytest.mark.parametrize(
    ("frames", "arguments"),
    [
        (("wheels", "base"), FRAMES),
        (("/wheels", "/base"), FRAMES),
        (("odom", "base_footprint"), {}),
        (("odom", ""), {}),
    ],
)
def test_frames_that_the_launch_file_was_given_are_found_in_the_bags(tmp_path, frames, arguments):
    """Once explorer and navigation that ran again waited in vain for the robot's pose."""
    with Bag(tmp_path / "a" / "a.bag") as bag:
        bag.add(3 * SECOND, "base_pose_ground_truth", bag.odometry(3 * SECOND, ("world", "truth")))
        bag.add(4 * SECOND, "odom", bag.odometry(4 * SECOND, frames))
        bag.add(5 * SECOND, "base_scan", bag.scan(5 * SECOND))
        bag.add(5 * SECOND, "map", bag.grid(5 * SECOND, np.zeros((2, 3))))
    (robot,) = planned(tmp_path, "a", "--compute", "explorer").robots
    told = {word: value for word, value in robot.arguments.items() if word.endswith("_frame")}
    assert told == arguments
    parameters = parameters_of(
        "replayed_robot.launch", *ARGUMENTS, *(f"{word}:={value}" for word, value in told.items())
    )
    base = arguments.get("base_frame", "base_footprint")
    assert {parameters["/explorer/base_link"], parameters["/move_base/base_frame"]} == {base}


def record_drivers(path, *scans):
    with Bag(path) as bag:
        for topic in scans:
            bag.add(3 * SECOND, topic, bag.scan(3 * SECOND))
        bag.add(4 * SECOND, "/pose", bag.odometry(4 * SECOND))
        bag.add(4 * SECOND, "base_pose_ground_truth", bag.odometry(4 * SECOND))
        bag.add(5 * SECOND, "map", bag.grid(5 * SECOND, np.zeros((2, 3))))


@pytest.mark.parametrize(
    ("scans", "arguments", "note"),
    [
        (("/scan",), {"scan_topic": "scan"}, ""),
        (("base_scan",), {}, ""),
        (("base_scan", "rear"), {}, ""),
        (("front", "rear"), {}, "no scans on base_scan, only on front, rear; is --robot right?"),
        ((), {}, "no scans on base_scan, on no topic; is --robot right?"),
    ],
)
def test_topics_that_the_launch_file_was_given_are_found_in_the_bags(tmp_path, capsys, scans, arguments, note):
    """Once nodes that ran again waited in vain for those of the preset."""
    record_drivers(tmp_path / "a" / "a.bag", *scans)
    (robot,) = planned(tmp_path, "a", "--compute", "map_merger").robots
    told = {word: value for word, value in robot.arguments.items() if word.endswith("_topic")}
    assert told == {"odometry_topic": "pose", **arguments}
    assert note in capsys.readouterr().err if note else capsys.readouterr().err == ""
    words = [f"{word}:={value}" for word, value in told.items()]
    parameters = parameters_of("replayed_robot.launch", *ARGUMENTS, *words)
    assert parameters["/map_merger/position_local_robot_topic"] == "pose"
    assert parameters["/map_merger/scan_topic"] == arguments.get("scan_topic", "base_scan")
