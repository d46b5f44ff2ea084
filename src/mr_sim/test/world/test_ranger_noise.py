"""Noise of rangers: its distribution, and that it is the same in every run."""

import math

import numpy as np
import pytest

from mr_sim import _world

KINECT = """
position ( name "a" ranger ( sensor ( range [ 0.45 4.5 ] fov 40 samples 41 noise [ %g %g 0 ] ) ) )
"""


def sweeps(world, count: int = 1500) -> np.ndarray:
    """Ranges (count, samples) of the first robot, which stands."""
    return np.array([world.core.scan(0, 0) for _ in range(count)])


def ahead(make_world, distance: float, variance: float, share: float, count: int = 3000) -> np.ndarray:
    """Readings (count,) of a wall `distance` metres ahead."""
    wall = f"model ( size [ 0.2 4 1 ] pose [ {distance + 0.1} 0 0 0 ] )\n"
    return sweeps(make_world(wall + KINECT % (variance, share)), count)[:, 20].astype(float)


@pytest.mark.parametrize("distance", [0.6, 1.0, 2.0, 4.0])
def test_second_number_is_a_share_of_the_range_evenly_spread(make_world, distance):
    error = ahead(make_world, distance, 0.0, 0.05) - distance
    bound = 0.05 * distance
    assert abs(error).max() <= bound + 1e-6
    assert error.std() == pytest.approx(bound / math.sqrt(3.0), rel=0.05)
    assert error.mean() == pytest.approx(0.0, abs=0.04 * bound)
    quarters = np.histogram(error, bins=4, range=(-bound, bound))[0] / len(error)
    assert quarters == pytest.approx([0.25] * 4, abs=0.03)


@pytest.mark.parametrize("distance", [1.0, 4.0])
def test_both_parts_add_up(make_world, distance):
    readings = ahead(make_world, distance, 0.0004, 0.02)
    expected = math.sqrt(0.0004 + (0.02 * distance) ** 2 / 3.0)
    assert readings.std() == pytest.approx(expected, rel=0.05)
    assert readings.mean() == pytest.approx(distance, abs=3.0 * expected / math.sqrt(len(readings)) + 1e-3)


def test_growing_noise_is_drawn_for_each_beam_and_spares_the_maximum(make_world):
    world = make_world("model ( size [ 0.2 0.4 1 ] pose [ 3.1 0 0 0 ] )\n" + KINECT % (0.0, 0.05))
    readings = sweeps(world)
    assert (readings[:, [0, 40]] == 4.5).all()
    assert np.corrcoef(readings[:, 20], readings[:, 21])[0, 1] == pytest.approx(0.0, abs=0.1)
    assert np.corrcoef(readings[:-1, 20], readings[1:, 20])[0, 1] == pytest.approx(0.0, abs=0.1)


@pytest.mark.parametrize("noise", ["0.0001 0 0", "0 0.05 0", "0.0001 0.05 0"])
def test_noise_is_seeded_per_robot(make_world, noise):
    wall = "model ( size [ 0.2 9 1 ] pose [ 3.1 0 0 0 ] )\n"
    robot = f"sensor ( range [ 0 8 ] fov 20 samples 5 noise [ {noise} ] )"
    text = wall + "".join(
        f'position ( name "{n}" pose [ 0 {y} 0 0 ] ranger ( {robot} ) )\n' for n, y in (("a", 0), ("b", 2))
    )
    first, again, other = (make_world(text, seed=seed) for seed in (3, 3, 4))
    alone = make_world(text, seed=3, robots=1)
    a = sweeps(first, 5)
    assert np.array_equal(a, sweeps(again, 5)) and np.array_equal(a, sweeps(alone, 5))
    assert not np.isclose(a, sweeps(other, 5), atol=1e-6).any()
    assert not np.isclose(a, [first.core.scan(1, 0) for _ in range(5)], atol=1e-6).any()


def test_what_is_seen_does_not_shift_the_draws(make_world):
    """A second thing in view changes the beams that hit it and no other."""
    wall = "model ( size [ 0.2 2 1 ] pose [ 3.1 0 0 0 ] )\n"
    thing = "model ( size [ 0.1 0.1 1 ] pose [ 1.5 0 0 0 ] )\n"
    plain = sweeps(make_world(wall + KINECT % (0.0001, 0.05)), 20)
    hidden = sweeps(make_world(wall + thing + KINECT % (0.0001, 0.05)), 20)
    changed = (plain != hidden).any(axis=0)
    assert 2 <= changed.sum() <= 8 and changed[20] and not changed[[5, 35]].any()


TILTED = "model ( size [ 0.2 9 1 ] pose [ 3 0 0 45 ] )\n"  # what a beam errs aside shows in the range


def bearing_errors(make_world, degrees: float, fov: float, samples: int, count: int = 400) -> np.ndarray:
    """Bearings (count, samples) at which beams hit a tilted wall, less those they are reported at, in rad."""
    robot = f"position ( ranger ( sensor ( range [ 0 8 ] fov {fov} samples {samples} noise [ 0 0 {degrees} ] ) ) )"
    world = make_world("resolution 0.002\n" + TILTED + robot, head="interval_sim 100\n")
    ranger = world.robots[0].rangers[0]
    reported = ranger.angle_min + ranger.angle_increment * np.arange(samples)
    face = 3.0 - 0.1 * math.sqrt(2.0)  # where the line of the wall's near face crosses the x axis
    # The face is x - y = face, so range * (cos(bearing) - sin(bearing)) = face.
    hit = np.arccos(np.clip(face / (sweeps(world, count).astype(float) * math.sqrt(2.0)), -1.0, 1.0)) - math.pi / 4.0
    return hit - reported


