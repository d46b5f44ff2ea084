"""Meaning of world files."""

import math

import numpy as np
import pytest

from mr_sim.bitmap import load_bitmap
from mr_sim.raster import rasterise
from mr_sim.world_file import WorldFileError
from mr_sim.world_model import load_world


@pytest.fixture
def load(write_world):
    return lambda text: load_world(write_world(text))


def test_robot_with_all_its_words(load):
    world = load(
        """
        interval_sim 20 resolution 0.05 speedup 4 quit_time 60
        position (
          name "r2d2" pose [ 1 2 0 90 ] size [ 0.6 0.4 0.3 ] origin [ 0.1 0 0 0 ] drive "diff"
          update_interval 40 velocity_bounds [ -0.3 0.7 0 0 0 0 -45 60 ]
          acceleration_bounds [ -1 1 0 0 0 0 -180 180 ]
          localization "odom" localization_origin [ 0 0 0 0 ] odom_error [ 0.01 0.02 0.03 0.04 ]
          ranger ( update_interval 80 pose [ 0.2 0 0 0 ]
            sensor ( pose [ 0.05 0 0 10 ] range [ 0.1 6 ] fov 180 samples 181 noise [ 0.0004 0.02 0 ] ) )
        )
        """
    )
    assert (world.interval, world.resolution, world.speedup, world.quit_time) == (0.02, 0.05, 4.0, 60.0)
    (robot,) = world.robots
    assert robot.name == "r2d2"
    assert robot.start == pytest.approx((1, 2, math.pi / 2))
    assert np.allclose(robot.footprint, [[(-0.2, -0.2), (0.4, -0.2), (0.4, 0.2), (-0.2, 0.2)]])
    assert robot.linear_bounds == (-0.3, 0.7)
    assert robot.angular_bounds == pytest.approx((-math.pi / 4, math.pi / 3))
    assert not robot.exact_localization
    assert robot.localization_origin == (0, 0, 0)
    assert robot.odom_error == (0.01, 0.02, 0.03, 0.04)
    assert robot.update_interval == 0.04
    (ranger,) = robot.rangers
    assert ranger.mount == pytest.approx((0.25, 0, math.radians(10)))
    assert (ranger.range_min, ranger.range_max, ranger.samples) == (0.1, 6, 181)
    assert ranger.angle_min == pytest.approx(-math.pi / 2)
    assert ranger.angle_increment == pytest.approx(math.radians(1))
    assert (ranger.update_interval, ranger.noise_variance, ranger.noise_share) == (0.08, 0.0004, 0.02)


def test_defaults_are_those_of_stage(load):
    (robot,) = load("position ( pose [ 3 4 0 0 ] )").robots
    assert robot.name == "robot_0"
    assert robot.exact_localization
    assert robot.localization_origin == robot.start
    assert robot.linear_bounds == (-1, 1)
    assert robot.angular_bounds == pytest.approx((-math.pi / 2, math.pi / 2))
    assert robot.odom_error == (0.03, 0.03, 0.0, 0.05)
    assert robot.update_interval == 0.1
    assert load("").interval == 0.1


def test_older_words_of_a_laser(load):
    (robot,) = load("position ( laser ( range_max 12 fov 90 samples 91 ) )").robots
    assert (robot.rangers[0].range_max, robot.rangers[0].samples) == (12, 91)


def test_several_sensors_become_several_rangers(load):
    (robot,) = load("position ( ranger ( sensor ( samples 1 ) sensor ( samples 2 pose [ 0 0 0 180 ] ) ) )").robots
    assert [r.samples for r in robot.rangers] == [1, 2]


def test_words_of_the_window_have_no_effect(load):
    plain = load("position ( )")
    decorated = load(
        'window ( size [ 700 500 ] scale 30 show_data 1 anything "goes" )\nthreads 4 show_clock 1 paused 0\n'
        'position ( color "red" gui_nose 1 gui_grid 0 gui_outline 1 gui_move 1 watts 10 fiducial_return 1 mass 20 )'
    )
    assert decorated.robots == plain.robots


def test_nested_models_are_placed_relative_to_their_parent(load):
    world = load("model ( pose [ 1 1 0 90 ] size [ 1 1 1 ] model ( pose [ 2 0 0 0 ] origin [ 0.5 0 0 0 ] ) )")
    assert world.obstacles[1].pose == pytest.approx((1, 3.5, math.pi / 2))


