"""Navigation beside other libraries: the seam, the rows, and what is said where they are not built."""

import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from usual_robot import navigation_with

from mr_robot import _navigation
from mr_sim import bench_navigation_peers
from mr_sim.bench_navigation_peers import EngineRun, rows
from mr_sim.nuisance import mrpt_follower
from mr_sim.nuisance.mrpt_follower import settings
from mr_sim.nuisance.planners import OURS, ompl, planning_with
from mr_sim.nuisance.runs import GoalRun, SceneRun, run_seed


def test_another_planner_plans_the_manoeuvres_and_ours_is_back_afterwards() -> None:
    asked = []

    def none(*arguments: object) -> np.ndarray:
        asked.append(arguments)
        return np.empty((0, 5))

    with planning_with(none) as spent:
        run_seed(6)
    assert len(asked) == len(spent) > 0
    assert _navigation.manoeuvre is OURS


def test_ompl_is_asked_for_all_that_its_binding_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def manoeuvre(
        cost, resolution, origin, goal, pose, obstacles, footprint, agility, radius: float, limit: float
    ) -> np.ndarray:
        asked.append((type(footprint), type(agility), radius, limit))
        return np.empty((0, 5))

    monkeypatch.setitem(sys.modules, "_ompl_peer", SimpleNamespace(manoeuvre=manoeuvre))
    with planning_with(ompl(0.3, 0.01)):
        run_seed(6)
    assert set(asked) == {(_navigation.Footprint, _navigation.Agility, 0.3, 0.01)}


def test_mrpt_is_told_the_obstacles(monkeypatch: pytest.MonkeyPatch) -> None:
    told = []

    class Navigator:
        def __init__(self, settings: str) -> None:
            pass

        def go(self, target, allowed, speed) -> None:
            pass

        def step(self, now, pose, velocity, obstacles: np.ndarray):
            told.append(obstacles.shape[1])
            return 0.3, 0.0, True

    monkeypatch.setitem(sys.modules, "_mrpt_peer", SimpleNamespace(Navigator=Navigator))
    mrpt_follower._navigator.cache_clear()
    with mrpt_follower.driving_with_mrpt() as spent:
        run_seed(6)
    mrpt_follower._navigator.cache_clear()
    assert set(told) == {4} and len(spent) == len(told)


def test_each_engine_has_its_rows() -> None:
    reached = GoalRun(0, (1.0, 1.0), True, 12.0, 8.0, "")
    scene = SceneRun("jamb", 1, (reached, replace(reached, reached=False)), 2, 100, 0.1, 0.01)
    table = rows(
        {"ours": [EngineRun(replace(scene, goals=(reached,), contacts=0), ())], "X": [EngineRun(scene, (0.05, 0.15))]}
    )
    values = {row.what: (row.value, row.holds) for row in table}
    assert values["stuck per 100 goals, ours"] == (0.0, True) and values["stuck per 100 goals, X"] == (50.0, False)
    assert values["steps in contact, X"] == (2, False)
    assert values["time over the ideal, X"] == (1.5, True)
    assert values["processor time of a plan, X"] == (100.0, True)
    assert "jamb 1" in table[4].detail and "longest 150.0 ms" in table[7].detail


def test_the_robot_is_in_the_settings_of_mrpt() -> None:
    text = settings(navigation_with(footprint_length=0.6), "folder")
    assert "RobotModel_shape2D_xs = -0.32 0.32 0.32 -0.32" in text and "PTG_COUNT = 4" in text and "{a}" not in text


def test_peers_that_are_not_built_are_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "_ompl_peer", None)
    assert bench_navigation_peers.main(["--seeds", "1", "--engines", "OMPL RRT-Connect 10 ms"]) == 1
    assert "make bench-navigation-peers" in capsys.readouterr().err
