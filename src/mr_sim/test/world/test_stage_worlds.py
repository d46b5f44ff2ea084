"""World files as they are written for Stage: all of them load, and what has no effect is told in one line."""

import math

import numpy as np
import pytest

from mr_sim import world_process
from mr_sim.bitmap import rectangles
from mr_sim.raster import rasterise
from mr_sim.world import World, WorldError
from mr_sim.world_file import WorldFileError
from mr_sim.world_model import load_world
from mr_sim.world_words import words_of

SIMPLE = """
include "robots.inc"
include "plans.inc"
include "lasers.inc"
quit_time 60 paused 1 size [ 16 16 ] resolution 0.02 show_clock 1 threads 2 confirm_on_quit 0
window ( size [ 635 666 ] scale 36.9 center [ 0 0 ] rotate [ 0 0 ] show_data 1 )
floorplan ( name "cave" size [ 8 8 0.8 ] pose [ 0 0 0 0 ] bitmap "bitmaps/cave.png" )
zone ( pose [ 2 2 0 0 ] ctrl "sink" )
runabout ( name "r0" pose [ -3 -3 0 45 ] lms ( pose [ 0 0 0 0 ] ) ctrl "wander"
  localization "gps" localization_origin [ 0 0 0 0 ] )
"""
ROBOTS = """
define echo sensor ( size [ 0.01 0.05 0.01 ] range [ 0 5 ] fov 15 samples 1 color_rgba [ 0 1 0 0.2 ] )
define ring ranger ( echo ( pose [ 0.1 0.1 0 90 ] ) echo ( pose [ 0.2 0 0 0 ] ) echo ( pose [ 0.1 -0.1 0 -90 ] ) )
define base position ( color "red" drive "diff" gui_nose 1 obstacle_return 1 ranger_return 0.5 blob_return 1
  fiducial_return 1 velocity_bounds [ -0.5 0.5 0 0 0 0 -90 90 ] acceleration_bounds [ -0.5 0.5 0 0 0 0 -90 90 ] )
define runabout base ( size [ 0.44 0.38 0.22 ] origin [ -0.04 0 0 0 ] mass 23 ring ( pose [ 0 0 -0.03 0 ] )
  block ( points 4 point[0] [ -0.2 0.1 ] point[1] [ -0.2 -0.1 ] point[2] [ 0.2 -0.1 ] point[3] [ 0.2 0.1 ] z [ 0 1 ] ) )
"""
PLANS = """
define floorplan model ( color "gray30" boundary 1 gui_nose 0 gui_grid 0 gui_move 0 gui_outline 0 gripper_return 0
  fiducial_return 0 ranger_return 0.5 obstacle_return 1 )
define zone model ( color "orange" size [ 4 4 0.02 ] gui_move 1 obstacle_return 0 ranger_return -1 )
"""
LASERS = """
define lms ranger ( sensor ( range [ 0 8 ] fov 180 samples 361 color_rgba [ 0 0 1 0.1 ] ) color "blue"
  size [ 0.156 0.155 0.19 ]
  block ( points 4 point[0] [ 0 0 ] point[1] [ 1 0 ] point[2] [ 1 1 ] point[3] [ 0 1 ] z [ 0 0.2 ] ) )
"""


@pytest.fixture
def load(write_world):
    return lambda text: load_world(write_world(text))


def body(load, text: str) -> np.ndarray:
    """Corners (4, 2) of the last part of a robot that holds this."""
    return np.array(load(f"position ( size [ 1 1 1 ] {text} )").robots[0].footprint[-1])


def extent(corners) -> list[float]:
    """Least and largest x and y."""
    xs, ys = np.array(corners).T
    return [xs.min(), xs.max(), ys.min(), ys.max()]


