"""Trace, maps, pictures and what roslaunch says about nodes."""

import io
import pickle

import cv2
import numpy as np
import pytest
import yaml
from rich.console import Console

from explorer.orders import PAUSED
from mr_grid import OccupancyGrid, Pose
from mr_launch.maps import load_raw, save_map, save_raw
from mr_launch.mission import Outcome
from mr_launch.nodes import MOST_RESTARTS, NodeWatch, parse_ends
from mr_launch.pictures import bounds, draw_mission
from mr_launch.processor_shares import cpu_shares, process_name
from mr_launch.reports import RobotReport
from mr_launch.results import exploration_end, last_finish
from mr_launch.truth import Truth
from mr_launch.view import Picture, RobotRow, live_table, plain_lines
from mr_launch.world import Meter, load_known
from mr_measures import truth as measures
from mr_measures.motion import read_trace
from mr_measures.truth import KnowableArea

HEADER = "# mr_sim trace 1 seed 1 real_time_factor 1 world w\ntime,wall,robot,x,y,yaw,v,w,stalled,collision\n"


def grid():
    cells = np.full((3, 4), -1, np.int8)
    cells[0] = 100  # lowest row
    cells[1, :2] = 0
    cells[1, 2] = 50
    return OccupancyGrid.of(cells, 0.05, Pose(-1.0, -2.0))


def write_trace(path, rows):
    path.write_text(HEADER + "".join(",".join(map(str, row)) + "\n" for row in rows))


def test_exploration_of_a_robot_ends_when_it_says_so_or_with_the_mission():
    outcome = Outcome(start=10.0, end=90.0)
    done = report(exploration_finished=True, exploration_time=50.0, start_time=12.5)
    assert exploration_end(done, outcome) == 62.5
    assert exploration_end(report(), outcome) == 90.0
    assert last_finish([done, report()], outcome) == 90.0


def test_trace_is_what_the_measures_read(tmp_path):
    rows = [(0.05 * n, 0.1 * n, "a", 0.01 * n, 0, 0, 0.2, 0.0, n % 2, 0) for n in range(5)]
    write_trace(tmp_path / "t.csv", rows)
    truth = Truth(tmp_path / "t.csv", ["a", "silent"])
    truth.update()
    assert (truth.tracks["a"].records() == read_trace(tmp_path / "t.csv").robots["a"]).all()
    assert truth.tracks["a"].records(0.1, 0.16)["x"].tolist() == pytest.approx([0.02, 0.03])
    assert truth.real_time_factor(0.0, 0.2) == pytest.approx(0.5) and truth.tracks["silent"].records().size == 0


def test_growing_trace_is_read_by_whole_lines(tmp_path):
    path = tmp_path / "t.csv"
    write_trace(path, [(0.0, 0.0, "a", 0, 0, 0, 0, 0, 0, 0)])
    with path.open("a") as file:
        file.write("0.05,0.05,a,1.")
    truth = Truth(path, ["a"])
    truth.update()
    assert truth.tracks["a"].records()["time"].tolist() == [0.0]
    with path.open("a") as file:
        file.write("5,0,0,0,0,0,0\n0.05,0.05,stranger,1,0,0,0,0,0,0\n# end simulated 1\n")
    truth.update()
    assert truth.tracks["a"].records()["x"].tolist() == [0.0, 1.5]
    assert truth.time == 0.05


def test_map_files_are_those_of_map_server(tmp_path):
    files = save_map(grid(), tmp_path / "map")
    assert [path.name for path in files] == ["map.pgm", "map.yaml", "map.png"]
    pixels = cv2.imread(str(files[0]), cv2.IMREAD_UNCHANGED)
    assert pixels.tolist() == [[205] * 4, [254, 254, 205, 205], [0] * 4]  # first row is the highest y
    entry = yaml.safe_load(files[1].read_text())
    assert entry["image"] == "map.pgm" and entry["resolution"] == 0.05 and entry["origin"] == [-1.0, -2.0, 0.0]


def test_raw_map_keeps_every_value(tmp_path):
    save_raw(grid(), tmp_path / "m.npz")
    loaded = load_raw(tmp_path / "m.npz")
    assert (loaded.cells == grid().cells).all() and loaded.cells.dtype == np.int8
    assert (loaded.resolution, loaded.origin) == (0.05, (-1.0, -2.0, 0.0))


