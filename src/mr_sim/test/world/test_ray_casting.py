"""Ray casting and geometry against what can be computed by hand."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mr_sim import _world

ROOM = np.zeros((300, 500), dtype=np.uint8)
ROOM[0, :] = ROOM[-1, :] = ROOM[:, 0] = ROOM[:, -1] = 1
RESOLUTION = 0.02
INSIDE = (RESOLUTION, RESOLUTION, 499 * RESOLUTION, 299 * RESOLUTION)  # x and y between the faces of the walls


def room_range(x: float, y: float, angle: float) -> float:
    """Distance to the walls of the empty room."""
    dx, dy = math.cos(angle), math.sin(angle)
    to_x = (INSIDE[2] - x) / dx if dx > 0 else (INSIDE[0] - x) / dx if dx < 0 else math.inf
    to_y = (INSIDE[3] - y) / dy if dy > 0 else (INSIDE[1] - y) / dy if dy < 0 else math.inf
    return min(to_x, to_y)


@given(x=st.floats(0.05, 9.9), y=st.floats(0.05, 5.9), angles=st.lists(st.floats(-7, 7), min_size=1, max_size=20))
def test_empty_room_is_measured_exactly(x, y, angles):
    raster = _world.Raster(ROOM, RESOLUTION, (0.0, 0.0))
    expected = [room_range(x, y, angle) for angle in angles]
    assert np.allclose(raster.cast((x, y), angles, 50.0), expected, rtol=0, atol=1e-9)


def march(cells: np.ndarray, x: float, y: float, angle: float, limit: float) -> float:
    """Cell by cell without any skipping, in exact order of the borders crossed (Amanatides and Woo 1987)."""
    dx, dy = math.cos(angle), math.sin(angle)
    column, row = math.floor(x), math.floor(y)
    travelled = 0.0
    while travelled < limit and 0 <= row < cells.shape[0] and 0 <= column < cells.shape[1]:
        if cells[row, column]:
            return travelled
        to_x = ((column + (dx > 0)) - x) / dx if dx else math.inf
        to_y = ((row + (dy > 0)) - y) / dy if dy else math.inf
        travelled = min(to_x, to_y)
        if to_x < to_y:
            column += 1 if dx > 0 else -1
        else:
            row += 1 if dy > 0 else -1
    return limit


def test_skipping_free_space_changes_no_range():
    generator = np.random.default_rng(1)
    differing = 0
    for density in (0.0, 0.001, 0.01, 0.1):
        cells = (generator.random((120, 160)) < density).astype(np.uint8)
        raster = _world.Raster(cells, 1.0, (0.0, 0.0))
        for _ in range(200):
            x, y = generator.uniform(0, 160), generator.uniform(0, 120)
            angles = generator.uniform(-math.pi, math.pi, 5)
            expected = [march(cells, x, y, angle, 300.0) for angle in angles]
            differing += int((np.abs(raster.cast((x, y), angles, 300.0) - expected) > 1e-9).sum())
    assert differing == 0


def test_axis_parallel_rays_and_limits():
    raster = _world.Raster(ROOM, RESOLUTION, (-5.0, -3.0))
    assert raster.cast((0, 0), [0.0, math.pi / 2, math.pi, -math.pi / 2], 50.0) == pytest.approx(
        [4.98, 2.98, 4.98, 2.98]
    )
    assert raster.cast((0, 0), [0.0], 4.0) == [4.0]
    assert raster.cast((-4.995, 0), [1.0], 4.0) == [0.0], "from inside a wall"


def test_outside_the_raster_is_free_and_walls_are_seen_from_there():
    raster = _world.Raster(ROOM, RESOLUTION, (0.0, 0.0))
    assert raster.cast((-2.0, 3.0), [0.0, math.pi], 50.0) == pytest.approx([2.0, 50.0])
    assert raster.cast((-2.0, 8.0), [0.0], 50.0) == [50.0]
    gap = ROOM.copy()
    gap[150, 0] = 0
    assert _world.Raster(gap, RESOLUTION, (0, 0)).cast((5.0, 3.01), [math.pi], 50.0) == [50.0], "out through the gap"


def test_segments_touch_walls():
    raster = _world.Raster(ROOM, RESOLUTION, (0.0, 0.0))
    assert not raster.touches((1, 1), (9, 5))
    assert raster.touches((1, 1), (1, 0.015))
    assert not raster.touches((1, 1), (1, 1))
    assert raster.touches((0.01, 1), (0.01, 1))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [((np.zeros((0, 3)), 1.0, (0, 0)), "at least one cell"), ((np.zeros((2, 2)), 0.0, (0, 0)), "must be positive"),
     ((np.zeros(4), 1.0, (0, 0)), "two-dimensional")],
)  # fmt: skip
def test_unusable_rasters_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        _world.Raster(*arguments)