def test_the_world_that_everybody_tries_first(write_world, image, tmp_path):
    (tmp_path / "bitmaps").mkdir()
    pixels = np.full((40, 40), 255, dtype=np.uint8)
    pixels[[0, -1], :] = pixels[:, [0, -1]] = 0
    image("bitmaps/cave.png", pixels)
    path = write_world(SIMPLE, robots_inc=ROBOTS, plans_inc=PLANS, lasers_inc=LASERS)
    description = load_world(path)
    world = World(description, seed=1)
    (robot,) = world.robots
    assert [ranger.samples for ranger in robot.rangers] == [1, 361, 1, 1], (
        "stageros offers the ring's first and the laser"
    )
    assert robot.main_ranger == 1
    assert description.quit_time == 60 and robot.exact_localization
    world.command(0, 0.5, 0.0)
    for _ in range(3):
        world.step()
    assert world.pose(0)[0] > -3.0
    assert world.core.scan(0, 1).max() > 5.0
    assert description.warning == (
        "without effect here: models window; words acceleration_bounds, blob_return, color, color_rgba, "
        "confirm_on_quit, ctrl, fiducial_return, gripper_return, gui_grid, gui_move, gui_nose, gui_outline, mass, "
        "paused, show_clock, size, threads, z"
    )
    assert "\n" not in description.warning


# What Stage 4.3 reads and what has no effect here, kept apart from the code's own lists.
OF_WORLDS = "show_clock show_clock_interval threads paused confirm_on_quit test"
OF_ALL_MODELS = (
    "ctrl color color_rgba gui_nose gui_grid gui_outline gui_move fiducial_return fiducial_key blob_return "
    "gripper_return watts give_watts take_watts joules joules_capacity kjoules kjoules_capacity mass friction "
    "map_resolution stack_children trail_length trail_interval say alwayson debug event_queue"
)
OF_MODELS = {
    "model": "", "position": "acceleration_bounds velocity wheelbase",
    "fiducial": "range_min range_max range_max_id fov ignore_zloc", "bumper": "bcount bpose blength",
    "gripper": "autosnatch", "blinkenlight": "enabled period dutycycle",
    "blobfinder": "colors_count colors image range fov pan", "camera": "resolution range fov pantilt",
    "actuator": "type axis min_position max_position max_speed start_position",
    "lightindicator": "", "wifi": "", "power": "", "charger": "", "loadcell": "", "speech": "",
}  # fmt: skip


@pytest.mark.parametrize("kind", OF_MODELS)
def test_every_word_of_stage_is_known_where_it_stands(load, kind):
    words = f"{OF_ALL_MODELS} {OF_MODELS[kind]}".split()
    assert set(words) <= words_of(kind)
    world = load(f"{kind} ( {' '.join(f'{word} 1' for word in words)} )")
    assert "unknown" not in world.warning
    assert (kind in world.warning) == (kind not in ("model", "position"))


def test_every_word_of_stage_is_known_outside_of_models(load):
    words = OF_WORLDS.split()
    world = load(" ".join(f"{word} 1" for word in words))
    assert "unknown" not in world.warning and all(word in world.warning for word in words)
    assert {"size", "color", "color_rgba"} <= words_of("sensor") and {"z", "color"} <= words_of("block")


def test_nothing_to_warn_of(load):
    assert load("position ( ranger ( sensor ( samples 3 ) ) )").warning == ""


def test_unknown_word_that_is_like_no_other_is_passed_over_with_its_place(load):
    world = load("position (\n flux_capacitor 3 )")
    assert world.warning.startswith("without effect here: unknown words flux_capacitor (")
    assert world.warning.endswith("test.world:2)")


def test_known_word_in_the_wrong_place_is_no_misspelling(load):
    assert (
        load("model ( points 3 samples 4 velocity 1 )").warning
        == "without effect here: words points, samples, velocity"
    )
    outside = load("position ( ranger ( fov 90 samples 32 range_max 5 sensor ( fov 180 samples 7 ) ) )")
    assert outside.robots[0].rangers[0].samples == 7
    assert outside.warning == "without effect here: words fov, range_max, samples"


