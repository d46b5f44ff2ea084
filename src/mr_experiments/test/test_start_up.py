"""What happens between switching a team on and the start of its mission."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mr_experiments.host.mission import Mission
from mr_experiments.host.start_up import NODES, ORDER, SENSING, StartUp
from mr_experiments.trial.trial import Trial


@given(st.integers(1, 16), st.integers(0, 2**31))
def test_moments_lie_in_what_was_seen_and_follow_from_the_seed(robots, seed):
    start_up = StartUp.of_team(robots, seed)
    assert all(SENSING[0] <= moment <= SENSING[1] for moment in start_up.sensing)
    waits = np.subtract(start_up.nodes, start_up.sensing)
    assert len(waits) == robots and np.all(waits >= NODES[0] - 1e-9) and np.all(waits <= NODES[1] + 1e-9)
    assert ORDER[0] <= start_up.order <= ORDER[1]
    assert start_up == StartUp.of_team(robots, seed) != StartUp.of_team(robots, seed + 1)


def test_robots_map_wait_and_start_together():
    mission = Mission(Trial("small8x8", 2, 1, limit=5.0))
    start_up = StartUp.of_team(2, 1)
    mapped, begun = [], []
    for robot in mission.robots:
        on_local_map, begin = robot.merger.on_local_map, robot.explorer.begin

        def take(*local_map, on_local_map=on_local_map, index=robot.index):
            mapped.append((index, mission.now))
            on_local_map(*local_map)

        def start(begin=begin, index=robot.index):
            begun.append((index, mission.now))
            begin()

        robot.merger.on_local_map, robot.explorer.begin = take, start
    places = [mission.world.pose(index) for index in range(2)]
    before = []
    mission.run(until=3.0, progress=lambda now: before.append(mission.world.pose(0)) if now == 0.0 else None)
    assert len(before) > 10 and set(before) == {places[0]}
    # SLAM has a map by then, which is latched: map_merger gets it as soon as it is up.
    assert [dict(reversed(mapped))[index] for index in range(2)] == list(start_up.nodes)
    ready = mission.begun_at - start_up.order
    assert max(start_up.nodes) <= ready <= max(start_up.nodes) + 1.0
    assert begun == [(0, mission.begun_at), (1, mission.begun_at)]
    assert mission.world.pose(0) != places[0]


def test_robot_that_joins_late_comes_up_as_the_others():
    mission = Mission(Trial("small8x8", 2, 1, limit=30.0, joins={1: 10.0}))
    late = mission.robots[1]
    mission.run(until=9.9)
    assert not late.senses and not late.running
    mission.run(until=10.0 + StartUp.of_team(2, 1).nodes[1] + 0.2)
    assert late.senses and late.running
    mission.run(until=20.0)
    assert late.explorer.agent.started_at is not None


def test_robot_that_dies_while_its_nodes_come_up_stays_dead():
    mission = Mission(Trial("small8x8", 2, 1, limit=30.0, joins={1: 10.0}, deaths={1: 11.0}))
    mission.run(until=10.5)
    assert not mission.robots[1].running
    mission.run(until=20.0)
    assert not mission.robots[1].senses and not mission.robots[1].running


def test_teams_with_perfect_maps_come_up_as_the_others():
    """Else the decisions of all robots would fall into the same moments."""
    mission = Mission(Trial("small8x8", 2, 1, limit=5.0, fast=True))
    start_up = StartUp.of_team(2, 1)
    mission.run(until=1.0)
    ready = mission.begun_at - start_up.order
    assert max(start_up.nodes) <= ready <= max(start_up.nodes) + 1.0
