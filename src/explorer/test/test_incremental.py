"""What is computed only where a map has changed is the same, bit for bit, as what is computed from the whole map."""

from dataclasses import dataclass
from typing import List, Tuple

import numpy as np
import pytest
from conftest import map_of
from hypothesis import given, settings
from hypothesis import strategies as st
from usual_robot import LARGEST, options_with

from explorer import ground
from explorer.changes import TILE, aligned, blocks, changed_windows, grown, within
from explorer.frontier_map import FrontierMap, frontier_cells
from explorer.grid import OccupancyMap
from explorer.ground import Ground
from explorer.perception import Perception
from explorer.senses import Senses
from explorer.travel import TravelGrid
from explorer.verdicts import Verdicts
from explorer.ways import TOUR_CELL, Ways
from mr_grid import Pose

seeds = st.integers(0, 2**32 - 1)
RADIUS, COMFORT = 0.25, 0.6


@dataclass
class Growing:
    """A building of which more and more is seen, with noise and robots in the way."""

    random: np.random.Generator
    resolution: float
    truth: np.ndarray
    cells: np.ndarray

    @classmethod
    def drawn(cls, seed: int) -> "Growing":
        random = np.random.default_rng(seed)
        rows, cols = random.integers(120, 260, 2).tolist()
        truth = np.zeros((rows, cols), dtype=np.int8)
        for _ in range(12):
            row, col = random.integers(0, rows), random.integers(0, cols)
            along = int(random.integers(10, 80))
            truth[row : row + 2, col : col + along] = 100
            truth[col % rows : col % rows + along, row % cols : row % cols + 2] = 100
        cells = np.full(truth.shape, -1, dtype=np.int8)
        cells[: rows // 2, : cols // 2] = truth[: rows // 2, : cols // 2]
        return cls(random, float(random.choice([0.05, 0.1])), truth, cells)

    def look(self) -> None:
        """Some more is seen, some is taken back, and single cells flicker."""
        for _ in range(int(self.random.integers(0, 4))):
            window = self._window(40)
            self.cells[window] = -1 if self.random.random() < 0.2 else self.truth[window]
        for _ in range(int(self.random.integers(0, 4))):
            self.cells[self._window(3)] = self.random.choice([-1, 0, 30, 60, 100])

    def _window(self, most: int) -> Tuple[slice, slice]:
        rows, cols = (
            slice(first, first + int(self.random.integers(1, most)))
            for first in (self.random.integers(-most // 2, n) for n in self.cells.shape)
        )
        return slice(max(0, rows.start), rows.stop), slice(max(0, cols.start), cols.stop)

    def map(self) -> OccupancyMap:
        return map_of(self.cells.copy(), self.resolution, -1.0, 2.0)

    def places(self, count: int) -> List[Tuple[float, float]]:
        """In metres, somewhere on the map."""
        height, width = self.cells.shape
        size = np.array((width, height)) * self.resolution
        return [(x, y) for x, y in (self.random.random((count, 2)) * size + (-1.0, 2.0)).tolist()]

    def stand(self, places: List[Tuple[float, float]]) -> None:
        """The map shows robots there."""
        for x, y in places:
            col, row = int((x + 1.0) / self.resolution), int((y - 2.0) / self.resolution)
            self.cells[max(0, row - 1) : row + 2, max(0, col - 1) : col + 2] = 100


@settings(max_examples=60)
@given(seeds)
def test_all_differences_lie_in_the_windows(seed: int) -> None:
    building = Growing.drawn(seed)
    before = building.map().cells
    building.look()
    after = building.map().cells
    windows = changed_windows(before, after)
    assert windows is not None
    outside = before != after
    for window in windows:
        assert outside[window].any() or (before[window] != after[window]).any()
        outside[window] = False
    assert not outside.any()
    assert changed_windows(before, before.copy()) == []


def test_much_change_and_other_sizes_have_no_windows() -> None:
    before = np.zeros((200, 200), dtype=np.int8)
    after = before.copy()
    after[::20, ::20] = 100
    assert changed_windows(before, after) is None
    assert changed_windows(before, before[1:]) is None


def test_windows_stay_on_the_grid() -> None:
    window, shape = (slice(30, 70), slice(95, 99)), (72, 100)
    assert grown(window, 3, shape) == (slice(27, 72), slice(92, 100))
    assert aligned(window, 8, shape) == (slice(24, 72), slice(88, 100))
    assert blocks(aligned(window, 8, shape), 8) == (slice(3, 9), slice(11, 13))
    assert within(window, grown(window, 3, shape)) == (slice(3, 43), slice(3, 7))


@settings(max_examples=40)
@given(seeds)
def test_ground_and_frontiers_follow_the_map(seed: int) -> None:
    building = Growing.drawn(seed)
    former, frontiers = None, None
    for step in range(4):
        robots = building.places(2)
        if step % 2:
            building.stand(robots)
        occupancy = building.map()
        former = Ground.of(occupancy, RADIUS, robots, LARGEST, former)
        whole = Ground.of(occupancy, RADIUS, robots, LARGEST)
        assert former.count == whole.count
        for layer, expected in zip(former.layers, whole.layers):
            assert np.array_equal(layer, expected)
        for factor in (2, 3, 5):
            for pool, expected in zip(former.pools(factor), whole.pools(factor)):
                assert np.array_equal(pool, expected)
        frontiers = FrontierMap.of(occupancy, frontiers)
        assert np.array_equal(frontiers.of_length(0.4), frontier_cells(occupancy, 0.4))
        building.look()


@settings(max_examples=15)
@given(seeds)
def test_costs_follow_the_map(seed: int) -> None:
    building = Growing.drawn(seed)
    former = None
    for _ in range(3):
        robots, stops = building.places(2), building.places(4)
        occupancy = building.map()
        former = Ways(occupancy, RADIUS, robots, LARGEST, former=former)
        own = TravelGrid(occupancy, RADIUS, COMFORT, ground=Ground.of(occupancy, RADIUS, robots, LARGEST))
        tour = TravelGrid(occupancy, RADIUS, COMFORT, cell=TOUR_CELL, ground=own.ground)
        for place in stops:
            assert np.array_equal(former.grid.field_from(*place).cost, own.field_from(*place).cost)
        assert np.array_equal(former.between(stops), Ways(occupancy, RADIUS, robots, LARGEST).between(stops))
        assert np.array_equal(former._tour_grid.traversable, tour.traversable)
        building.look()


class Perceiver:
    """The perception of one robot; a forgetful one computes everything from each map anew."""

    def __init__(self, forgetful: bool) -> None:
        self.forgetful = forgetful
        self.senses, self.verdicts = Senses(None), Verdicts()
        self.perception = Perception(options_with(), self.senses)

    def take(self, occupancy: OccupancyMap, pose: Pose, others: List[Tuple[float, float]], now: float) -> List[object]:
        """Everything that is perceived."""
        perception = self.perception
        if self.forgetful:
            perception.ways = perception._frontier_map = perception._views = None
        self.senses.take_map(occupancy, now)
        self.senses.take_pose(pose, now)
        perception.take_map()
        gone = perception.update(self.verdicts, others, len(others), now)
        assert perception.field is not None and perception.ways is not None
        return [
            gone,
            perception.frontiers.ordered(),
            perception.clusters,
            perception.worth,
            perception.leftovers(),
            perception.field.cost.tobytes(),
            perception.ways.grid.occupied.tobytes(),
        ]


@settings(max_examples=20)
@given(seeds)
def test_perception_follows_the_map(seed: int) -> None:
    """Frontiers, clusters, views, what is worth a visit, costs; some maps come twice, some show other robots."""
    building = Growing.drawn(seed)
    following, forgetful = Perceiver(forgetful=False), Perceiver(forgetful=True)
    height, width = (0.25 * building.resolution * n for n in building.cells.shape)
    for step in range(6):
        others = building.places(2)
        if building.random.random() < 0.3:
            building.stand(others)
        pose = Pose(-1.0 + width * building.random.random(), 2.0 + height * building.random.random(), 0.0)
        occupancy = building.map()
        seen = [perceiver.take(occupancy, pose, others, 2.0 * step) for perceiver in (following, forgetful)]
        assert seen[0] == seen[1]
        if building.random.random() < 0.7:
            building.look()


def test_work_is_as_large_as_the_change(monkeypatch: pytest.MonkeyPatch) -> None:
    measured = []
    whole = ground.distances_to

    def counting(cells: np.ndarray, resolution: float) -> np.ndarray:
        measured.append(cells.size)
        return whole(cells, resolution)

    monkeypatch.setattr(ground, "distances_to", counting)
    cells = np.zeros((800, 800), dtype=np.int8)
    cells[:, ::50] = 100
    first = Ways(map_of(cells, 0.05), RADIUS, [], LARGEST)
    assert measured == [cells.size]
    changed = cells.copy()
    changed[400:410, 410:420] = -1
    second = Ways(map_of(changed, 0.05), RADIUS, [], LARGEST, former=first)
    reach = 2 * (second.grid.factor + 16)
    assert len(measured) == 2 and measured[1] <= (2 * TILE + 2 * reach) ** 2
    third = Ways(map_of(changed.copy(), 0.05), RADIUS, [], LARGEST, former=second)
    assert len(measured) == 2 and third.grid is second.grid


def test_costs_from_the_same_cell_are_not_computed_again() -> None:
    building = Growing.drawn(3)
    grid = Ways(building.map(), 0.25, [], LARGEST).grid
    field = grid.field_from(1.0, 4.0)
    assert grid.field_from(1.01, 4.01, field) is field and grid.field_from(1.5, 4.0, field) is not field
    other = Ways(building.map(), 0.25, [], LARGEST).grid
    assert other.field_from(1.0, 4.0, field) is not field


def test_equal_map_is_skipped(monkeypatch: pytest.MonkeyPatch) -> None:
    building = Growing.drawn(3)
    perceiver = Perceiver(forgetful=False)
    before = perceiver.take(building.map(), Pose(1.0, 4.0, 0.0), [], 0.0)
    monkeypatch.setattr(perceiver.perception.frontiers, "update", None)
    assert perceiver.take(building.map(), Pose(1.0, 4.0, 0.0), [], 2.0) == before