def test_model_on_a_robot_belongs_to_its_footprint(load):
    (robot,) = load("position ( size [ 1 1 1 ] model ( size [ 0.2 0.2 1 ] pose [ 0.6 0 0 0 ] ) )").robots
    assert np.allclose(robot.footprint[1], [(0.5, -0.1), (0.7, -0.1), (0.7, 0.1), (0.5, 0.1)])


def test_blocks_are_scaled_to_the_size(load):
    world = load(
        "model ( size [ 4 2 1 ] block ( points 3 point[0] [ 0 0 ] point[1] [ 10 0 ] point[2] [ 0 10 ] z [ 0 1 ] ) )"
    )
    assert np.allclose(world.obstacles[0].polygons, [[(-2, -1), (2, -1), (-2, 1)]])


def test_bitmap_is_cropped_to_its_walls_and_fills_the_size(load, image):
    pixels = np.full((10, 20), 255, dtype=np.uint8)
    pixels[2:8, 3:13] = 0
    pixels[4:6, 5:10] = 255
    image("plan.png", pixels)
    world = load('resolution 0.1 model ( bitmap "plan.png" size [ 1.0 0.6 1 ] pose [ 0.5 0.3 0 0 ] )')
    assert load_bitmap(world.obstacles[0].bitmap).shape == (6, 10)
    grid = rasterise(world.obstacles, world.resolution)
    assert grid.origin == (0.0, 0.0)
    assert np.array_equal(grid.cells, pixels[2:8, 3:13] == 0)