def test_words_of_other_blocks_are_named_too(load):
    assert "paddle" not in load("position ( gripper ( paddle_size [ 0.5 0.2 1 ] autosnatch 1 ) )").warning
    assert words_of("gripper") >= {"paddle_size", "paddle_state", "autosnatch", "pose", "ctrl"}


def test_second_definition_is_told(load):
    assert (
        '"a" is defined already and stays as it was' in load("define a model ( ) define a model ( boundary 1 )").warning
    )


# --- Bodies ---


@pytest.mark.parametrize(
    ("kind", "size"),
    [("camera", (0.1, 0.07)), ("blinkenlight", (0.02, 0.02)), ("bumper", (0.4, 0.4)), ("lightindicator", (0.4, 0.4)),
     ("actuator", (0.4, 0.4)), ("charger", (0.4, 0.4)), ("model", (0.4, 0.4))],
)  # fmt: skip
def test_models_keep_their_body(load, kind, size):
    x, y = size[0] / 2, size[1] / 2
    corners = body(load, f"{kind} ( pose [ 1 0 0 0 ] ) ranger ( )")
    assert extent(corners) == pytest.approx([1 - x, 1 + x, -y, y])
    assert extent(load(f"{kind} ( )").obstacles[0].polygons[0]) == pytest.approx([-x, x, -y, y])


@pytest.mark.parametrize("kind", ["fiducial", "blobfinder", "ranger", "laser", "wifi", "power"])
def test_models_without_a_body(load, kind):
    assert len(load(f"position ( {kind} ( pose [ 1 0 0 0 ] ) )").robots[0].footprint) == 1
    world = load(f"{kind} ( )")
    assert world.obstacles == () and kind in world.warning


def test_blocks_of_a_laser_are_part_of_the_robot(load):
    block = "block ( points 3 point[0] [ 0 0 ] point[1] [ 1 0 ] point[2] [ 0 1 ] )"
    assert extent(body(load, f"ranger ( size [ 0.2 0.4 1 ] pose [ 1 0 0 90 ] {block} )")) == pytest.approx(
        [0.8, 1.2, -0.1, 0.1]
    )


@pytest.mark.parametrize(("state", "low"), [('"open" "down"', -0.3), ('"closed" "down"', -0.15)])
def test_gripper_has_a_base_and_two_fingers(load, state, low):
    gripper = f"gripper ( size [ 0.4 0.6 0.2 ] paddle_size [ 0.5 0.25 0.4 ] paddle_state [ {state} ] pose [ 1 0 0 0 ] )"
    base, right, left = load(f"position ( {gripper} )").robots[0].footprint[1:]
    assert extent(base) == pytest.approx([0.8, 1.0, -0.3, 0.3])
    assert extent(right) == pytest.approx([1.0, 1.2, low, low + 0.15])
    assert extent(left) == pytest.approx([1.0, 1.2, -low - 0.15, -low])


def test_charging_station_of_models_keeps_all_its_bodies(load):
    station = """
    define station model ( size [ 0.1 0.3 0.1 ]
      model ( size [ 0.1 0.05 0.25 ] pose [ 0 0.1 0 0 ] )
      model ( size [ 0.05 0.2 0.1 ] pose [ 0.01 0 0 0 ] joules -1 give_watts 1000 fiducial_return 2 alwayson 1 ) )
    station ( pose [ 4 0 0 180 ] )
    """
    assert [obstacle.pose[0] for obstacle in load(station).obstacles] == pytest.approx([4.0, 4.0, 3.99])


def test_parts_may_hold_parts(load):
    corners = body(
        load, "model ( pose [ 1 0 0 90 ] size [ 0.1 0.1 1 ] bumper ( pose [ 0.5 0 0 0 ] size [ 0.2 0.4 1 ] ) )"
    )
    assert extent(corners) == pytest.approx([0.8, 1.2, 0.4, 0.6])


