"""Decisions as files: what is read back decides as the robot did, and damaged files are refused with one line."""

import dataclasses
import json
import os
from typing import Any, List

import numpy as np
import pytest
from conftest import drawn
from hypothesis import given
from hypothesis import strategies as st
from usual_robot import options_with

from explorer import scene_file
from explorer.agent import ExplorerAgent
from explorer.clusters import Cluster
from explorer.decision import Decision, replayed
from explorer.errors import SceneError
from explorer.foreign import Element
from explorer.messages import Auction, Bid, SendAuction
from explorer.scene import Scene
from explorer.scene_folder import SceneFolder
from explorer.strategies import TITLES, strategy_of
from mr_grid import Pose

ROOMS = [
    "   ......   ##########      ",
    "###......####........####  #",
    "#...........#........#......",
    "#....................#......",
    "#...........#...............",
    "#...........#........#......",
    "######..##########..####### ",
    "     #..#         ..        ",
    "     #..          ..        ",
]


def decisions(strategy: int, seed: int = 3) -> List[Decision]:
    """Of a robot in a team of three, with bids told, a claim, and a goal after the other."""
    made: List[Decision] = []
    agent = ExplorerAgent(options_with(frontier_selection=strategy, robot_name="robot_0", seed=seed), made.append)
    agent.start(0.0)
    agent.on_robots(["robot_1", "robot_2"], 0.0)
    for robot in ("robot_1", "robot_2"):
        agent.on_transform(robot, np.array([[1.0, 0, 0], [0, 1.0, 0]]), 0.0)
    agent.on_frontiers([Element("robot_2", 7, 6.2, 0.3), Element("robot_2", 8, 6.6, 0.3)], 0.0)
    agent.on_auction(Auction("robot_2", 9, True, finished=True, occupied=(("robot_2", 7), ("robot_2", 8))), 0.0)
    occupancy = drawn(ROOMS, scale=8)
    for step in range(120):
        now = 0.2 * step
        agent.on_positions({"robot_1": (18.0, 3.2), "robot_2": (6.4, 1.6)}, now)
        if step % 10 == 0:
            agent.on_global_map(occupancy, now)
        agent.on_pose(Pose(3.0 + 0.01 * step, 3.2, 0.3), now)
        for effect in agent.tick(now):
            if isinstance(effect, SendAuction) and effect.auction.start:
                offers = effect.auction.requested
                bids = tuple(Bid(offer.elements, float(3 * index)) for index, offer in enumerate(offers))
                answer = Auction("robot_1", effect.auction.auction_id, False, available=bids, unit=effect.auction.unit)
                agent.on_auction(answer, now)
    return made


@pytest.fixture(scope="module")
def recorded() -> Decision:
    """One with bids, a claim, and something to choose from."""
    rich = [decision for decision in decisions(7) if decision.bids and decision.scene.claims]
    return max(rich, key=lambda decision: len(decision.scene.open))


@pytest.mark.parametrize("strategy", list(TITLES))
def test_a_decision_from_the_file_is_the_one_that_was_made(strategy: int) -> None:
    """Also where it is left to chance."""
    made = decisions(strategy)
    assert made and any(decision.choice is not None for decision in made)
    assert any(len(decision.scene.open) > 2 for decision in made)
    for decision in made:
        read = scene_file.decision_of(scene_file.text_of(decision))
        assert replayed(read, strategy_of(read.strategy)) == decision.choice
        assert (read.robot, read.strategy, read.reasons) == ("robot_0", strategy_of(strategy).name, decision.reasons)


def test_bids_and_claims_decide_in_the_replay_too(recorded: Decision) -> None:
    """The same scene without them is decided otherwise, so they do come from the file."""
    read = scene_file.decision_of(scene_file.text_of(recorded))
    assert read.bids == recorded.bids and recorded.bids["robot_1"]
    assert read.scene.claimed == recorded.scene.claimed
    assert read.scene.positions == recorded.scene.positions and read.scene.competitors == ("robot_1", "robot_2")
    number = recorded.choice
    dear = {"robot_1": {n: (0.0 if n == number else 1e6) for n in recorded.bids["robot_1"]}}
    bent = dataclasses.replace(read, bids=dear, scene=dataclasses.replace(read.scene, own=None))
    assert replayed(bent, strategy_of(7)) != number


def test_everything_that_a_decision_depends_on_is_in_the_file(recorded: Decision) -> None:
    """A field that is added to a scene and not to its file would make replays wrong without a sign."""
    scene = json.loads(scene_file.text_of(recorded))["scene"]
    assert set(scene) == {each.name for each in dataclasses.fields(Scene)}
    assert set(scene["clusters"][0]) == {each.name for each in dataclasses.fields(Cluster)}
    read = scene_file.decision_of(scene_file.text_of(recorded))
    assert read.scene.clusters == recorded.scene.clusters and read.scene.ready == recorded.scene.ready
    assert np.array_equal(read.scene.ways.occupancy.cells, recorded.scene.ways.occupancy.cells)
    assert read.scene.ways.occupancy.info == recorded.scene.ways.occupancy.info
    assert scene_file.text_of(read) == scene_file.text_of(recorded)


@pytest.mark.parametrize(
    "path, value, problem",
    [
        (["format"], "other", "'format' must be"),
        (["scene"], None, "damaged"),
        (["scene", "pose"], [0.0, 1.0], "3 finite numbers"),
        (["scene", "ways", "cells"], "eJw=", "damaged|not of"),
        (["scene", "ways", "width"], 10**9, "not accepted"),
        (["scene", "ways", "resolution"], -1.0, "resolution of a grid"),
        (["scene", "ready"], [123456], "frontier point 123456 is in no cluster"),
        (["scene", "clusters", 0, "members"], [], "no members"),
        (["bids"], {"robot_1": {"one": 1.0}}, "damaged"),
    ],
)
def test_damaged_files_are_refused(recorded: Decision, path: List[Any], value: Any, problem: str) -> None:
    content = json.loads(scene_file.text_of(recorded))
    at = content
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    with pytest.raises(SceneError, match=problem) as error:
        scene_file.decision_of(json.dumps(content))
    assert "\n" not in str(error.value)
    del at[path[-1]]
    with pytest.raises(SceneError):
        scene_file.decision_of(json.dumps(content))


@given(st.text() | st.recursive(st.none() | st.floats() | st.text(), lambda c: st.lists(c)).map(json.dumps))
def test_any_other_text_is_refused(text: str) -> None:
    with pytest.raises(SceneError):
        scene_file.decision_of(text)


def test_the_newest_decisions_stay_in_the_folder(
    recorded: Decision, tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("explorer.scene_folder.MOST_FILES", 3)
    folder = SceneFolder(str(tmp_path), "robot_0")
    for now in range(5):
        folder.write(dataclasses.replace(recorded, scene=dataclasses.replace(recorded.scene, now=float(now))))
    names = sorted(os.listdir(tmp_path / "robot_0"))
    assert names == [f"decision_{number:06d}.json" for number in (2, 3, 4)]
    assert scene_file.read(str(tmp_path / "robot_0" / names[-1])).scene.now == 4.0
    SceneFolder(str(tmp_path), "robot_0").write(recorded)
    assert os.listdir(tmp_path / "robot_0") == ["decision_000000.json"], "nothing of the former run"
