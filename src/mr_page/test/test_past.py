"""The past of a page: what was shown is shown again, within bounds."""

import numpy as np
import pytest

from mr_grid import OccupancyGrid, Pose
from mr_page.past import PERIOD, Past, team_time
from mr_page.state import PageState
from mr_page.stream import TOLD
from mr_page.tiles import BLANK, TILE
from mr_page.update import decoded, encoded

KINDS = ("local", "global")


def everything(robot, kind):
    return True


def snapshot(state):
    """All that a state holds, as plain values."""
    return {
        name: (
            dict(view.values),
            {key: stream.since(0) for key, stream in view.streams.items()},
            {kind: (tiled.lattice, tiles_of(tiled)) for kind, tiled in view.maps.items() if tiled.lattice},
        )
        for name, view in state.robots.items()
    }


def tiles_of(tiled):
    return {place: cells for place, cells in tiled.changed_since(0, 10**6).tiles if cells != BLANK}


def shown(update):
    """What a page shows that knew nothing before."""
    state = PageState()
    state.apply(decoded(encoded(update)))
    return snapshot(state)


class Story:
    """Two robots to which something happens at random, second by second."""

    def __init__(self, seed):
        self.state = PageState()
        self._rng = np.random.default_rng(seed)
        self._cells = {
            (name, kind): np.full((2 * TILE, 3 * TILE), -1, dtype=np.int8) for name in "ab" for kind in KINDS
        }

    def step(self, now):
        for name in "ab":
            self.state.put(name, "time", float(now))
            self.state.put(name, "pose", self._rng.integers(0, 3, 2).tolist())
            self.state.append(name, "trail", [now, 0])
            if self._rng.random() < 0.02:
                self.state.forget(name)
                self.state.put(name, "time", float(now))
            for kind in KINDS:
                self._grow(name, kind)

    def _grow(self, name, kind):
        cells = self._cells[name, kind]
        row, column = self._rng.integers(0, cells.shape[0] - 9), self._rng.integers(0, cells.shape[1] - 9)
        cells[row : row + 9, column : column + 9] = self._rng.integers(-1, 2) * 100 if self._rng.random() < 0.9 else 0
        corner = Pose(0.0 if self._rng.random() < 0.97 else 0.01)  # another lattice now and then
        self.state.map(name, kind).take(OccupancyGrid.of(np.maximum(cells, -1), 0.05, corner))


@pytest.mark.parametrize("seed", range(4))
def test_what_was_shown_is_shown_again(seed):
    story, was = Story(seed), {}
    past = Past(story.state)
    for now in range(0, 100, 2):
        story.step(now)
        past.note(float(now))
        was[now] = snapshot(story.state)
    for now, expected in was.items():
        for asked in (now, now + 1.9):
            update = past.at(asked, everything)
            assert shown(update) == expected
            assert (update.moment[0] or 0.0) <= asked <= update.moment[1]
    assert shown(past.at(-5.0, everything)) == was[0] and past.at(-5.0, everything).moment == (None, 2.0)


def test_the_auctions_of_a_moment_are_the_newest_that_had_been_decided():
    """As many as one sees now, although the newest of today are others."""
    state, most = PageState(), TOLD["auctions"]
    past = Past(state)
    for number in range(3 * most):
        state.put("a", "time", 2.0 * number)
        state.append("a", "auctions", [2.0 * number, number, 7, []])
        past.note(2.0 * number)
    for asked, count in ((0.0, 1), (2.0 * most, most), (3.0 * most, most)):
        _, items = past.at(asked, everything).robots["a"].streams["auctions"]
        assert len(items) == count and items[-1][0] == asked


def test_the_whole_mission_stays_more_coarsely():
    story, was = Story(7), {}
    past = Past(story.state, most_moments=20)
    for now in range(0, 400, 2):
        story.step(now)
        past.note(float(now))
        was[now] = snapshot(story.state)
    assert 10 <= len(past) <= 20
    begins = [update.moment[0] or 0.0 for update in (past.at(now, everything) for now in was)]
    gaps = np.diff(sorted(set(begins)))
    assert gaps.max() <= 400 / 20 * 4 and begins[-1] >= 400 - 400 / 20 * 4
    for now, begin in zip(was, begins):
        if begin:
            assert shown(past.at(now, everything)) == was[int(begin)]


def octets_of(past):
    """What is really kept of values and tiles."""
    values = {id(robot.values): robot.values for moment in past._moments for robot in moment.robots.values()}
    tiles = [cells for film in past._films.values() for entries in film._tiles.values() for _, cells in entries]
    return sum(map(len, [*values.values(), *tiles]))


@pytest.mark.parametrize("size", [0, 2000])
def test_octets_are_bounded_and_given_back(size):
    """Where tiles are most of them, and where values are."""
    story, rng = Story(3), np.random.default_rng(3)
    past, most = Past(story.state, most_octets=30_000), 0
    for now in range(0, 600, 2):
        story.step(now)
        story.state.put("a", "text", rng.bytes(size).hex())
        past.note(float(now))
        most = max(most, octets_of(past))
        assert past.octets == octets_of(past)
    assert 15_000 <= most <= 30_000 and len(past) >= 2


def test_films_that_no_moment_shows_are_forgotten():
    story = Story(3)
    gone = Past(story.state, most_moments=2)
    for now in range(0, 100, 2):
        gone.note(1.0e6 + 1000.0 * now)
        story.state.forget("a"), story.state.forget("b")
        story.step(now)
    assert len(gone._films) <= 2 * 2 * 2


def test_moments_are_taken_as_often_as_they_are_kept():
    story = Story(1)
    past = Past(story.state)
    story.step(0)
    for tick in range(100):
        past.note(0.1 * tick)
    assert len(past) == round(10.0 / PERIOD)


def test_maps_that_nobody_looks_at_are_not_told():
    story = Story(1)
    past = Past(story.state)
    story.step(0)
    past.note(0.0)
    update = past.at(0.0, lambda robot, kind: (robot, kind) == ("a", "local"))
    assert {tile[:2] for tile in update.tiles} == {("a", "local")} == {lattice[:2] for lattice in update.lattices}


def test_without_a_time_there_is_no_past():
    past = Past(PageState())
    past.note(0.0)
    assert past.at(0.0, everything) is None and team_time(PageState()) is None


def test_a_base_station_with_another_clock_does_not_set_the_time():
    state = PageState()
    state.put("base", "about", {"base": True})
    state.put("base", "time", 1.7e9)
    assert team_time(state) == 1.7e9
    for name, time in (("a", 50.0), ("b", 51.0)):
        state.put(name, "time", time)
    assert team_time(state) == 51.0


def test_a_clock_that_jumps_back_loses_nothing():
    state = PageState()
    past = Past(state)
    for index, time in enumerate((10.0, 70.0, 12.0, 14.0)):
        state.put("a", "time", time)
        past.note(PERIOD * index)
    assert [past.at(asked, everything).robots["a"].values["time"] for asked in (11.0, 13.0, 99.0)] == [10.0, 12.0, 14.0]
