"""A node that is started anew goes on with the run of its map."""

import math

import numpy as np
import pytest
from team import options, survey, team_of

from map_merger import registration
from map_merger.agent import Agent
from map_merger.kept_run import SKIPPED, anchor_of, value_of
from map_merger.messages import Anchor
from map_merger.registrar import Registrar
from mr_grid import GridInfo, Pose

ANCHOR = Anchor("robot_0", GridInfo(0, 0, 0.05, Pose(-1.0, 2.0, 0.3)), (4_000_000_000, 7), 12)


def test_what_was_kept_is_found_again_with_numbers_to_spare():
    assert anchor_of(value_of(ANCHOR, "uri"), "robot_0", "uri") == ANCHOR._replace(updates=12 + SKIPPED)


@pytest.mark.parametrize(
    "change",
    [
        {"source": "other"},
        {"robot": "robot_1"},
        {"boot": ["1"]},
        {"corner": [0.0, 0.0, 0.0]},
        {"corner": [math.nan, 0.0, 0.0, 0.05]},
        {"corner": [0.0, 0.0, 0.0, 0.0]},
        {"updates": -1},
        {"updates": "many"},
    ],
)
def test_what_is_of_another_map_or_garbage_is_not_gone_on_with(change):
    assert anchor_of({**value_of(ANCHOR, "uri"), **change}, "robot_0", "uri") is None
    assert anchor_of(change, "robot_0", "uri") is None


@pytest.mark.parametrize("value", [None, 3, "run", []])
def test_nothing_kept_is_nothing_to_go_on_with(value):
    assert anchor_of(value, "robot_0", "uri") is None


def test_without_a_source_nothing_is_gone_on_with():
    assert anchor_of(value_of(ANCHOR, ""), "robot_0", "") is None


def test_a_robot_whose_node_was_started_anew_is_placed_by_the_others_and_never_lost_to_them(monkeypatch):
    """No registration is possible any more, and none is needed."""
    monkeypatch.setattr(registration, "LARGEST_LOOKALIKE", math.inf)
    stages = 20
    maps = survey(3, path_length=40.0, stages=tuple(np.linspace(1 / stages, 1, stages)))
    team = team_of("robot_0", "robot_1", "robot_2")
    for stage in range(stages):
        for number, each in enumerate(maps):
            team.agents[f"robot_{number}"].on_local_map(each.stages[stage], team.now)
        team.run(3)
    before = team.agents["robot_0"].view.transforms()
    assert {"robot_1", "robot_2"} <= set(before)
    monkeypatch.setattr(Registrar, "next_job", lambda *_: None)

    kept = anchor_of(value_of(team.agents["robot_0"].exchange.anchor, "uri"), "robot_0", "uri")
    agent = team.agents["robot_0"] = Agent(options("robot_0"), kept.boot)
    agent.exchange.resume(kept)
    agent.on_local_map(maps[0].grid, team.now)
    for robot in ("robot_1", "robot_2"):
        agent.on_robot(robot, team.now)
    for _ in range(60):
        team.run(0.25)
        assert "robot_0" in team.agents["robot_1"].view.transforms()
    after = agent.view.transforms()
    for robot in ("robot_1", "robot_2"):
        assert math.dist(after[robot][:2], before[robot][:2]) < 0.05
    team.run(10)
    assert team.agents["robot_1"].exchange.missing("robot_0") is None
    assert (
        team.agents["robot_1"].exchange.map_of("robot_0").info.shape
        == team.agents["robot_2"].exchange.map_of("robot_0").info.shape
    )
