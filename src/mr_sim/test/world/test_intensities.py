"""Intensities of scans: the `ranger_return` of what a beam meets, 0 where it meets nothing, as in Stage."""

from functools import partial

import numpy as np
import pytest

from mr_sim import _world
from mr_sim.raster import intensities_of, rasterise

ROVER = 'rover ( name "a" pose [ 0 0 0 0 ] )\n'
WALL = "model ( size [ 0.2 4 1 ] pose [ 1.1 0 0 0 ] {} )\n"


def ahead(world, robot=0):
    """Range and intensity of the rover's middle beam."""
    ranges, intensities = world.core.scan_with_intensities(robot, 0)
    assert ranges.dtype == intensities.dtype == np.float32 and ranges.shape == intensities.shape == (541,)
    return ranges[270], intensities[270]


@pytest.fixture
def bright(make_world):
    """Makes worlds whose scans have intensities."""
    return partial(make_world, intensities=True)


@pytest.mark.parametrize(
    ("words", "intensity"),
    [("", 1.0), ("ranger_return 0", 0.0), ("ranger_return 0.25", 0.25), ("ranger_return 1000.5", 1000.5),
     ("laser_return 0", 1.0)],
)  # fmt: skip
def test_a_wall_returns_what_its_model_says(bright, words, intensity):
    distance, found = ahead(bright(ROVER + WALL.format(words)))
    assert (distance, found) == (pytest.approx(0.9, abs=0.03), intensity)


@pytest.mark.parametrize("wall", ["", WALL.format("ranger_return -1")])
def test_no_echo_has_no_intensity(bright, wall):
    assert ahead(bright(ROVER + wall)) == (8.0, 0.0)


def test_each_model_returns_its_own(bright):
    left = "model ( size [ 4 0.2 1 ] pose [ 0 1.1 0 0 ] ranger_return 7 )\n"
    right = "model ( size [ 4 0.2 1 ] pose [ 0 -1.1 0 0 ] noblocks 1 boundary 1 ranger_return 0.5 )\n"
    _, intensities = bright(ROVER + WALL.format("") + left + right).core.scan_with_intensities(0, 0)
    assert (intensities[270], intensities[450], intensities[90]) == (1.0, 7.0, 0.5)


@pytest.mark.parametrize(
    ("robot", "intensity"),
    [
        ('rover ( name "b" pose [ 2 0 0 0 ] )', 1.0),
        ('rover ( name "b" pose [ 2 0 0 0 ] ranger_return 3 )', 3.0),
        ('rover ( name "b" pose [ 2 0 0 0 ] model ( size [ 0.1 0.1 1 ] pose [ -0.4 0 0 0 ] ranger_return 5 ) )', 5.0),
        ('rover ( name "b" pose [ 2 0 0 0 ] model ( size [ 0.1 0.1 1 ] pose [ 0.4 0 0 0 ] ranger_return 5 ) )', 1.0),
    ],
)
def test_a_part_of_another_robot_returns_its_own_too(bright, robot, intensity):
    far = "model ( size [ 0.2 4 1 ] pose [ 4 0 0 0 ] ranger_return 9 )\n"
    world = bright(ROVER + far + robot)
    assert ahead(world)[0] < 2.0 and ahead(world)[1] == intensity


def test_a_robot_behind_a_wall_has_no_echo(bright):
    assert ahead(bright(ROVER + WALL.format("ranger_return 2") + 'rover ( name "b" pose [ 2 0 0 0 ] )'))[1] == 2.0


def test_ranges_are_the_same_with_and_without_intensities(bright):
    def ranges(scan):
        noisy = 'position ( name "a" ranger ( sensor ( range [ 0 8 ] fov 90 samples 91 noise [ 0.01 0.02 30 ] ) ) )\n'
        world = bright(noisy + WALL.format("ranger_return 4") + 'rover ( name "b" pose [ 2 1 0 0 ] )')
        return [scan(world.core) for _ in range(3)]

    with_intensities = ranges(lambda core: core.scan_with_intensities(0, 0)[0])
    assert np.array_equal(with_intensities, ranges(lambda core: core.scan(0, 0)))


def test_scans_have_intensities_only_where_the_world_is_to_tell_them(make_world, bright):
    for make in (make_world, bright):
        world = make(ROVER + WALL.format("ranger_return 2"))
        world.step()
        world.step()
        (scan,) = world.due_scans()
        assert scan.intensities is None if make is make_world else scan.intensities.max() == 2.0


def test_cells_carry_the_return_of_what_is_drawn_there(make_world):
    world = make_world(ROVER + WALL.format("ranger_return 2") + "model ( size [ 0.4 0.4 1 ] pose [ -2 0 0 0 ] )\n")
    obstacles, resolution = world.description.obstacles, world.description.resolution
    grid, intensities = rasterise(obstacles, resolution), intensities_of(obstacles, resolution)
    assert intensities.shape == grid.cells.shape and ((intensities > 0.0) == (grid.cells > 0)).all()
    assert set(np.unique(intensities)) == {0.0, 1.0, 2.0}
    assert intensities_of(make_world(ROVER + WALL.format("")).description.obstacles, resolution) is None


def test_intensities_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="one intensity for each cell"):
        _world.Raster(np.ones((2, 2)), 1.0, (0.0, 0.0), np.ones(3))