@pytest.mark.parametrize(("fov", "samples", "between"), [(40, 5, 10), (20, 1, 20)])
def test_third_number_errs_the_bearing_as_in_stage(make_world, fov, samples, between):
    """Evenly spread over a share of the angle between two beams: the number, read as degrees, in rad."""
    errors = bearing_errors(make_world, 20.0, fov, samples)
    bound = 0.5 * math.radians(20.0) * math.radians(between)
    exact = bearing_errors(make_world, 0.0, fov, samples, 1)
    noise = errors - exact
    assert abs(noise).max() <= bound + 2e-3
    assert noise.std() == pytest.approx(bound / math.sqrt(3.0), rel=0.1)
    assert abs(noise.mean()) < 0.1 * bound


def test_error_of_the_bearing_is_seeded_and_spares_other_noise(make_world):
    wall = "model ( size [ 0.2 9 1 ] pose [ 3.1 0 0 20 ] )\n"
    robot = "position ( ranger ( sensor ( range [ 0 8 ] fov 40 samples 9 noise [ 0 0 90 ] ) ) )"
    first, again, other = (sweeps(make_world(wall + robot, seed=seed), 5) for seed in (3, 3, 4))
    assert np.array_equal(first, again) and not np.array_equal(first, other)


def test_robot_at_the_edge_of_an_erring_beam_is_seen(make_world):
    """Large errors reach beams that would miss the other robot by more than one."""
    robots = """
    position ( ranger ( sensor ( range [ 0 8 ] fov 90 samples 91 noise [ 0 0 720 ] ) ) )
    position ( size [ 0.1 0.1 1 ] pose [ 3 0 0 0 ] )
    """
    hits = (sweeps(make_world(robots), 400) < 8.0).any(axis=0)
    assert hits[39:52].all() and not hits[:36].any() and not hits[55:].any()


def mersenne_twister(seed: int):
    """Numbers of 64 bits, after Nishimura and Matsumoto, as std::mt19937_64 defines them."""
    mask, words = 2**64 - 1, [seed]
    for index in range(1, 312):
        words.append((6364136223846793005 * (words[-1] ^ (words[-1] >> 62)) + index) & mask)
    while True:
        for index in range(312):
            joined = (words[index] & ~0x7FFFFFFF) | (words[(index + 1) % 312] & 0x7FFFFFFF)
            words[index] = words[(index + 156) % 312] ^ (joined >> 1) ^ (0xB5026F5AA96619E9 if joined & 1 else 0)
        for word in words:
            word ^= (word >> 29) & 0x5555555555555555
            word ^= (word << 17) & 0x71D67FFFEDA60000
            word ^= (word << 37) & 0xFFF7EEE000000000 & mask
            yield (word & mask) ^ ((word & mask) >> 43)


def normals(seed: int):
    """By Marsaglia's polar method, in pairs."""
    uniform = ((word >> 11) * 2.0**-53 for word in mersenne_twister(seed))
    while True:
        u, v = 2.0 * next(uniform) - 1.0, 2.0 * next(uniform) - 1.0
        s = u * u + v * v
        if 0.0 < s < 1.0:
            factor = math.sqrt(-2.0 * math.log(s) / s)
            yield from (u * factor, v * factor)


@pytest.mark.parametrize("samples", [6, 7])
def test_constant_noise_alone_draws_what_it_always_drew(samples):
    """Records of older missions stay true: without a second number nothing else is drawn."""
    cells = np.zeros((100, 100), dtype=np.uint8)
    cells[:, 60:] = 1
    raster = _world.Raster(cells, 0.1, (0.0, 0.0))
    exact, noisy = (_world.Ranger((0.0, 0.0, 0.0), 8.0, 0.5, samples, variance, 0.0) for variance in (0.0, 0.01))
    world = _world.World(raster, raster, 0.05)
    world.add_robot(
        start=(2.0, 5.0, 0.0), footprint=[[(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)]],
        linear_bounds=(-1.0, 1.0), lateral_bounds=(0.0, 0.0), angular_bounds=(-1.0, 1.0),
        localization_origin=(0.0, 0.0, 0.0), exact_localization=True, bias=(0.0,) * 3, walk=(0.0,) * 3, walk_seed=0,
        base_steps=1, command_timeout=0.5, seen=[], intensities=[], solid=True, noise_seed=5489, rangers=[exact, noisy],
    )  # fmt: skip
    drawn = normals(5489)
    for _ in range(3):
        errors = np.array([next(drawn) * 0.1 for _ in range(samples + samples % 2)][:samples], dtype=np.float32)
        assert np.array_equal(world.scan(0, 1), world.scan(0, 0) + errors)


def test_nearer_than_range_min_is_reported_where_it_is(make_world):
    """As in Stage; who reads the scan drops what is nearer than its range_min."""
    near = make_world("model ( size [ 0.2 4 1 ] pose [ 0.4 0 0 0 ] )\n" + KINECT % (0.0, 0.0))
    assert near.robots[0].rangers[0].range_min == 0.45
    assert near.core.scan(0, 0)[20] == pytest.approx(0.3)