@pytest.mark.parametrize("degrees", [90, 180, 270])
def test_bitmap_may_be_turned(load, image, degrees):
    pixels = np.full((4, 8), 255, dtype=np.uint8)
    pixels[0, :] = pixels[:, 0] = pixels[3, 7] = 0
    image("plan.png", pixels)
    x, y = (0.2, 0.4) if degrees != 180 else (0.4, 0.2)
    world = load(f'model ( bitmap "plan.png" size [ 0.8 0.4 1 ] pose [ {x} {y} 0 {degrees} ] )')
    cells = rasterise(world.obstacles, 0.1).cells
    assert np.array_equal(cells, np.rot90(pixels == 0, -degrees // 90))


def test_fine_walls_of_a_bitmap_survive_a_coarse_raster(load, image):
    pixels = np.full((100, 100), 255, dtype=np.uint8)
    pixels[0, :] = pixels[-1, :] = pixels[:, 0] = pixels[:, -1] = pixels[:, 47] = 0
    image("plan.png", pixels)
    world = load('model ( bitmap "plan.png" size [ 1 1 1 ] pose [ 0.5 0.5 0 0 ] )')
    cells = rasterise(world.obstacles, 0.1).cells
    assert cells.shape == (10, 10)
    assert cells[:, 4].all() and not cells[1:-1, 5].any()


def test_boundary_makes_a_wall_around(load):
    cells = rasterise(load("model ( size [ 1 1 1 ] boundary 1 pose [ 0.5 0.5 0 0 ] )").obstacles, 0.1).cells
    assert cells[0, :].all() and cells[-1, :].all() and cells[:, 0].all() and cells[:, -1].all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("resolutoin 0.02", 'unknown word "resolutoin" in "world", did you mean "resolution"?'),
        ('position ( driev "diff" )', 'unknown word "driev" in "position", did you mean "drive"?'),
        ("model ( gui_moove 1 )", 'did you mean "gui_move"?'),
        ("position ( ranger ( sensor ( fow 180 ) ) )", 'did you mean "fov"?'),
        ("position ( poze [ 0 0 0 0 ] )", 'did you mean "pose"?'),
        ("position ( size [ 1 1 1 ] psoe [ 0 0 0 0 ] )", 'did you mean "pose"?'),
        ('includ "x.inc"', 'did you mean "include"?'),
        ("position ( fiducial ( range_maxx 3 ) )", 'did you mean "range_max"?'),
        ("position ( ranger ( sensor ( sampels 3 ) ) )", 'did you mean "samples"?'),
        ('position ( drive "car" )', '"drive" must be "diff" or "omni", not "car"'),
        ('position ( name "r" camera ( ) )', 'a camera is the only sensor of "r"'),
        ('position ( name "r" model ( camera ( ) ) )', 'a camera is the only sensor of "r"'),
        ('unit_length "inch"', '"unit_length" must be "m" or "cm" or "mm", not "inch"'),
        ("position ( gripper ( paddle_size [ 1.2 0.1 0.4 ] ) )", "must be shares of the gripper"),
        ('position ( bitmap "none.png" )', "does not exist"),
        ("position ( ranger ( sensor ( model ( ) ) ) )", '"model" inside a sensor is not supported'),
        ('position ( localization "slam" )', '"gps" or "odom"'),
        ("position ( drive 3 )", "needs a string"),
        ("position ( pose [ 1 2 3 ] )", '"pose" needs 4 numbers'),
        ('position ( pose [ 1 2 3 "4" ] )', '"pose" needs 4 numbers'),
        ("position ( velocity_bounds [ 1 -1 0 0 0 0 -90 90 ] )", "minimum above its maximum"),
        ("position ( odom_error [ 0.03 -0.03 0 0 ] )", '"odom_error" must not be negative'),
        ("position ( odom_error [ 1e308 0 0 0 ] )", '"odom_error" has shares of the way, at most 100, not 1e+308'),
        ("position ( update_interval 0 )", "must be from 0.01 to 1e+07 ms, not 0"),
        ("position ( update_interval 1e300 )", "must be from 0.01 to 1e+07 ms, not 1e+300"),
        ("interval_sim 1e-300", '"interval_sim" must be from 0.01'),
        ("model ( " * 3000 + ")" * 3000, "blocks are nested deeper than 64"),
        ('position ( name "a" ) position ( name "a" )', '"a" is used by two robots'),
        ("position ( position ( ) )", '"position" inside a position model'),
        ('model ( bitmap "none.png" )', "does not exist"),
        ('model ( bitmap "" )', "needs a file name"),
        (f'model ( bitmap "{"a" * 300}" )', "does not exist"),
        (f'include "{"a" * 300}"', "no such file"),
        ("model ( size [ 1 -1 1 ] )", "must not be negative"),
        ("position ( gripper ( padle_size [ 0.5 0.1 ] ) )", 'did you mean "paddle_size"?'),
        ("position ( ranger ( ) camera ( orign [ 1 0 0 0 ] ) )", 'did you mean "origin"?'),
        ("model ( size 1 )", "needs 2 numbers"),
        ("sensor ( )", "cannot stand here"),
        ("block ( )", "cannot stand here"),
        ("position ( ranger ( sensor ( samples 0 ) ) )", "at least 1"),
        ("position ( ranger ( sensor ( samples 2.5 ) ) )", "whole number"),
        ("position ( ranger ( sensor ( samples 1e9 ) ) )", "whole number"),
        ("position ( ranger ( sensor ( range [ 5 1 ] ) ) )", "larger maximum"),
        ("position ( ranger ( sensor ( fov 361 ) ) )", "at most 360"),
        ("position ( ranger ( sensor ( noise [ -1 0 0 ] ) ) )", "must not be negative"),
        ("position ( ranger ( sensor ( noise [ 0 -0.1 0 ] ) ) )", "must not be negative"),
        ("position ( ranger ( sensor ( noise [ 0 1.1 0 ] ) ) )", "share of the range, at most 1, not 1.1"),
        ("position ( ranger ( sensor ( noise [ 0 0 -1 ] ) ) )", "must not be negative"),
        ("model ( block ( points 2 ) )", "at least 3"),
        ("model ( block ( points 3 point[0] [ 0 0 ] ) )", "lacks point[1]"),
        ("position ( ranger ( scount 0 ) )", "at least 1"),
        ("position ( ranger ( scount 1000 ) )", "whole number up to 255"),
        ("position ( ranger ( scount 2 spose[0] [ 1 2 ] ) )", "needs 3 numbers"),
        ("resolution 0", "greater than 0"),
    ],
)
def test_faults_name_place_and_word(load, text, message):
    with pytest.raises(WorldFileError) as caught:
        load("\n" + text)
    assert "test.world:2: " in str(caught.value)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_robots_without_a_name_have_none_that_is_taken(load):
    """Stage names them by type and number; a name of the file was called doubled that stood there once."""
    world = load('position ( name "robot_1" ) position ( ) position ( name "robot_0" ) position ( )')
    assert [robot.name for robot in world.robots] == ["robot_1", "robot_2", "robot_0", "robot_3"]


def test_a_world_of_too_many_cells_is_drawn_coarser_and_says_so(load):
    """Stage's own SFU.world and large.world have more than can be held here, and did not load."""
    world = load("resolution 0.02\nmodel ( size [ 1200 600 1 ] boundary 1 noblocks 1 )")
    assert world.resolution == pytest.approx(0.095) and "test.world:1: resolution 0.02 makes too many" in world.warning
    assert world.warning.endswith("0.095 is used")
    assert rasterise(world.obstacles, world.resolution).cells.size < 100_000_000


