"""Whole agents with maps of offices: partition, restarts, wrong transforms, robots forgotten, places through others."""

import math
from dataclasses import replace

import numpy as np
import pytest
from team import options, survey, take, team_of

from map_merger.agent import Agent
from map_merger.benchmark import injection
from map_merger.exchange_benchmark import same
from map_merger.graph.edges import EdgeReport
from map_merger.meetings import TrackReport
from map_merger.messages import Anchor, Request, Tile
from map_merger.robot_size import USUAL_SIZE
from map_merger.synthetic import pair_of
from map_merger.transform import displacement, rotation_between
from mr_grid import Pose

CORNERS = np.array([[0.0, 0.0], [8.0, 0.0], [0.0, 8.0], [-8.0, -8.0]])


@pytest.fixture(autouse=True)
def walls_convince(monkeypatch):
    """How much wall convinces in a building that repeats is a matter of registration."""
    monkeypatch.setattr("map_merger.registration.LARGEST_LOOKALIKE", math.inf)


@pytest.fixture(scope="module")
def maps():
    return survey(4, stages=(0.6, 0.7, 0.8, 0.9, 1.0))


def placed_team(maps, stage=-1):
    """Robots that have all placed one another."""
    team = team_of(*(f"robot_{number}" for number in range(len(maps))))
    for number, each in enumerate(maps):
        team.agents[f"robot_{number}"].on_local_map(each.stages[stage], team.now)
    while team.now < 200.0 and any(len(agent.view.transforms()) < len(maps) - 1 for agent in team.agents.values()):
        team.run(1.0)
    return team


def number_of(name):
    return int(name[-1])


def assert_right(team, maps, shift=0.2):
    for own, agent in team.agents.items():
        assert set(agent.view.transforms()) == set(team.agents) - {own}
        for robot, transform in agent.view.transforms().items():
            truth = pair_of(maps[number_of(own)], maps[number_of(robot)]).truth
            assert displacement(truth, transform, CORNERS).max() < shift, (own, robot)


def assert_agree(team, shift=0.05, turn=0.5):
    """Whichever robot is asked, the frames of any two lie alike."""
    for own, agent in team.agents.items():
        there = {own: Pose(), **agent.view.transforms()}
        for first in team.agents:
            for second, transform in team.agents[first].view.transforms().items():
                seen = there[first].inverse().compose(there[second])
                between = transform.inverse().compose(seen)
                assert math.hypot(between.x, between.y) <= shift, (own, first, second)
                assert rotation_between(seen, transform) <= math.radians(turn), (own, first, second)


def test_after_a_partition_of_a_minute_maps_and_transforms_agree_within_ten_seconds(maps):
    maps = maps[:3]
    team = placed_team(maps, stage=0)
    assert_right(team, maps)
    team.lost = lambda sender, receiver, payload: "robot_0" in (sender, receiver)
    apart = [("robot_0", "robot_1"), ("robot_0", "robot_2"), ("robot_1", "robot_0"), ("robot_2", "robot_0")]
    for own, robot in apart:
        team.agents[own].on_robot_lost(robot, team.now)
    for stage in range(1, 5):
        team.run(15.0)
        for number, each in enumerate(maps):
            team.agents[f"robot_{number}"].on_local_map(each.stages[stage], team.now)
    assert not same(team.agents["robot_1"].exchange.map_of("robot_0"), maps[0].grid)
    team.lost = lambda *_: False
    team.run(1.0)
    for own, robot in apart:
        team.agents[own].on_robot(robot, team.now, returned=True)
    team.run(9.0)
    for own, agent in team.agents.items():
        for robot in set(team.agents) - {own}:
            assert same(agent.exchange.map_of(robot), maps[number_of(robot)].grid), (own, robot)
    assert_right(team, maps)
    assert_agree(team)


