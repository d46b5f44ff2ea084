"""Whole missions on a small floor: each strategy explores everything, whatever the radio and the others do."""

import pytest

from mr_experiments.sweep.record import run_trial
from mr_experiments.trial.radio_options import RadioOptions
from mr_experiments.trial.trial import Trial


def survivors_of(trial):
    """Robots of a mission that has ended well, as in its record."""
    record = run_trial(trial)
    assert record.outcome.status == "finished", record.outcome
    return [robot for index, robot in enumerate(record.robots.values()) if index not in trial.deaths]


def assert_complete(trial):
    for robot in survivors_of(trial):
        assert robot.map.coverage > 0.98, robot.map


@pytest.mark.parametrize("strategy", range(8))
def test_every_strategy_explores_everything(strategy):
    assert_complete(Trial("small8x8", 2, 1, strategy=strategy, limit=600.0, fast=True))


@pytest.mark.parametrize("robots", [3, 4])
def test_team_sizes(robots):
    assert_complete(Trial("small8x8", robots, 1, limit=300.0, fast=True))


@pytest.mark.parametrize("strategy", [1, 7])
@pytest.mark.parametrize(
    ("robots", "radio"), [(3, RadioOptions(loss=0.3)), (2, RadioOptions(range=0.1))], ids=["loss", "out of range"]
)
def test_lost_late_and_reordered_messages(strategy, robots, radio):
    assert_complete(Trial("small8x8", robots, 1, strategy=strategy, limit=600.0, radio=radio))


@pytest.mark.parametrize("strategy", [1, 5, 7])
def test_a_robot_that_dies_leaves_its_cluster_to_the_others(strategy):
    assert_complete(Trial("small8x8", 2, 1, strategy=strategy, limit=600.0, fast=True, deaths={1: 6.0}))