def test_part_without_obstacle_return_is_no_body(load):
    assert len(load("position ( camera ( obstacle_return 0 ) ranger ( ) )").robots[0].footprint) == 1


def test_robot_from_a_bitmap_is_solid_where_it_is_dark(write_world, image):
    pixels = np.full((4, 4), 255, dtype=np.uint8)
    pixels[:, 0] = pixels[0, :] = 0  # an L
    image("shape.png", pixels)
    wall = "model ( size [ 0.2 0.2 1 ] pose [ 0.3 0.3 0 0 ] )"
    robot = 'position ( name "a" bitmap "shape.png" size [ 1 1 1 ] )'
    world = World(load_world(write_world(f"interval_sim 100 {wall} {robot}")))
    assert world.core.contact_at(0, (0.0, 0.0, 0.0)) == 0
    assert world.core.contact_at(0, (0.5, 0.0, 0.0)) == 1


def test_rectangles_cover_dark_pixels_once():
    pixels = np.random.default_rng(3).random((9, 12)) < 0.5
    covered = np.zeros(pixels.shape, dtype=int)
    for left, low, right, high in rectangles(pixels):
        covered[low:high, left:right] += 1
    assert np.array_equal(covered, pixels.astype(int))


def test_robot_with_a_boundary(load):
    footprint = load("position ( size [ 1 0.6 1 ] boundary 1 )").robots[0].footprint
    assert len(footprint) == 5 and extent(np.concatenate(footprint)) == pytest.approx([-0.5, 0.5, -0.3, 0.3])


def test_noblocks(load):
    world = load("model ( noblocks 1 ) model ( noblocks 1 boundary 1 size [ 1 1 1 ] pose [ 0.5 0.5 0 0 ] )")
    assert len(world.obstacles) == 1
    cells = rasterise(world.obstacles, 0.1).cells
    assert cells[0].all() and not cells[5, 5]
    (robot,) = load("position ( noblocks 1 )").robots
    assert robot.footprint == robot.seen == () and not robot.solid


# --- Sensors ---


@pytest.mark.parametrize(
    ("rangers", "main"),
    [
        ([("180", 180, 181), ("0", 180, 181)], 1),
        ([("180", 270, 541), ("0", 180, 181)], 1),
        ([("0", 57, 160), ("0", 359, 360)], 1),
        ([("0", 57, 160), ("180", 359, 360)], 1),
        ([("180", 270, 541)], 0),
        ([("180", 270, 541), ("0", 15, 1)], 0),
        ([("-90", 270, 541), ("0", 180, 181)], 0),
    ],
)
def test_a_robot_finds_its_way_by_what_looks_ahead(load, rangers, main):
    """Of a laser at the back and one at the front the first was taken: the robot drove blindly."""
    models = " ".join(
        f"ranger ( pose [ 0 0 0 {yaw} ] sensor ( range [ 0 8 ] fov {fov} samples {samples} ) )"
        for yaw, fov, samples in rangers
    )
    assert load(f"position ( size [ 1 1 1 ] {models} )").robots[0].main_ranger == main


def test_ring_of_sonars_in_the_older_words(load):
    (robot,) = load(
        "position ( ranger ( pose [ 0.1 0 0 0 ] scount 3 spose[1] [ 0.2 0.1 90 ] sview [ 0.1 4 15 ] ) )"
    ).robots
    assert len(robot.rangers) == 3
    ranger = robot.rangers[1]
    assert ranger.mount == pytest.approx((0.3, 0.1, math.pi / 2))
    assert (ranger.range_min, ranger.range_max, ranger.samples) == (0.1, 4.0, 1)


def test_ranger_that_no_robot_carries_is_passed_over(load):
    assert "ranger that no robot carries" in load("ranger ( sensor ( ) )").warning
    mounted = load("position ( model ( ranger ( sensor ( ) ) ) )")
    assert mounted.robots[0].rangers == () and "not mounted on the robot itself" in mounted.warning


