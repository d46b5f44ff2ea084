"""Maps of map_server as worlds."""

import math

import cv2
import numpy as np
import pytest

from mr_sim.map_world import MapError, map_world_files
from mr_sim.world import World, WorldError
from mr_sim.world_model import load_world
from mr_sim.worlds import StartsError, WorldNotFoundError, find_world, starts_of, warning_of, with_starts

FREE, UNKNOWN, OCCUPIED = 254, 205, 0


@pytest.fixture
def write_map(tmp_path):
    """Writes a room of 4 m x 3 m (row 0 of `pixels` at the bottom) with unknown around, and returns the path."""

    def write(pixels=None, **values):
        cv2.imwrite(str(tmp_path / "plan.pgm"), np.flipud(room() if pixels is None else pixels))
        keys = {"image": "plan.pgm", "resolution": 0.05, "origin": [-1.0, 2.0, 0.0], "negate": 0,
                "occupied_thresh": 0.65, "free_thresh": 0.196, **values}  # fmt: skip
        text = "".join(f"{key}: {value}\n" for key, value in keys.items() if value is not None)
        (tmp_path / "plan.yaml").write_text(text)
        return tmp_path / "plan.yaml"

    return write


def room():
    pixels = np.full((100, 120), UNKNOWN, dtype=np.uint8)
    pixels[20:80, 20:100] = OCCUPIED
    pixels[22:78, 22:98] = FREE
    return pixels


def load(path, tmp_path, starts=()):
    return load_world(find_world(str(path), tmp_path / "worlds", starts))


