"""What is held back of the own map, and for how long."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from map_merger.effects import DELIVERED, Purpose, Send
from map_merger.exchange import Exchange, bounds
from map_merger.exchange.holding import Holding
from map_merger.messages import Tile
from map_merger.options import options_of
from mr_grid import GridInfo, OccupancyGrid

KNOWN = 10_000
SIZE = 200


def told_times(changes, period=1.0):
    """When a map with so many newly changed cells per second is told."""
    holding, waiting, times = Holding(), 0, []
    for index, count in enumerate(changes):
        waiting += count
        if holding.worth(waiting, KNOWN, index * period):
            times.append(index * period)
            waiting = 0
    return times


@given(st.lists(st.integers(0, KNOWN // 4), max_size=60))
def test_nothing_waits_longer_than_the_bound(changes):
    holding, waiting, since = Holding(), 0, math.inf
    for now, count in enumerate(changes):
        waiting += count
        since = min(since, now) if waiting else math.inf
        told = holding.worth(waiting, KNOWN, float(now))
        assert told or now - since < bounds.MARGINAL_HELD_S
        if waiting >= bounds.MARGINAL_CELLS:
            assert told or now - since < bounds.HELD_S + bounds.MARGINAL_HELD_S
        if told:
            waiting, since = 0, math.inf


def test_changes_come_in_larger_pieces():
    assert set(np.diff(told_times([bounds.MARGINAL_CELLS] * 60))) == {bounds.HELD_S}


def test_a_marginal_change_waits_for_more():
    assert told_times([bounds.MARGINAL_CELLS - 1] + [0] * 60) == [bounds.MARGINAL_HELD_S]


def test_a_map_that_grew_a_lot_is_told_at_once():
    much = math.ceil(bounds.GROWN_SHARE * KNOWN)
    assert told_times([much] * 10) == list(range(10))
    assert Holding().worth(1, 0, 0.0), "the first cells"


@pytest.mark.parametrize("back", [1.0, 1000.0])
def test_a_clock_that_jumps_back_holds_nothing_back(back):
    holding = Holding()
    assert holding.worth(bounds.MARGINAL_CELLS, KNOWN, 2000.0)
    assert holding.worth(bounds.MARGINAL_CELLS, KNOWN, 2000.0 - back)


def grid(marks=0):
    cells = np.zeros((SIZE, SIZE), np.int8)
    cells.flat[:marks] = 100
    return OccupancyGrid(GridInfo(SIZE, SIZE, 0.05), cells)


def told_tiles(exchange, begin, end):
    tiles = []
    for now in np.arange(begin, end, 0.5):
        exchange.tick(float(now))
        for send in [each for each in exchange.effects() if isinstance(each, Send)]:
            tiles += [
                (now, each) for each in send.payloads if isinstance(each, Tile) and send.purpose is Purpose.CHANGES
            ]
            exchange.on_sent(send, DELIVERED, float(now))
    return tiles


def exchange_with_marginal_news():
    exchange = Exchange(options_of({"debug": False, "seconds_send_timer": 1}, "robot_0"), (1, 0))
    exchange.on_robot("robot_1", 0.0)
    exchange.on_local_map(grid())
    assert len(told_tiles(exchange, 0.0, 1.0)) == 1
    exchange.on_local_map(grid(3))
    assert told_tiles(exchange, 1.0, 3.0) == []
    return exchange


def test_held_cells_are_told_although_the_map_does_not_change_again():
    ((now, tile),) = told_tiles(exchange_with_marginal_news(), 3.0, 60.0)
    assert now <= 2.0 + bounds.MARGINAL_HELD_S + 1.0 and tile.cells.size == 3


def test_a_robot_that_is_back_is_told_everything_at_once():
    """What is held back would else be missing for that time after a partition."""
    exchange = exchange_with_marginal_news()
    exchange.on_robot("robot_1", 3.0, returned=True)
    assert [now for now, _ in told_tiles(exchange, 3.0, 4.0)] == [3.0]


def test_changes_that_were_taken_back_are_not_told():
    exchange = exchange_with_marginal_news()
    exchange.on_local_map(grid())
    assert told_tiles(exchange, 3.0, 60.0) == []