def test_known_part_of_a_turned_map_in_the_world():
    left, right, bottom, top = bounds(grid(), Pose(10.0, 20.0, np.pi / 2))
    # Known cells: x -1.0 to -0.8, y -2.0 to -1.9; a quarter turn makes (x, y) to (-y, x).
    assert (left, right, bottom, top) == pytest.approx((11.9, 12.0, 19.0, 19.2))


def test_picture_is_written_even_without_known_cells(tmp_path):
    write_trace(tmp_path / "t.csv", [(0.0, 0.0, "a", 0, 0, 0, 0, 0, 0, 0), (0.1, 0.1, "a", 0.1, 0, 0, 0, 0, 0, 0)])
    truth = Truth(tmp_path / "t.csv", ["a", "silent"])
    truth.update()
    empty = OccupancyGrid.of(np.full((2, 2), -1, np.int8), 0.05)
    for number, map_ in enumerate((grid(), empty)):
        path = tmp_path / f"{number}.png"
        draw_mission(map_, Pose(0.0, 0.0, 0.0), truth.tracks, "title", path, dict.fromkeys(truth.tracks, (0.5, 0.4)))
        assert cv2.imread(str(path)).shape[0] > 100


def report(**values):
    entry = RobotReport("robot_0")
    entry.update(values)
    return entry


def test_cpu_shares_by_robot_and_node():
    before = {
        10: ("roslaunch", 1.0, 1),
        11: ("/usr/bin/python3 /x/slam __name:=slam", 2.0, 10),
        20: ("/x/world --w", 1.0, 1),
    }
    after = {
        10: ("roslaunch", 1.0, 1),
        11: ("/usr/bin/python3 /x/slam __name:=slam", 4.5, 10),
        20: ("/x/world --w", 2.0, 1),
    }
    assert cpu_shares(before, after, {"robot_0": 10}, 10.0) == {"robot_0": {"slam": 0.25}, "team": {"world": 0.1}}


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("/usr/bin/python3 /a/b/explorer __name:=explorer __log:=/x", "explorer"),
        ("/usr/bin/python3 -m mr_launch.inside 3", "mr_launch.inside"),
        ("/usr/bin/python3 /usr/bin/rosmaster --core", "rosmaster"),
        ("/x/radio --loss 0", "radio"),
        ("", "?"),
    ],
)
def test_process_names(command, name):
    assert process_name(command) == name


DIED = """[slam-3] process has died [pid 12, exit code -11, cmd /x/slam __name:=slam].
log file: /logs/slam-3*.log
[bag-8] process has finished cleanly
log file: /logs/bag-8*.log
[explorer-5] process has finished cleanly
log file: /logs/explorer-5*.log
"""


def test_ends_of_nodes_in_the_output_of_roslaunch():
    slam, explorer = parse_ends(DIED)
    assert slam.describe("robot_1") == "slam of robot_1 died (exit code -11); log: /logs/slam-3*.log"
    assert explorer.describe("robot_1") == "explorer of robot_1 ended; log: /logs/explorer-5*.log"


def test_logs_may_lie_in_a_folder_with_blanks():
    (end,) = parse_ends(
        "[slam-3] process has died [pid 1, exit code 1, cmd x].\nlog file: /my logs/slam-3*.log\x1b[0m\n"
    )
    assert end.log == "/my logs/slam-3*.log"


def test_end_of_the_recorder_counts_only_if_it_died():
    assert parse_ends("[bag-8] process has finished cleanly\n") == []
    assert len(parse_ends("[bag-8] process has died [pid 1, exit code 1, cmd x].\n")) == 1


def test_ends_that_are_followed_by_a_new_start_are_counted_while_they_are_few(tmp_path):
    """Coloured, as roslaunch writes them."""
    watch = NodeWatch(tmp_path / "robot_0.log", respawns=True)
    died = "\x1b[31m[explorer-4] process has died [pid 7, exit code -9, cmd x].\nlog file: /x*.log\x1b[0m\n"
    died += "[explorer-4] restarting process\n"
    (tmp_path / "robot_0.log").write_text(2 * died)
    assert watch.failures() == [] and watch.restarts == {"explorer": 2}
    (tmp_path / "robot_0.log").write_text(2 * died + died.replace("explorer", "robot"))
    assert [end.name for end in watch.failures()] == ["robot"]
    (tmp_path / "robot_0.log").write_text((MOST_RESTARTS + 1) * died)
    assert {end.name for end in watch.failures()} == {"explorer"}
    assert [end.name for end in NodeWatch(tmp_path / "robot_0.log").failures()][:1] == ["explorer"]


