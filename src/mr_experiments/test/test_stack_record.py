"""Missions of the ROS stack in reports and replays: what the team runner writes is a record."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from mr_experiments.replay.replay import make_page, page_data
from mr_experiments.report.record_set import load_record, load_records
from mr_experiments.report.report import make_report
from mr_grid import OccupancyGrid, Pose
from mr_launch.mission import Outcome
from mr_launch.record import mission_record
from mr_launch.truth import Track
from mr_measures.record.files import RecordError, read_record, write_record
from mr_measures.record.robot_record import MapFigures, Merge

START = 5.0  # s of simulation time


def driven(meters):
    """A track that goes ahead at 1 m/s from the start of the mission, 20 rows a second."""
    track = Track()
    for step in range(int(20 * (START + meters)) + 1):
        x = max(0.0, 0.05 * step - START)
        track.add((0.05 * step, 0.05 * step, 1.0 + x, 2.0, 0.0, 1.0, 0.0, 0, 0))
    return track


FIGURES = MapFigures(free_cells=8, error=0.1, coverage=0.99, wrong_walls=0.0)


def summary_of(time, **more):
    return {"time": time, "state": "finished", "goals_reached": 3, "auctions": 2,
            "radio": {"bytes_sent": 70, "frames_sent": 7, "packets_received_by_hops": [1]}, **more}  # fmt: skip


def record(time=20.0, seed=1, reason=""):
    options = SimpleNamespace(
        world="small8x8", seed=seed, strategy=7, duration=900.0, range=10.0, loss=0.05, wall_attenuation=0.0,
        odometry="bias", topology="distributed", slam="ours", navigation="ours", rtf=1.0,
    )  # fmt: skip
    robots = [SimpleNamespace(name=f"robot_{number}", start=(1.0, 2.0, 0.0)) for number in range(2)]
    team = {
        "exploration_time": time,
        "real_time_factor": 1.0,
        "cpu": {"robot_0": {"explorer": 0.1}, "robot_1": {"explorer": 0.2}},
    }
    summary = {"team": team, "robots": {robot.name: summary_of(time) for robot in robots}}
    grid = OccupancyGrid.of(np.array([[0, 100], [-1, 0]], dtype=np.int8), 0.05, Pose(-1.0, -1.0))
    outcome = Outcome(START, START + 30.0, reason, ["robot_1 was late"])
    truth = SimpleNamespace(tracks={robot.name: driven(30.0) for robot in robots})
    plan, figures = SimpleNamespace(options=options, robots=robots), {robot.name: FIGURES for robot in robots}
    merges = {"robot_0": (Merge("robot_1", 4.0, Pose(1.0, 0.0, 0.0)),), "robot_1": None}
    known = {"robot_0": np.array([START, START + 8.0, np.inf]), "robot_1": np.array([np.inf, np.inf, START + 12.0])}
    return mission_record(plan, summary, outcome, truth, {"robot_0": grid}, figures, merges, known)


@pytest.fixture
def missions(tmp_path):
    for seed in (1, 2):
        (tmp_path / f"mission-{seed}").mkdir()
        write_record(record(seed=seed), tmp_path / f"mission-{seed}" / "record.json")
    return tmp_path


def test_figures_of_a_robot_end_when_it_has_finished(missions):
    found = load_record(missions / "mission-1" / "record.json")
    assert (found.outcome.status, found.team.exploration_time, found.asked.scenario) == ("finished", 20.0, "ros_stack")
    assert found.distance == pytest.approx(40.0, abs=0.2) and found.outcome.time == 30.0
    assert found.measured.cpu_by_component == {"explorer": pytest.approx(9.0)}


def test_a_mission_without_an_end_is_unfinished(tmp_path):
    write_record(record(time=None, reason="interrupted"), tmp_path / "record.json")
    (found,) = load_records(tmp_path).records
    assert (found.outcome.status, found.outcome.reason, found.team.exploration_time) == (
        "unfinished",
        "interrupted",
        None,
    )


def test_what_the_team_knew_together_is_told_over_time(missions):
    found = load_record(missions / "mission-1" / "record.json")
    series = found.team.series
    assert series.time == (0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0)
    assert series.coverage[:4] == pytest.approx((1 / 3, 1 / 3, 2 / 3, 1.0), abs=1e-5)
    assert found.final_coverage == 1.0 and found.team.overlap == 0.0


def test_missions_of_the_stack_make_a_report_without_what_they_do_not_know(missions, tmp_path):
    records = load_records(missions)
    assert [each.asked.seed for each in records.records] == [1, 2] and not any(
        each.merges_judged for each in records.records
    )
    report = make_report(missions, tmp_path / "report")
    text = (tmp_path / "report" / "report.html").read_text()
    assert report is not None and "2 missions: 2 finished" in text and "Transforms to other robots" not in text


def test_a_mission_of_the_stack_is_replayed(missions):
    found = read_record(missions / "mission-1" / "record.json")
    series = found.robots["robot_0"].series
    assert series.time[:3] == pytest.approx((0.0, 1.0, 2.0)) and series.x[:3] == pytest.approx((1.0, 2.0, 3.0))
    assert math.isclose(series.distance[-1], 30.0, abs_tol=0.1)
    assert "robot_0" in make_page(found)
    (merge,) = page_data(found)["merges"]
    assert (merge["at"], merge["kind"], merge["name"]) == (4, "unknown", "robot_1")


def test_two_missions_of_one_seed_are_refused(missions):
    write_record(record(seed=1), missions / "mission-2" / "record.json")
    with pytest.raises(RecordError, match=r"mission-2/record.json and .*mission-1/record.json record the same trial"):
        load_records(missions)