def test_late_messages_of_a_former_run_change_nothing(maps):
    """Tiles, anchor, transforms and track that a robot sent before it started anew, in another frame."""
    before = [maps[0], maps[3], maps[2]]
    team = placed_team(before)
    late = [
        payload for kind in (Anchor, Tile, EdgeReport) for payload in team.sent(kind, "robot_1") if payload is not None
    ]
    assert {type(payload) for payload in late} == {Anchor, Tile, EdgeReport}
    poses = np.column_stack([np.linspace(3.0, 0.0, 20), np.linspace(0.0, 2.0, 20), np.zeros((20, 2))])
    late.append(TrackReport("robot_1", USUAL_SIZE.body_radius, (1, 1), 50.0, poses=poses, unplaced=("robot_0",)))
    team.agents["robot_1"] = Agent(options("robot_1"), (2, 1))
    team.agents["robot_1"].on_local_map(maps[1].grid, team.now)
    team.run(60.0)
    assert_right(team, maps[:3])
    others = [team.agents["robot_0"], team.agents["robot_2"]]
    transforms = [agent.view.transforms() for agent in others]
    versions = [agent.exchange.version_of("robot_1") for agent in others]
    jobs, asked = team.jobs, len(team.sent(Request))
    for agent in others:
        for payload in late:
            take(agent, payload, team.now)
    team.run(20.0)
    assert [agent.view.transforms() for agent in others] == transforms
    assert [agent.exchange.version_of("robot_1") for agent in others] == versions
    assert all(same(agent.exchange.map_of("robot_1"), maps[1].grid) for agent in others)
    assert (team.jobs, len(team.sent(Request))) == (jobs, asked)


def test_a_robot_that_is_forgotten_is_gone_and_is_found_again_when_it_is_heard(maps):
    maps = maps[:3]
    team = placed_team(maps)
    agent = team.agents["robot_0"]
    team.lost = lambda sender, receiver, payload: (sender, receiver) == ("robot_1", "robot_0")
    assert agent.forget("robot_1") and not agent.forget("robot_1")
    team.run(20.0)
    assert "robot_1" not in agent.view.transforms() and "robot_1" not in dict(team.transforms["robot_0"])
    assert agent.exchange.map_of("robot_1") is None and agent.view.verdict("robot_1") == "robot not known"
    assert [each.robot for each in agent.view.status(team.now).robots] == ["robot_2"]
    team.lost = lambda *_: False
    team.run(30.0)
    assert_right(team, maps)


@pytest.mark.parametrize("seed", [6, 10])
def test_a_wrong_transform_goes_everywhere_and_the_right_ones_stay(seed):
    """Robots placed by the wrong transform confirmed it: their walls lay where it put them."""
    outcome = injection.inject(seed, watched=30.0)
    assert outcome.gone is not None and outcome.gone <= 20.0 and outcome.placed == 12


def test_a_wrong_transform_that_is_told_misleads_nobody():
    random = np.random.default_rng(3)
    maps = injection.explored(random)
    team = injection.team_of(maps, frozenset((one, other) for one in maps for other in maps if one < other))
    injection.grow(team, maps, 0)
    team.run(15.0)
    report = team.edges["robot_1"]
    wrong = tuple(
        replace(edge, transform=edge.transform.compose(Pose(4.0, -3.0, 1.0)), shared_wall=60.0, met=True)
        if edge.target == "robot_2"
        else edge
        for edge in report.edges
    )
    assert wrong != report.edges
    for own in ("robot_0", "robot_2", "robot_3"):
        agent, before = team.agents[own], team.agents[own].view.transforms()
        agent.on_edges(report._replace(edges=wrong), team.now)
        assert set(agent.view.transforms()) == set(before)
        assert all(
            displacement(before[name], now, CORNERS).max() < 0.2 for name, now in agent.view.transforms().items()
        )


def test_a_place_through_another_robot_serves_as_prior_for_an_own_transform(monkeypatch):
    """In buildings that repeat robots 0 and 2, alone, believe nothing."""
    monkeypatch.setattr("map_merger.registration.LARGEST_LOOKALIKE", -1.0)
    maps = injection.explored(np.random.default_rng(4), 3)
    alone = {name: maps[name] for name in ("robot_0", "robot_2")}
    assert own_pairs(injection.team_of(alone, frozenset()), alone) == set()
    team = injection.team_of(maps, frozenset({("robot_0", "robot_1"), ("robot_1", "robot_2")}))
    assert ("robot_0", "robot_2") not in own_pairs(team, maps, stages=1)
    assert team.agents["robot_0"].view.placements()["robot_2"].via == ("robot_1",)
    assert ("robot_0", "robot_2") in own_pairs(team, maps)


def own_pairs(team, maps, stages=6):
    """The pairs of which somebody has found the transform while they explored."""
    for stage in range(stages):
        injection.grow(team, maps, stage)
        team.run(5.0)
    return {edge.pair for edge in injection.told(team)}
