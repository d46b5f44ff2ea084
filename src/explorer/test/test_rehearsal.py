"""Whole missions of several agents in virtual time on a small floor plan: complete, never stuck, repeatable."""

from typing import Any

import numpy as np
import pytest
from rehearse import RESOLUTION, Rehearsal


def flat() -> np.ndarray:
    """8 m x 8 m: a hall on the left, two rooms on the right, doors of 1 m."""
    free = np.ones((160, 160), dtype=bool)
    free[[0, 1, -2, -1]] = False
    free[:, [0, 1, -2, -1]] = False
    free[:, 80:83] = False
    free[78:81, 80:] = False
    free[110:130, 80:83] = True
    free[20:40, 80:83] = True
    free[60:70, 30:50] = False
    return free


def mission(robots: int, strategy: int, seed: int = 1, **more: Any) -> Rehearsal:
    return Rehearsal(flat(), robots, strategy, seed, limit=300.0, **more)


@pytest.mark.parametrize("strategy", range(8))
def test_every_strategy_explores_everything(strategy: int) -> None:
    result = mission(2, strategy).run()
    assert result["finished"] and result["coverage"] >= 0.97, result


@pytest.mark.parametrize("robots", [1, 3, 4])
def test_team_sizes(robots: int) -> None:
    result = mission(robots, 7).run()
    assert result["finished"] and result["coverage"] >= 0.97, result


@pytest.mark.parametrize("loss, delay", [(0.3, 0.05), (0.0, 1.5), (0.5, 0.8), (1.0, 0.05)])
def test_lost_late_and_reordered_messages(loss: float, delay: float) -> None:
    for strategy in (1, 7):
        result = mission(3, strategy, loss=loss, delay=delay).run()
        assert result["finished"] and result["coverage"] >= 0.97, result


def test_a_robot_that_dies_leaves_its_cluster_to_the_others() -> None:
    rehearsal = mission(2, 7)
    for robot in rehearsal.robots:
        robot.agent.start(0.0)
    for step in range(3000):
        rehearsal.step(step)
        if step == 60:
            rehearsal.robots[1].alive = False
        if rehearsal.robots[0].agent.finished_at is not None:
            break
    first = rehearsal.robots[0]
    assert first.agent.finished_at is not None
    assert rehearsal.coverage(first.merged) >= 0.97


def test_robots_out_of_range_explore_alone() -> None:
    result = mission(2, 7, radio_range=0.1).run()
    assert result["finished"] and result["coverage"] >= 0.97, result


def test_same_seed_same_mission() -> None:
    first, second = mission(2, 7, seed=5, loss=0.2).run(), mission(2, 7, seed=5, loss=0.2).run()
    for key in ("times", "distance", "messages", "goals"):
        assert first[key] == second[key]


def test_two_robots_are_faster_than_one() -> None:
    one = np.mean([mission(1, 7, seed).run()["time"] for seed in (1, 2)])
    two = np.mean([mission(2, 7, seed).run()["time"] for seed in (1, 2)])
    assert two < one


def test_the_plan_is_what_it_says() -> None:
    assert flat().shape == (8.0 / RESOLUTION, 8.0 / RESOLUTION)
