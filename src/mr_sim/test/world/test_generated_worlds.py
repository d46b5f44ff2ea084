"""Generated worlds as the simulator takes them: their files, their robots, what of them can be known."""

import numpy as np
import pytest

from mr_measures import truth
from mr_measures.reference import load_reference, reference_path
from mr_measures.stored_truth import stored_path, truth_of_generated
from mr_measures.truth import Truth
from mr_plans import WORLD_KINDS
from mr_plans.passable import NARROW_CELLS
from mr_robot.navigation.options import NavigationOptions
from mr_robot.platforms.engines import defaults_of
from mr_sim.simulated_platform import platform_of
from mr_sim.true_world import true_world_of
from mr_sim.world import World
from mr_sim.world_model import load_world
from mr_sim.world_names import name_of
from mr_sim.worlds import WorldNotFoundError, files_of, find_world, label_of


@pytest.mark.parametrize("kind", WORLD_KINDS)
def test_sixteen_robots_stand_free_in_every_kind(kind, tmp_path):
    world = World(load_world(find_world(f"generated:{kind}:3", tmp_path)), 16)
    assert [robot.name for robot in world.robots] == [f"robot_{number}" for number in range(16)]
    length, depth = WORLD_KINDS[kind].size
    assert world.visible.cells.shape == (round(depth / 0.05), round(length / 0.05))
    assert all(edge.all() for edge in (world.visible.cells[0], world.visible.cells[:, -1]))


@pytest.mark.parametrize(("robots", "views"), [("turtlebots", [57, 57, 57]), ("mixed", [270, 57, 270])])
def test_other_robots_stand_in_the_same_plan(robots, views, tmp_path):
    world = load_world(find_world(f"generated:rooms:3:18x12:{robots}", tmp_path))
    usual = load_world(find_world("generated:rooms:3:18x12", tmp_path))
    assert [round(np.degrees(robot.rangers[0].field_of_view)) for robot in world.robots[:3]] == views
    assert [robot.start for robot in world.robots] == [robot.start for robot in usual.robots]
    World(world, 16)


HUSKY = """define husky position ( size [ 0.99 0.67 0.39 ] localization "odom"
  ranger ( update_interval 50 pose [ 0.35 0 0 0 ] sensor ( range [ 0.1 {reach} ] fov 270 samples 1081 ) ) )"""


def test_robots_of_ones_own_drive_in_a_generated_world(tmp_path):
    """Only ours could: others needed a world file of their own for every floor."""
    robot, out = tmp_path / "husky.inc", tmp_path / "out"
    robot.write_text(HUSKY.format(reach=30))
    name = f"generated:hall:3:{robot}"
    path = find_world(name, out)
    world = World(load_world(path), 16)
    assert platform_of(world.robots[0]).footprint.length == 0.99 and world.robots[0].rangers[0].range_max == 30.0
    assert {file.suffix for file in files_of(path)} == {".world", ".inc", ".png"} and label_of(name).endswith("husky")
    robot.write_text(HUSKY.format(reach=20))
    other = find_world(name, out)
    assert other != path and load_world(other).robots[0].rangers[0].range_max == 20.0
    assert load_world(path).robots[0].rangers[0].range_max == 30.0, "worlds of before keep their robots"