def test_camera_beside_a_ranger_is_passed_over(load):
    (robot,) = load("position ( camera ( resolution [ 32 32 ] pantilt [ 0 0 ] ) ranger ( ) )").robots
    assert len(robot.rangers) == 1


# --- Numbers ---


def test_units_of_length_and_angle(load):
    text = """
    unit_length "cm" unit_angle "radians" resolution 0.05
    position ( pose [ 100 200 0 1.5 ] size [ 40 30 10 ] velocity_bounds [ -50 50 0 0 0 0 -1 1 ]
      ranger ( sensor ( range [ 10 600 ] fov 3 samples 9 noise [ 1 0.1 0 ] pose [ 10 0 0 0.5 ] ) ) )
    """
    world = load(text)
    (robot,) = world.robots
    assert world.resolution == 0.05, "the resolution is in metres whatever the unit"
    assert robot.start == pytest.approx((1.0, 2.0, 1.5))
    assert extent(robot.footprint[0]) == pytest.approx([-0.2, 0.2, -0.15, 0.15])
    assert robot.linear_bounds == (-0.5, 0.5) and robot.angular_bounds == (-1.0, 1.0)
    ranger = robot.rangers[0]
    assert (ranger.range_min, ranger.range_max, ranger.field_of_view) == pytest.approx((0.1, 6.0, 3.0))
    assert ranger.mount == pytest.approx((0.1, 0.0, 0.5)) and ranger.noise_variance == pytest.approx(0.01)


def test_tuples_of_stages_own_files(load):
    """Bumpers with a size of four numbers, robots with a size of two and an origin of three."""
    (robot,) = load("position ( size [ 0.6 0.5 ] origin [ -0.1 0 0 ] bumper ( size [ 0.2 0.2 0.2 0 ] ) )").robots
    assert extent(robot.footprint[0]) == pytest.approx([-0.4, 0.2, -0.25, 0.25])


def test_quit_time_0_is_for_ever(load):
    assert load("quit_time 0").quit_time is None


# --- Behaviour ---


def test_robot_without_obstacle_return_meets_nothing(write_world):
    wall = "model ( size [ 0.2 4 1 ] pose [ 1.1 0 0 0 ] )"
    world = World(load_world(write_world(f"interval_sim 100 {wall} position ( obstacle_return 0 )")))
    for _ in range(20):
        world.command(0, 1.0, 0.0)
        world.step()
    assert world.pose(0)[0] > 1.5 and not world.states()[0]["stalled"]


def test_zone_is_neither_seen_nor_met(write_world):
    zone = "model ( size [ 4 4 0.02 ] obstacle_return 0 ranger_return -1 )"
    robot = "position ( ranger ( sensor ( range [ 0 5 ] samples 3 ) ) )"
    world = World(load_world(write_world(zone + robot)))
    assert (world.core.scan(0, 0) == 5.0).all()


def test_what_cannot_be_is_one_clear_error(load):
    with pytest.raises(WorldFileError, match=r'test\.world:1: "drive" must be "diff".* not "car"'):
        load('position ( drive "car" )')
    with pytest.raises(WorldFileError, match=r'test\.world:1: a camera is the only sensor of "robot_0"'):
        load("position ( camera ( ) )")
    with pytest.raises(WorldError, match="defines 0 robots; asked for 1: "):
        World(load("model ( )"), 1)
    with pytest.raises(WorldError, match="defines 0 robots: "):
        World(load("model ( )"))


def test_the_world_process_tells_what_it_passes_over_once(write_world, capsys):
    path = write_world('position ( ctrl "wander" )')
    world_process.main(["--world", str(path), "--socket", "x" * 200])
    assert capsys.readouterr().out == f"world: warning: {path}: without effect here: words ctrl\n"