TRIANGLE = "block ( points 3 point[0] [ 0 0 ] point[1] [ 1 0 ] point[2] [ 0 1 ] )"


@pytest.mark.parametrize("text", ["", "boundary 1", TRIANGLE])
def test_what_has_no_size_has_no_body(load, text):
    """As Stage's blobfinder, and models that only hold others."""
    assert load(f"model ( size [ 0 0 0 ] {text} )").obstacles == ()
    assert load(f"position ( size [ 0 0 0 ] {text} )").robots[0].footprint == ()


def test_a_rangers_own_origin_moves_its_beams(load):
    ranger = load("position ( ranger ( pose [ 0.1 0 0 90 ] origin [ 0.5 0 0 0 ] sensor ( fov 0 samples 1 ) ) )")
    assert ranger.robots[0].rangers[0].mount == pytest.approx((0.1, 0.5, math.pi / 2))


def test_of_a_coloured_picture_stage_looks_at_red(load, image):
    red = np.zeros((4, 4, 3), dtype=np.uint8)
    red[..., 2], red[0, 0] = 255, 0  # blue first
    red[3, 3] = (255, 255, 0)
    image("red.png", red)
    assert load_bitmap(load('model ( bitmap "red.png" )').obstacles[0].bitmap).sum() == 2


def test_a_comment_of_an_old_file_may_be_of_any_octets(tmp_path):
    path = tmp_path / "old.world"
    path.write_bytes(b"# Jos\xe9\nposition ( )\n")
    assert len(load_world(path).robots) == 1


def test_what_a_robots_part_or_picture_has_without_effect_is_told(load, image):
    image("black.png", np.zeros((3, 3), dtype=np.uint8))
    assert "part of a robot with obstacle_return 0" in load("position ( model ( obstacle_return 0 ) )").warning
    assert "block beside a bitmap" in load(f'model ( bitmap "black.png" {TRIANGLE} )').warning


def test_unusable_bitmaps(load, image, tmp_path):
    (tmp_path / "text.png").write_text("no image")
    (tmp_path / "huge.pgm").write_bytes(b"P5 100000 100000 255\n")
    with pytest.raises(WorldFileError, match=r"huge\.pgm: is no image that can be read .*, or too large a one"):
        rasterise(load('model ( bitmap "huge.pgm" )').obstacles, 0.1)
    with pytest.raises(WorldFileError, match=r"text\.png: is no image"):
        rasterise(load('model ( bitmap "text.png" )').obstacles, 0.1)
    image("white.png", np.full((3, 3), 255, dtype=np.uint8))
    with pytest.raises(WorldFileError, match=r"white\.png: has no dark pixel"):
        rasterise(load('model ( bitmap "white.png" )').obstacles, 0.1)


@pytest.mark.parametrize("size", [(1.0, 1.0), (1999999.0, 0.01), (1999999.0, 0.1), (0.1, 1999999.0), (1.9e6, 1.9e6)])
@pytest.mark.parametrize("resolution", [0.02, 1.0e300])
def test_a_world_of_any_shape_has_cells_that_can_be_held(load, size, resolution):
    """Of long ones the few cells across counted too little, and the square of 1e300 was too much."""
    world = load(f"resolution {resolution}\nmodel ( size [ {size[0]} {size[1]} 1 ] noblocks 1 boundary 1 )")
    columns, rows = (math.ceil(length / world.resolution) + 1 for length in size)
    assert columns * rows < 100_000_000


@pytest.mark.parametrize("text", ["pose [ 1e7 0 0 0 ]", "size [ 1e308 1 1 ]", "size [ 1 1 1 ] origin [ 0 -1e308 0 0 ]"])
def test_a_model_that_is_too_far_away_is_told(load, text):
    with pytest.raises(
        WorldFileError, match=r"test\.world: a model reaches .* m from the origin, .*: correct its pose"
    ):
        load(f"model ( {text} )")


@pytest.mark.parametrize("text", ["pose [ 1e300 0 0 0 ]", "size [ 3e6 1 1 ]"])
def test_a_robot_that_is_too_far_away_is_told(load, text):
    with pytest.raises(WorldFileError, match=r'test\.world: robot "robot_0" reaches .* m from the origin, .*: correct'):
        load(f"position ( {text} )")


@pytest.mark.parametrize("resolution", [1.0e-3, 1.0e-320])
def test_resolution_too_fine_for_the_world(load, resolution):
    with pytest.raises(ValueError, match="choose a coarser one"):
        rasterise(load("model ( size [ 1000 1000 1 ] )").obstacles, resolution)
