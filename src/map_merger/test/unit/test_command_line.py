"""The command line: one answer for two maps, several maps merged, and one line for what cannot be used."""

import json
import math
import os
import re
import subprocess
import sys

import numpy as np
import pytest

from map_merger import placement
from map_merger.command_line.arguments import main
from map_merger.one_shot import confidence_in, criteria_for, decide
from map_merger.reasons import reason_of
from map_merger.registration import Verdict
from map_merger.surface import landmarks_of
from map_merger.synthetic import Survey, Surveyor, office_plan, pair_of
from map_merger.transform import rotation_between
from mr_grid import GridInfo, OccupancyGrid, Pose, empty_grid
from mr_grid.map_files import read_map, write_map

WITHOUT_ROS = """
import sys
for name in ("rospy", "genpy", "std_msgs", "nav_msgs", "adhoc_communication", "matplotlib"):
    sys.modules[name] = None
from map_merger.command_line.arguments import main
sys.exit(main(sys.argv[1:]))
"""


@pytest.fixture(scope="module")
def three():
    """Maps of three robots in one building, and the true transforms into the first one's frame."""
    random = np.random.default_rng(5)
    surveyor = Surveyor(office_plan(random))
    survey = Survey(path_length=25.0)
    first = surveyor.explore(random, survey)
    others = [surveyor.explore(random, survey, start=tuple(first.path[0, :2]), yaw=yaw) for yaw in (2.4, -1.0)]
    return [first.grid] + [each.grid for each in others], [pair_of(first, each).truth for each in others]


@pytest.fixture(scope="module")
def folder(three, tmp_path_factory):
    folder = tmp_path_factory.mktemp("maps")
    for name, grid in zip("abc", three[0]):
        write_map(str(folder / name), grid)
    write_map(str(folder / "nothing"), empty_grid(GridInfo(50, 40, 0.05)))
    return folder