def test_a_generated_world_has_one_name_wherever_its_robot_is_looked_for_from(tmp_path, monkeypatch):
    (tmp_path / "husky.inc").write_text(HUSKY.format(reach=30))
    monkeypatch.chdir(tmp_path)
    assert name_of("generated:hall:3:husky.inc") == f"generated:hall:3:{(tmp_path / 'husky.inc').resolve()}"
    assert name_of("generated:hall:3:nobody.inc") == "generated:hall:3:nobody.inc"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "husky.inc has to define husky"),
        ("define husky model ( size [ 1 1 1 ] )", "has to define husky as a position model"),
        ("define husky position ( size [ 1 1 1 ] )", "no laser"),
        ("define husky position ( sise [ 1 1 1 ] )", r"husky.inc:1: .*did you mean .size"),
        (None, "cannot be read: No such file"),
    ],
)
def test_a_file_that_describes_no_robot_is_one_clear_error(text, told, tmp_path):
    robot = tmp_path / "husky.inc"
    if text is not None:
        robot.write_text(text)
    with pytest.raises(WorldNotFoundError, match=told):
        find_world(f"generated:hall:3:{robot}", tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("kind", ["rooms", "narrow", "cave"])
def test_the_measures_find_all_of_it_reachable_from_any_start(kind, tmp_path):
    description = load_world(find_world(f"generated:{kind}:5:18x12", tmp_path))
    first = Truth.of_world(true_world_of(World(description, 1)))
    anywhere = World(load_world(find_world(f"generated:{kind}:5:18x12:anywhere", tmp_path)), 16)
    everywhere = Truth.of_world(true_world_of(anywhere))
    assert np.array_equal(first.reference, everywhere.reference) and len(first.reference) * first.cell_area > 30.0


def test_openings_that_count_as_passable_suit_navigation():
    assert NavigationOptions(**defaults_of(NavigationOptions)).inscribed_radius <= (NARROW_CELLS + 0.5) * 0.05


def test_files_are_written_once_and_anew_when_they_are_not_those_of_the_seed(tmp_path):
    path = find_world("generated:office:7:20x15", tmp_path)
    picture = path.with_suffix(".png")
    before = picture.stat().st_mtime_ns
    reference_path(path).write_text("{}")
    assert find_world("generated:office:7:20x15", tmp_path) == path and picture.stat().st_mtime_ns == before
    assert reference_path(path).exists()
    picture.write_bytes(b"of former code")
    find_world("generated:office:7:20x15", tmp_path)
    assert picture.stat().st_size > 100 and not reference_path(path).exists(), "a reference of another plan must go"


def test_what_cannot_be_drawn_is_one_clear_error(tmp_path):
    for name in ("generated:castle:1", "generated:office", "generated:office:1:3x3"):
        with pytest.raises(WorldNotFoundError):
            find_world(name, tmp_path)
        assert not list(tmp_path.iterdir())
    assert label_of("generated:hall:1:37.5x20") != label_of("generated:hall:1:37.5x21")
    assert label_of("/a/b/office.world") == label_of("office") == "office"


def test_the_knowable_area_is_computed_once_and_is_that_of_the_definition(tmp_path, monkeypatch):
    path = find_world("generated:rooms:2:15x10", tmp_path)
    world = true_world_of(World(load_world(path), 2))
    expected = Truth.of_world(world)
    assert np.array_equal(truth_of_generated(world, path).reference, expected.reference)
    monkeypatch.setattr(Truth, "_viewpoints", None)
    again = truth_of_generated(true_world_of(World(load_world(path), 1)), path)
    assert np.array_equal(again.reference, expected.reference)
    assert np.array_equal(again.viewpoints, expected.viewpoints)


def test_a_stored_area_of_other_walls_or_a_broken_one_does_not_count(tmp_path):
    path = find_world("generated:rooms:2:15x10", tmp_path)
    other = find_world("generated:rooms:3:15x10", tmp_path)
    truth_of_generated(true_world_of(World(load_world(other), 1)), path)
    world = true_world_of(World(load_world(path), 1))
    expected = Truth.of_world(world).reference
    assert np.array_equal(truth_of_generated(world, path).reference, expected)
    stored_path(path).write_bytes(stored_path(path).read_bytes()[:1000])
    assert np.array_equal(truth_of_generated(world, path).reference, expected)


@pytest.mark.parametrize("world", ["office26x15", "equalrooms26x15"])
def test_the_knowable_area_is_what_robots_explore(world, monkeypatch):
    """Against the stored missions of one robot: their maps draw a cell of wall where the reference keeps clear of walls
    by two."""
    path = find_world(world)
    explored = load_reference(path)
    monkeypatch.setattr(truth, "WALL_MARGIN", 0.05)
    known = Truth.of_world(true_world_of(World(load_world(path), 1))).reference
    assert len(known) == pytest.approx(explored.median, rel=0.01)
