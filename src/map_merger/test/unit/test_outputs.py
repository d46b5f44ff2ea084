"""What is shown of a team: status, outlines, saved maps."""

import dataclasses
import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from map_merger.markers import MOST_OUTLINE_POINTS, colour_of, marker_of, outline_of
from map_merger.status import MergerStatus, RobotPlacement, summary_of
from mr_grid import GridInfo, OccupancyGrid, Pose, empty_grid
from mr_grid.map_files import MapFileError, read_map, save_map

INFO = GridInfo(60, 40, 0.1, Pose(-2.0, 1.0, 0.5))


def grid(rows, columns, info=INFO):
    """A map in which a rectangle is known."""
    cells = np.full(info.shape, -1, np.int8)
    cells[rows, columns] = 0
    return OccupancyGrid(info, cells)


def test_the_outline_of_a_rectangle_is_its_corner_cells():
    outline = outline_of(grid(slice(5, 30), slice(10, 50)))
    cells = INFO.cells_of(outline)
    assert INFO.inside(cells).all()
    assert set(map(tuple, cells.tolist())) == {(5, 10), (5, 49), (29, 10), (29, 49)}


def test_only_the_largest_part_is_outlined_and_nothing_where_nothing_is_known():
    both = grid(slice(5, 30), slice(10, 50))
    both.cells[38:40, 57:60] = 0
    assert np.array_equal(outline_of(both), outline_of(grid(slice(5, 30), slice(10, 50))))
    assert outline_of(empty_grid(INFO)).shape == (0, 2)
    assert outline_of(grid(slice(3, 4), slice(3, 4))).shape == (1, 2)


@given(st.integers(0, 2**32 - 1), st.integers(1, 900), st.integers(1, 900))
def test_any_outline_is_bounded_and_around_known_cells(seed, width, height):
    info = GridInfo(width, height, 0.05)
    cells = np.random.default_rng(seed).choice(np.array([-1, 0, 100], np.int8), info.shape)
    outline = outline_of(OccupancyGrid(info, cells))
    assert len(outline) <= MOST_OUTLINE_POINTS
    assert (outline >= 0.0).all() and (outline <= (width * 0.05 + 0.1, height * 0.05 + 0.1)).all()


def test_the_outline_of_a_large_map_is_quick():
    info = GridInfo(2000, 2000, 0.05)
    large = grid(slice(10, 1990), slice(5, 1980), info)
    began = time.process_time()
    for _ in range(3):
        outline_of(large)
    assert (time.process_time() - began) / 3 < 0.1


def test_a_marker_is_in_the_own_frame():
    frame = Pose(1.0, 2.0, np.pi / 2.0)
    marker = marker_of("robot_1", Pose(1.0, 0.0, 0.0), np.array([[2.0, 0.0]]), frame)
    assert marker.pose == pytest.approx((1.0, 3.0, np.pi / 2.0))
    assert marker.outline[0] == pytest.approx((1.0, 4.0))
    assert marker_of("robot_1", None, np.empty((0, 2)), frame).pose is None


def test_a_name_always_has_the_same_colour_and_others_another():
    colours = {colour_of(f"robot_{number}") for number in range(10)}
    assert len(colours) == 10 and colour_of("robot_3") == colour_of("robot_3")


def test_a_placement_is_checked():
    assert not RobotPlacement("robot_1", "not heard").placed
    assert RobotPlacement("robot_1", "", Pose()).placed
    for wrong in (-0.1, 1.5, float("nan")):
        with pytest.raises(ValueError):
            RobotPlacement("robot_1", "", confidence=wrong)
    with pytest.raises(dataclasses.FrozenInstanceError):
        RobotPlacement("robot_1", "").why = "x"


def test_the_summary_names_who_is_missing_and_why():
    robots = (RobotPlacement("a", "shared wall 41.0 m", Pose()), RobotPlacement("b", "shared wall 7.0 m of 14 m"))
    assert summary_of(MergerStatus("r", "distributed", "", robots)) == (
        "1 of 2 robots placed; b: shared wall 7.0 m of 14 m"
    )


@pytest.mark.parametrize(
    ("state", "text"),
    [
        (
            MergerStatus("r", "distributed", "", (), awaited="the robot's own map on map"),
            "waits for the robot's own map on map",
        ),
        (MergerStatus("r", "distributed", "", ()), "no other robot was heard of"),
        (MergerStatus("r", "centralized", "base", ()), "waits for the base station base, which was not heard of"),
        (MergerStatus("base", "centralized", "base", ()), "no other robot was heard of"),
        (
            MergerStatus("r", "centralized", "base", (RobotPlacement("base", "told by base", Pose()),)),
            "1 of 1 robots placed",
        ),
    ],
)
def test_the_summary_says_why_nothing_happens(state, text):
    assert summary_of(state) == text


def test_a_map_is_saved_where_it_was_asked_for_and_the_answer_says_where(tmp_path, monkeypatch):
    known = grid(slice(5, 30), slice(10, 50))
    monkeypatch.chdir(tmp_path)
    picture, text = save_map("floor", known)
    assert (picture, text) == (str(tmp_path / "floor.pgm"), str(tmp_path / "floor.yaml"))
    assert np.array_equal(read_map(text).cells, known.cells)


@pytest.mark.parametrize(
    "path, problem",
    [("", "path must be"), ("folder/", "path must be"), ("a\0b", "path must be"), ("no/such/floor", "No such file")],
)
def test_a_map_that_cannot_be_saved_says_why(tmp_path, monkeypatch, path, problem):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(MapFileError, match=problem):
        save_map(path, grid(slice(5, 30), slice(10, 50)))
    with pytest.raises(MapFileError, match="no map yet"):
        save_map("floor", None)
