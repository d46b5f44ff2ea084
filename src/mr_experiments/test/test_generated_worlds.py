"""Missions in worlds that are drawn from a seed, and the command that shows them."""

import cv2
import numpy as np
import pytest

from mr_experiments.sweep.record import run_trial
from mr_experiments.trial.trial import Trial, TrialError
from mr_experiments.worlds.plans_command import main
from mr_measures.record.robot_record import Contacts


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("kind", "fast", "robots"), [("rooms", False, 1), ("narrow", True, 2)])
def test_a_mission_explores_a_generated_world(kind, fast, robots, folder):
    record = run_trial(Trial(f"generated:{kind}:11:15x10", robots, 1, fast=fast))
    assert record.outcome.status == "finished", record.outcome
    for robot in record.robots.values():
        assert robot.map.coverage > 0.99 and robot.map.wrong_walls < 0.05
        assert robot.collisions == Contacts()
        assert robot.map.error is None and robot.map.error_reason, "it has no reference missions"
    assert (folder / f"out/worlds/generated-{kind}-11-15x10.knowable.npz").exists()


def test_trials_in_worlds_of_other_sizes_have_other_records():
    keys = {Trial(f"generated:office:1:{size}", 1, 1).key for size in ("37.5x20", "37.5x20.5", "38x20")}
    assert len(keys) == 3 and not any(":" in key for key in keys)


def test_a_trial_in_a_world_that_cannot_be_is_refused():
    with pytest.raises(TrialError, match="castle"):
        Trial("generated:castle:1", 1, 1)


def test_plans_lists_the_kinds(capsys):
    assert main([]) == 0
    assert all(kind in capsys.readouterr().out.splitlines()[1:][0] for kind in ["office"])


def test_plans_draws_the_worlds_asked_for(folder):
    assert main(["generated:hall:3:20x15", "generated:cave:4:anywhere", "--out", "sheet.png"]) == 0
    picture = cv2.imread(str(folder / "sheet.png"))
    assert picture.shape[1] > 200 + 260 and picture.shape[0] > 180


def test_plans_draws_stored_worlds(folder):
    assert main(["narrow", "small8x8", "--out", str(folder / "worlds.png")]) == 0
    picture = cv2.imread(str(folder / "worlds.png"))
    red = (picture == (60, 60, 220)).all(axis=2)
    found, _ = cv2.connectedComponents(red.astype(np.uint8))
    assert found - 1 == 16 + 4


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["generated:hall:3"], "--out"),
        (["generated:hal:3"], "no kind of world is called 'hal', did you mean 'hall'?"),
        (["generated:castle:3", "--out", "a.png"], "castle"),
        (["--out", "a.jpg"], "a.jpg"),
    ],
)
def test_bad_calls_of_plans(arguments, told, capsys, folder):
    assert main(arguments) == 2
    assert told in capsys.readouterr().err and not list(folder.iterdir())