def test_two_maps_give_a_transform_as_json(three, folder, capsys):
    assert main(["register", str(folder / "a.yaml"), str(folder / "b.yaml"), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    found, truth = Pose(answer["x"], answer["y"], answer["yaw"]), three[1][0]
    assert math.hypot(found.x - truth.x, found.y - truth.y) < 0.1 and rotation_between(found, truth) < 0.01
    assert answer["accepted"] and 0.85 < answer["confidence"] <= 0.93 and answer["shared_wall_m"] >= 25.0


def test_a_pair_that_is_declined_gives_the_reason_with_numbers_and_exit_code_3(folder, capsys):
    assert main(["register", str(folder / "a.yaml"), str(folder / "nothing.yaml"), "--json"]) == 3
    answer = json.loads(capsys.readouterr().out)
    assert "x" not in answer and answer["confidence"] == 0.0 and "no transform" in answer["reason"]
    assert main(["register", str(folder / "a.yaml"), str(folder / "nothing.yaml")]) == 3
    assert "is not placed" in capsys.readouterr().out


def test_only_what_is_sure_is_accepted_on_request(tmp_path, capsys):
    """Two maps of one room are believed, but there may be a copy of the room."""
    random = np.random.default_rng(9)
    surveyor = Surveyor(office_plan(random))
    for name, start in (("a", (2.0, 2.4)), ("b", (2.6, 3.0))):
        write_map(str(tmp_path / name), surveyor.explore(random, Survey(path_length=2.0), start=start).grid)
    paths = [str(tmp_path / "a.yaml"), str(tmp_path / "b.yaml")]
    assert main(["register", *paths, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["sure"] is False
    assert main(["register", *paths, "--sure", "--json"]) == 3
    answer = json.loads(capsys.readouterr().out)
    assert not answer["accepted"] and "x" not in answer and "may be a copy: shared wall" in answer["reason"]


def test_a_prior_narrows_the_search(three, folder, capsys):
    truth = three[1][0]
    near = [str(truth.x + 1.0), str(truth.y - 1.0), str(truth.yaw + 0.2)]
    assert main(["register", str(folder / "a.yaml"), str(folder / "b.yaml"), "--prior", *near]) == 0
    assert main(["register", str(folder / "a.yaml"), str(folder / "b.yaml"), "--prior", "50", "-50", "0"]) == 3
    capsys.readouterr()


def test_all_maps_are_merged_in_the_frame_of_the_first_one(three, folder, tmp_path, capsys):
    maps, _ = three
    paths = [str(folder / f"{name}.yaml") for name in "abc"]
    assert main(["merge", *paths, "-o", str(tmp_path / "all")]) == 0
    assert "3 of 3 maps" in capsys.readouterr().out
    merged = read_map(str(tmp_path / "all.yaml"))
    alone = [np.count_nonzero(each.cells != -1) for each in maps]
    assert np.count_nonzero(merged.cells != -1) > max(alone)
    shift = (maps[0].info.origin.x - merged.info.origin.x, maps[0].info.origin.y - merged.info.origin.y)
    column, row = (round(each / merged.info.resolution) for each in shift)
    same = merged.cells[row : row + maps[0].info.height, column : column + maps[0].info.width]
    known = maps[0].cells != -1
    assert np.array_equal(same[known] >= 50, maps[0].cells[known] >= 50)


def test_a_map_that_cannot_be_placed_is_named_and_the_others_are_merged(folder, tmp_path, capsys):
    paths = [str(folder / f"{name}.yaml") for name in ("a", "nothing", "b")]
    assert main(["merge", *paths, "-o", str(tmp_path / "all")]) == 3
    printed = capsys.readouterr()
    assert "2 of 3 maps" in printed.out and "nothing.yaml is not placed: no transform" in printed.err
    assert (tmp_path / "all.pgm").exists()


def test_a_map_is_placed_through_another_one(tmp_path, capsys):
    """The first and the last map share nothing; both share much with the one between."""
    random = np.random.default_rng(11)
    whole = Surveyor(office_plan(random)).explore(random, Survey(path_length=120.0), yaw=0.0).grid
    width, resolution = whole.info.width, whole.info.resolution
    cuts = {"left": (0, 0.4), "right": (0.6, 1.0), "middle": (0.1, 0.9)}
    for name, (left, right) in cuts.items():
        part = whole.cells[:, int(left * width) : int(right * width)]
        # Every map has a frame of its own: its corner.
        write_map(str(tmp_path / name), OccupancyGrid(GridInfo(part.shape[1], part.shape[0], resolution), part))
    paths = [str(tmp_path / f"{name}.yaml") for name in cuts]
    assert main(["register", *paths[:2]]) == 3
    assert main(["merge", *paths, "-o", str(tmp_path / "all")]) == 0
    (line,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith(paths[1] + ":")]
    assert f"through {paths[2]}" in line
    x = float(re.search(r"x (\S+) m", line)[1])
    assert x == pytest.approx(int(0.6 * width) * resolution, abs=0.1)


def test_a_map_whose_walls_stand_in_the_free_space_of_the_others_is_not_placed(three, monkeypatch):
    maps, _ = three

    def misled(target, source):
        result = decide(target, source)
        if source.info.origin != landmarks_of(maps[2]).info.origin:
            return result
        return result._replace(transform=Pose(1.5, 1.0, 0.0).compose(result.transform))

    monkeypatch.setattr(placement, "decide", misled)
    found = placement.place(maps)
    assert set(found.placed) == {1} and "free space" in found.declined[2]


def test_a_room_of_several_equal_ones_is_declined_with_both_solutions():
    """Two rooms of 4.1 m x 4.9 m side by side, equal cell by cell, and the map of one of them."""
    room = np.zeros((98, 82), np.int8)
    room[[0, -1]] = 100
    room[:, 0] = 100
    room[20:35, 30:60] = room[50:90, 60:70] = 100
    target = np.concatenate([room, room, room[:, :1]], axis=1)
    maps = [OccupancyGrid(GridInfo(cells.shape[1], 98, 0.05), cells) for cells in (target, target[:, :83])]
    result = decide(*(landmarks_of(grid) for grid in maps))
    assert result.verdict is Verdict.AMBIGUOUS and result.rival.apart > 2.0
    solutions = [each for each in (result.transform, *result.rivals)]
    for x in (0.0, 4.1):
        assert any(pose == pytest.approx((x, 0.0, 0.0), abs=0.06) for pose in solutions)
    assert re.match(r"two solutions \S+ m.* apart, with", reason_of(result, criteria_for(None)))
    assert confidence_in(result) == 0.0


def test_the_benchmark_prints_a_table_of_so_many_pairs(capsys):
    assert main(["bench", "1"]) == 0
    table = capsys.readouterr().out
    assert "right imprecise wrong declined" in table and "two maps" in table


def test_a_picture_shows_both_maps(folder, tmp_path, capsys):
    path = tmp_path / "over.png"
    assert main(["register", str(folder / "a.yaml"), str(folder / "b.yaml"), "--plot", str(path)]) == 0
    capsys.readouterr()
    import cv2

    picture = cv2.imread(str(path))
    blue, orange = np.array([178, 114, 0]), np.array([0, 94, 213])
    for colour in (blue, orange):
        assert np.count_nonzero(np.abs(picture.astype(int) - colour).max(axis=2) < 40) > 200


@pytest.mark.parametrize(
    "arguments, text",
    [
        (["register", "{a}", "missing.yaml"], "missing.yaml: No such file"),
        (["merge", "{a}", "{b}", "-o", "/nowhere/at/all"], "/nowhere/at/all"),
        (["merge", *["{a}"] * 65, "-o", "all"], "at most 64 maps"),
        (["register", "{a}", "{b}", "--plot", "/nowhere/at/all.png"], "/nowhere/at/all.png"),
    ],
)
def test_what_cannot_be_read_or_written_gives_one_line_and_exit_code_2(folder, capsys, arguments, text):
    assert main([each.format(a=folder / "a.yaml", b=folder / "b.yaml") for each in arguments]) == 2
    error = capsys.readouterr().err
    assert text in error and error.count("\n") == 1


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["register", "a.yaml"],
        ["register", "a.yaml", "b.yaml", "--prior", "1", "nan", "0"],
        ["register", "a.yaml", "b.yaml", "--plot", "out.jpeg"],
        ["register", "a.yaml", "b.yaml", "--prior", "1", "0", "0", "--sure"],
        ["merge", "a.yaml"],
        ["bench", "0"],
    ],
)
def test_wrong_usage_has_exit_code_2(capsys, arguments):
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2 and "usage" in capsys.readouterr().err


def test_neither_ros_nor_matplotlib_is_needed(folder):
    command = [sys.executable, "-c", WITHOUT_ROS, "register", str(folder / "a.yaml"), str(folder / "b.yaml")]
    result = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (result.returncode, result.stderr) == (0, "") and "confidence" in result.stdout


def test_the_package_runs_as_a_module():
    command = [sys.executable, "-m", "map_merger", "register", "no.yaml", "no.yaml"]
    result = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False, env=dict(os.environ))
    assert result.returncode == 2 and result.stderr == "map_merger: no.yaml: No such file or directory\n"


def test_before_the_build_it_is_one_line_what_to_do():
    code = "import sys; sys.modules['mr_grid'] = None; from runpy import run_module; run_module('map_merger')"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert found.returncode == 1 and found.stderr.count("\n") == 1
    assert "build first (make build), then source tools/environment.sh" in found.stderr
