"""What viewers are told: everything once, not too often, and what a second state makes of it."""

import numpy as np
import pytest

from mr_grid import OccupancyGrid, Pose
from mr_page import state as state_module
from mr_page.state import PageState
from mr_page.stream import LENGTHS, TOLD, Stream
from mr_page.tiles import TILE
from mr_page.update import Changes, Update, decoded, encoded
from mr_page.viewer import MAP_PERIOD, PERIOD, TILES, Viewer


def grid(side, value=0):
    return OccupancyGrid.of(np.full((side, side), value, dtype=np.int8), 0.05, Pose(-1.0, 2.0, 0.3))


def values(update, robot="a"):
    return update.robots[robot].values


def test_everything_is_told_once():
    state = PageState()
    state.put("a", "pose", [1.0, 2.0, 0.0])
    viewer = Viewer(state)
    assert values(viewer.update(0.0)) == {"pose": [1.0, 2.0, 0.0]}
    assert viewer.update(1.0) is None
    state.put("a", "pose", [1.0, 2.0, 0.0])
    assert viewer.update(2.0) is None
    state.put("a", "pose", [1.5, 2.0, 0.0])
    state.put("a", "state", {"text": "drives"})
    assert values(viewer.update(3.0)) == {"pose": [1.5, 2.0, 0.0], "state": {"text": "drives"}}


def test_updates_keep_their_period_although_looks_come_late():
    state = PageState()
    viewer = Viewer(state)
    told = []
    for tick in range(1000):
        now = tick * 0.05 + 0.011 * (tick % 3)
        state.put("a", "time", tick)
        if viewer.update(now):
            told.append(now)
    pauses = np.diff(told)
    assert len(told) == pytest.approx(50.0 / PERIOD, rel=0.03)
    assert pauses.min() > PERIOD - 0.075 and pauses.max() < PERIOD + 0.075  # by as much as two looks lie apart


def test_what_changes_between_updates_is_told_once():
    state = PageState()
    viewer = Viewer(state)
    for number in range(10000):
        state.put("a", "time", number)
    assert values(viewer.update(0.0)) == {"time": 9999}


def test_viewers_do_not_disturb_one_another():
    state = PageState()
    first = Viewer(state)
    state.put("a", "x", 1)
    first.update(0.0)
    state.put("a", "x", 2)
    second = Viewer(state)
    assert values(second.update(0.0)) == values(first.update(1.0)) == {"x": 2}


def test_streams_tell_what_is_new():
    state = PageState()
    viewer = Viewer(state)
    state.append("a", "events", [1.0, "link", "hears b", "b"])
    assert viewer.update(0.0).robots["a"].streams == {"events": (0, [[1.0, "link", "hears b", "b"]])}
    state.append("a", "events", [2.0, "link", "hears c", "c"])
    assert viewer.update(1.0).robots["a"].streams == {"events": (1, [[2.0, "link", "hears c", "c"]])}


def test_streams_are_bounded_and_go_on_behind_a_gap():
    state = PageState()
    viewer, other = Viewer(state), PageState()
    other.apply(viewer.update(0.0) or Update())
    for number in range(LENGTHS["log"] * 3):
        state.append("a", "log", number)
    other.apply(viewer.update(1.0))
    first, items = other.stream("a", "log").since(0)
    assert (first, len(items), items[-1]) == (2 * LENGTHS["log"], LENGTHS["log"], 3 * LENGTHS["log"] - 1)


def test_who_comes_late_is_told_the_newest_auctions_and_then_each_new_one():
    """The server keeps more of them, for the past."""
    state, most = PageState(), TOLD["auctions"]
    for number in range(2 * most):
        state.append("a", "auctions", number)
    viewer, other = Viewer(state), PageState()
    first, items = viewer.update(0.0).robots["a"].streams["auctions"]
    assert (first, items) == (most, list(range(most, 2 * most)))
    other.apply(Update(robots={"a": Changes({}, {"auctions": (first, items)})}))
    for number in range(2 * most, 3 * most):
        state.append("a", "auctions", number)
        update = viewer.update(float(number))
        assert update.robots["a"].streams == {"auctions": (number, [number])}
        other.apply(decoded(encoded(update)))
    assert other.stream("a", "auctions").since(0) == (2 * most, list(range(2 * most, 3 * most)))
    for number in range(LENGTHS["auctions"]):
        state.append("a", "auctions", number)
    stream = state.stream("a", "auctions")
    assert stream.first == 3 * most and stream.since(0, stream.first + 7) == (stream.first, list(range(7)))