def test_robots_stand_where_they_are_told_to_and_see_the_walls(write_map, tmp_path):
    starts = starts_of([1.0, 4.0, 90.0, 2.0, 4.5, 0.0])
    world = World(load(write_map(), tmp_path, starts))
    assert world.names == ("robot_0", "robot_1")
    assert world.pose(0) == pytest.approx((1.0, 4.0, math.pi / 2))
    ranges = world.core.scan(1, 0)
    ahead = ranges[len(ranges) // 2]
    # The free part ends at column 98: x = -1 + 98 * 0.05 = 3.9; the laser is 0.1 m ahead of the robot.
    assert ahead == pytest.approx(3.9 - 2.1, abs=0.06)


def test_world_is_closed_and_unknown_is_wall(write_map, tmp_path):
    pixels = room()
    pixels[40:60, 90:105] = FREE  # a gap in the wall, behind which the map knows a little
    pixels[30:34, 30:34] = UNKNOWN
    world = World(load(write_map(pixels), tmp_path, starts_of([1.0, 4.5, 0.0])))
    assert world.core.contact_at(0, (0.4, 3.6, 0.0)) == 1, "what is unknown within the room"
    assert world.core.contact_at(0, (4.0, 4.5, 0.0)) == 0
    assert world.core.contact_at(0, (4.2, 4.5, 0.0)) == 1, "the end of what is known"
    cells = world.obstacles.cells
    assert cells[[0, -1], :].all() and cells[:, [0, -1]].all()


@pytest.mark.parametrize(
    ("start", "fault"),
    [([100.0, 100.0, 0.0], "outside the walls at (100, 100)"), ([-0.5, 2.5, 0.0], "outside the walls at (-0.5, 2.5)"),
     ([0.4, 3.6, 0.0], "inside a wall at (0.4, 3.6)")],
)  # fmt: skip
def test_starts_off_the_map_and_in_the_unknown_are_refused(write_map, tmp_path, start, fault):
    pixels = room()
    pixels[22:42, 22:42] = UNKNOWN
    with pytest.raises(WorldError) as caught:
        World(load(write_map(pixels), tmp_path, starts_of([1.0, 4.5, 0.0, *start])))
    assert f"robot_1 starts {fault}: move its pose to free floor" in str(caught.value)
    assert "from x 0.05 to 3.95 m and from y 3.05 to 5.95 m" in str(caught.value)


def test_starts_outside_a_turned_map_are_refused(write_map, tmp_path):
    """Also where its walls' bounding box holds them."""
    path = write_map(origin=[0.0, 0.0, math.pi / 4])
    World(load(path, tmp_path, starts_of([0.3, 4.2, 0.0])))
    with pytest.raises(WorldError, match="robot_0 starts outside the walls"):
        World(load(path, tmp_path, starts_of([2.2, 2.2, 0.0])))


def test_turned_map(write_map, tmp_path):
    """Its origin is the pose of the lower left pixel."""
    description = load(write_map(origin=[1.0, 2.0, math.pi / 2]), tmp_path, starts_of([-1.5, 5.0, 0.0]))
    world = World(description)
    # The free part spans 3.8 m along y from 2 + 1.1 and 2.8 m along -x from 1 - 1.1.
    assert world.obstacles.origin == pytest.approx((1 - 3.95, 2 + 1.05), abs=0.051)
    assert world.core.contact_at(0, (-2.6, 5.0, 0.0)) == 0 and world.core.contact_at(0, (-2.8, 5.0, 0.0)) == 1


def test_without_starts_there_is_one_robot_where_most_room_is(write_map, tmp_path):
    description = load(write_map(), tmp_path)
    (robot,) = description.robots
    assert robot.start[1] == pytest.approx(2.0 + 50 * 0.05, abs=0.06)
    world = World(with_starts(description, starts_of([1, 4, 0, 2, 4, 0, 3, 4, 0])))
    assert world.names == ("robot_0", "robot_1", "robot_2") and world.pose(2) == (3.0, 4.0, 0.0)


def test_negated_and_scaled_maps(write_map, tmp_path):
    plain = map_world_files(write_map())
    assert map_world_files(write_map(255 - room(), negate=1)).picture == plain.picture
    assert map_world_files(write_map(mode="scale")).picture == plain.picture


def test_other_contents_have_another_name(write_map):
    names = {map_world_files(write_map()).stem, map_world_files(write_map(resolution=0.1)).stem,
             map_world_files(write_map(), starts_of([1, 4, 0])).stem}  # fmt: skip
    assert len(names) == 3
    assert map_world_files(write_map()).stem in names


@pytest.mark.parametrize("resolution", ["5e-2", "1e-1"])
def test_numbers_that_yaml_takes_for_text_are_numbers(write_map, resolution):
    map_world_files(write_map(resolution=resolution))


def test_map_gives_no_warning(write_map, tmp_path):
    path = write_map()
    assert warning_of(str(path), load(path, tmp_path)) == ""


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"image": None}, "has the keys image, resolution and origin"),
        ({"image": "none.pgm"}, "none.pgm, is no file"),
        ({"image": "plan.yaml"}, "plan.yaml, is no image that can be read (pgm, png"),
        ({"resolution": 0}, '"resolution" must be positive, not 0'),
        ({"resolution": "fine"}, "\"resolution\" must be a number, not 'fine'"),
        ({"origin": "[1, 2]"}, '"origin" must be [x, y, yaw]'),
        ({"origin": "[1, 2, west]"}, '"origin" must be a number'),
        ({"mode": "raw"}, '"mode" must be trinary or scale'),
        ({"free_thresh": 0.0}, "nothing in the map is free"),
        ({"free_thresh": 10**400}, '"free_thresh" must be a number, not 1000'),
        ({"negate": "'0'"}, "\"negate\" must be 0 or 1, not '0'"),
        ({"image": "a" * 300}, "is no file"),
        ({"image": "[unclosed"}, ": is no YAML: expected"),
    ],
)
def test_faults_are_told(write_map, tmp_path, values, message):
    path = write_map(**values)
    with pytest.raises(WorldNotFoundError) as caught:
        find_world(str(path), tmp_path)
    assert str(caught.value).startswith(str(path)) and message in str(caught.value)
    assert "\n" not in str(caught.value)
    with pytest.raises(MapError):
        map_world_files(path)


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ([1.0], "--starts takes X Y DEGREES for each robot, not 1 numbers"),
        ([1.0, 2.0, 3.0, 4.0], "for each robot, not 4 numbers"),
        ([1.0, 2.0, math.nan], "--starts takes finite numbers"),
    ],
)
def test_starts_that_are_none(numbers, message):
    with pytest.raises(StartsError, match=message):
        starts_of(numbers)


def test_starts_need_a_robot_to_stand_there(write_world):
    with pytest.raises(StartsError, match="has no robot that could stand"):
        with_starts(load_world(write_world("model ( )")), starts_of([1, 2, 3]))
