"""What the global map is drawn from, while transforms come and go."""

import numpy as np
import pytest
from team import options

from map_merger.agent import Agent
from map_merger.exchange import Exchange
from map_merger.merged_map import MergedMap
from map_merger.messages import Anchor, Tile
from map_merger.reference import Reference
from map_merger.whereabouts import Whereabouts
from mr_grid import OCCUPIED, GridInfo, OccupancyGrid, Pose


def tell_map(exchange, rows=slice(90, None)):
    """Robot b tells a map of 5 m x 5 m with some free rows."""
    cells = np.full((100, 100), -1, np.int8)
    cells[rows] = 0
    exchange.on_anchor(Anchor("b", GridInfo(0, 0, 0.05), (2, 2), 1), 0.0)
    exchange.on_tile(Tile("b", (0,), 0, 0, cells, 0.05, (2, 2), 1), 0.0)


@pytest.mark.parametrize("drawn", [True, False])
def test_the_way_of_a_robot_that_is_not_placed_any_more_erases_nothing(drawn):
    """Where its map was not drawn, obstacles along a wrong way stayed erased when its transform had been revoked."""
    exchange, reference, whereabouts = Exchange(options("a"), (1, 1)), Reference(), Whereabouts()
    exchange.meet("b")
    if drawn:
        tell_map(exchange)
    cells = np.zeros((100, 100), np.int8)
    cells[30, 40:44] = OCCUPIED
    reference.set(OccupancyGrid.of(cells, 0.05))
    for step in range(60):
        whereabouts.on_position("b", Pose(2.1, 0.3 + 0.07 * step), 100.0 + 0.1 * step)
    merged = MergedMap(options("a"))
    now = 100.0

    def obstacles(transforms):
        nonlocal now
        for _ in range(8):
            now += 1.0
            merged.step(reference, exchange, transforms, whereabouts, now)
        return int((merged.grid.cells == OCCUPIED).sum())

    before = obstacles({})
    assert obstacles({"b": Pose()}) < before
    assert obstacles({}) == before


def test_a_robot_that_the_radio_names_no_more_is_lost():
    """adhoc_communication that was started anew never says that a robot is gone of which it has not heard."""
    agent = Agent(options("a"), (1, 1))
    agent.on_robots(["b", "c"], 0.0)
    agent.on_robots(["c"], 1.0)
    assert agent.exchange.present("b"), "once may be chance"
    agent.on_robots(["c"], 2.0)
    assert not agent.exchange.present("b") and agent.exchange.present("c")
    agent.on_robots(["b", "c"], 3.0)
    assert agent.exchange.present("b")


def test_another_robot_of_a_name_that_was_forgotten_has_landmarks_of_its_own():
    """Its runs count from the beginning, so that its map was taken for the one of before."""
    agent = Agent(options("a"), (1, 1))
    agent.on_local_map(OccupancyGrid.of(np.zeros((100, 100), np.int8), 0.05), 0.0)
    keys = []
    for rows in (slice(90, None), slice(50, None)):
        agent.on_robot("b", 0.0)
        tell_map(agent.exchange, rows)
        keys.append(agent._own_transforms._maps(0.0)["b"].key)
        agent.forget("b")
    assert keys[0] != keys[1]