def test_a_stream_takes_what_it_knows_only_once():
    stream = Stream(10)
    stream.extend(0, [0, 1, 2])
    stream.extend(1, [1, 2, 3])
    assert stream.since(0) == (0, [0, 1, 2, 3])


def test_maps_come_in_parts_that_fit_and_then_at_their_own_pace():
    state = PageState()
    state.map("a", "global").take(grid(20 * TILE))
    viewer = Viewer(state)
    first, second = viewer.update(0.0), viewer.update(PERIOD)
    assert (len(first.lattices), len(first.tiles), first.rest) == (1, TILES, 400 - TILES)
    assert (len(second.lattices), len(second.tiles), second.rest) == (0, 400 - TILES, 0)
    state.map("a", "global").patch(0, 0, np.full((1, 1), 100, dtype=np.int8))
    assert viewer.update(3 * PERIOD) is None
    assert len(viewer.update(PERIOD + MAP_PERIOD).tiles) == 1


def test_only_maps_that_are_looked_at_are_told():
    state = PageState()
    for kind in ("local", "global"):
        state.map("a", kind).take(grid(TILE))
    viewer = Viewer(state)
    viewer.wants = lambda robot, kind: kind == "local"
    assert [lattice[1] for lattice in viewer.update(0.0).lattices] == ["local"]
    viewer.wants = lambda robot, kind: True
    update = viewer.update(1.0)
    assert [lattice[1] for lattice in update.lattices] == ["global"] and len(update.tiles) == 1


def test_a_map_that_begins_anew_is_told_whole():
    state = PageState()
    state.map("a", "local").take(grid(2 * TILE))
    viewer = Viewer(state)
    viewer.update(0.0)
    state.map("a", "local").take(OccupancyGrid.of(np.zeros((9, 9), dtype=np.int8), 0.1))
    update = viewer.update(5.0)
    assert update.lattices[0][2].resolution == 0.1 and len(update.tiles) == 1


def test_a_robot_that_begins_anew_is_told_whole():
    state = PageState()
    state.put("a", "x", 1)
    state.append("a", "log", "old")
    viewer = Viewer(state)
    viewer.update(0.0)
    state.forget("a")
    state.append("a", "log", "new")
    update = viewer.update(1.0)
    assert update.anew == ["a"] and update.robots["a"].streams == {"log": (0, ["new"])}


def contents(state):
    """All that a state holds, for comparing."""
    return {
        name: (
            view.values,
            {key: stream.since(0) for key, stream in view.streams.items()},
            {
                kind: (tiled.lattice, dict(sorted(tiled.changed_since(0, 10**6).tiles)))
                for kind, tiled in view.maps.items()
            },
        )
        for name, view in state.robots.items()
    }


def test_a_second_state_becomes_the_same_through_messages():
    rng = np.random.default_rng(1)
    state, other = PageState(), PageState()
    viewer = Viewer(state)
    now = 0.0
    for step in range(60):
        name = f"r{rng.integers(3)}"
        state.put(name, f"v{rng.integers(4)}", [step, {"text": "ü<"}])
        state.append(name, "trail", [step, 0.5])
        if step % 4 == 0:
            cells = rng.integers(-1, 101, (int(rng.integers(1, 200)), 130)).astype(np.int8)
            state.map(name, "local").take(OccupancyGrid.of(cells, 0.05))
        if step % 25 == 24:
            state.forget(name)
            state.put(name, "fresh", True)
        now += 0.4
        update = viewer.update(now)
        if update:
            other.apply(decoded(encoded(update)))
    other.apply(decoded(encoded(viewer.update(now + 10.0) or Update())))
    assert contents(other) == contents(state)


@pytest.mark.parametrize(
    "message", [b"", b"\0\0\0\2{}", b"\0\0\0\1x", b"\0\0\0\x30" + b'{"anew":[],"robots":{},"maps":[],"tiles":[[1]]} ']
)
def test_broken_messages_are_refused(message):
    with pytest.raises(ValueError):
        decoded(message)


def test_robots_and_values_are_bounded(monkeypatch):
    monkeypatch.setattr(state_module, "MAX_ROBOTS", 2)
    monkeypatch.setattr(state_module, "MAX_VALUES", 2)
    state = PageState()
    for name in "ab":
        state.put(name, "x", 1)
        state.put(name, "y", 1)
    with pytest.raises(ValueError, match="'c' is one more"):
        state.put("c", "x", 1)
    with pytest.raises(ValueError, match="'z' is one more"):
        state.put("a", "z", 1)