@pytest.mark.parametrize("respawns", [False, True])
def test_status_page_that_is_started_again_is_counted_and_ends_no_mission(tmp_path, respawns):
    died = "[page-9] process has died [pid 7, exit code -9, cmd x].\nlog file: /x*.log\n"
    (tmp_path / "robot_0.log").write_text((MOST_RESTARTS + 1) * died)
    watch = NodeWatch(tmp_path / "robot_0.log", respawns)
    assert watch.failures() == [] and watch.restarts == {"page": MOST_RESTARTS + 1}


def test_node_that_could_not_be_started():
    (end,) = parse_ends(
        "\x1b[31mERROR: cannot launch node of type [mr_robot/slam]: Cannot locate node of type [slam]\x1b[0m\n"
    )
    assert end.describe("robot_0") == "mr_robot/slam of robot_0 was not started: Cannot locate node of type [slam]"


def test_quiet_roslaunch_gives_no_ends(tmp_path):
    watch = NodeWatch(tmp_path / "robot_0.log")
    assert watch.new_ends() == []
    (tmp_path / "robot_0.log").write_text("started roslaunch server\n")
    assert watch.new_ends() == []


def test_what_a_map_knew_goes_to_the_runner(tmp_path):
    walls = OccupancyGrid.of(np.zeros((40, 40), np.int8), 0.05)
    everything = KnowableArea(np.zeros((1, 2)), np.ones((40, 40), dtype=bool))
    truth = measures.Truth(walls, (), (), 0.0, lambda *_: np.empty(0), everything)
    meter = Meter(str(tmp_path / "truth"), Pose(1.0, 1.0))
    left = OccupancyGrid.of(np.zeros((40, 20), np.int8), 0.05, Pose(-1.0, -1.0))
    meter.look(left, 3.0)
    meter.save(tmp_path / "a.npz")
    assert meter.is_due(3.0) and load_known({"a": tmp_path / "a.npz"}) == {}, "there is no reference yet"
    (tmp_path / "truth").write_bytes(pickle.dumps(truth))
    meter.look(left, 4.0)
    assert not meter.is_due(8.9) and meter.is_due(9.0)
    meter.save(tmp_path / "a.npz")
    since = load_known({"a": tmp_path / "a.npz", "b": tmp_path / "b.npz"})["a"]
    assert since.size == 1600 and (np.isfinite(since) == (truth.reference[:, 0] < 1.0)).all() and since.min() == 4.0


def test_plain_lines_say_it_all():
    row = RobotRow("robot_0", "exploring", 0.5, 30.0, 12.34, (-0.04, 2.0), ["robot_1"], [], "")
    lines = plain_lines(Picture("exploring", 61.0, 900.0, 0.99, [row]))
    assert lines[0] == "exploring, 61 s of 900 s, real-time factor 0.99"
    assert lines[1].strip() == (
        "robot_0: exploring, explored 50.0 %, 12.3 m, goal (0.0, 2.0), neighbours robot_1, merged with nobody"
    )


def test_lines_without_a_reference_say_why_there_is_no_share():
    """It is computed beside the mission: on a busy machine it was not there before the end."""
    rows = [
        RobotRow("robot_0", "exploring", None, 41.3, 12.34, None, [], [], ""),
        RobotRow("robot_1", "exploring", None, 0.0, 0.0, None, [], [], ""),
    ]
    picture = Picture("exploring", 61.0, 900.0, 0.99, rows)
    first, *robots = plain_lines(picture)
    assert first.endswith("factor 0.99, no shares yet: the reference of the world is still being computed")
    assert "explored 41 m^2, " in robots[0] and "explored nothing yet, " in robots[1]
    console = Console(file=io.StringIO(), width=200)
    console.print(live_table(picture))
    shown = console.file.getvalue()
    assert "41 m^2" in shown and "%" not in shown


def test_a_mission_that_is_about_to_begin_has_no_negative_time() -> None:
    """The first line of a mission said "-0 s"."""
    for elapsed in (-0.2, -1.2):
        assert plain_lines(Picture("exploring", elapsed, 900.0, None, []))[0].startswith("exploring, 0 s of 900 s")


def test_a_paused_robot_does_not_merely_wait() -> None:
    report = RobotReport("robot_0")
    report.update({"state": 2, "text": PAUSED})
    assert report.state_name == "paused"
    report.update({"text": "nothing to do at the moment"})
    assert report.state_name == "waiting"
