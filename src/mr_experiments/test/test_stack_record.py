"""Missions of the ROS stack in reports and replays: what the team runner writes is a record."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from mr_experiments.replay.replay import make_page, page_data
from mr_experiments.report.record_set import load_record, load_records
from mr_experiments.report.report import make_report
from mr_experiments.sweep.record import run_trial
from mr_experiments.trial.trial import Trial
from mr_grid import OccupancyGrid, Pose
from mr_launch.begun import begun_record
from mr_launch.mission import Outcome
from mr_launch.record import Course, Ran, Seen, mission_record
from mr_launch.reports import RobotReport
from mr_launch.robot_log import RobotLog, Sample
from mr_launch.truth import Track
from mr_measures.record.files import RecordError, read_record, write_record
from mr_measures.record.mission_record import Note
from mr_measures.record.robot_record import MapFigures, Merge

START = 5.0  # s of simulation time


def driven(meters, start):
    """A track that goes ahead from `start` at 1 m/s from the beginning of the mission, 20 rows a second."""
    track = Track()
    for step in range(int(20 * (START + meters)) + 1):
        x = max(0.0, 0.05 * step - START)
        track.add((0.05 * step, 0.05 * step, start.x + x, start.y, 0.0, 1.0, 0.0, 0, 0))
    return track


STARTS = {"robot_0": Pose(1.0, 2.0), "robot_1": Pose(2.0, 2.5)}
FIGURES = MapFigures(free_cells=8, error=0.1, coverage=0.99, wrong_walls=0.0)
OPTIONS = SimpleNamespace(
    world="small8x8", seed=1, strategy=7, duration=900.0, range=10.0, loss=0.05, wall_attenuation=0.0, open=False,
    initial_poses=False, starts=[], odometry="bias", topology="distributed", slam="ours", navigation="ours", rtf=1.0,
    respawn=False, bag=True, time_limit=0.0, distance_limit=0.0,
)  # fmt: skip
OFFER = {"x": 1.0, "y": 0.0, "bids": {"robot_1": 3.5}, "explored_by": "robot_1"}
PLACED = {"kind": "merge", "at": START + 4.0, "partner": "robot_1", "transform": [1.08, 0.5, 0.0]}
REFERENCE = np.array([[1.0, 2.0], [4.0, 2.0], [4.0, 5.0]])  # m, world frame


def log_of(name):
    """A sample a second; robot_0 sees robot_1, is sent to a place twice and opens an auction."""
    log = RobotLog()
    events = [
        {"kind": "goal", "at": START + 1.0, "id": 1, "x": 2.0, "y": 0.0},
        {"kind": "goal_end", "at": START + 3.0, "outcome": "failed", "text": "no way"},
        {"kind": "goal", "at": START + 3.5, "id": 2, "x": 3.0, "y": 0.0},
        {"kind": "auction", "at": START + 0.5, "id": 17, "clusters": 4},
        {"kind": "answer", "at": START + 0.75, "number": 17, "robot": "robot_1"},
        {"kind": "auction_result", "at": START + 1.0, "number": 17, "unit": 7, "offers": [OFFER]},
        {"kind": "note", "at": START + 3.0, "text": "explorer: no way", "warning": True},
        PLACED,
    ]
    for second in range(31):
        near = ("robot_1",) if name == "robot_0" else ()
        here = {"kind": "pose", "at": START + second, "place": [float(second), 0.0, 0.0]}
        log.take(Sample(START + second, 1.0 + second, 1.0, 10 * second, second, 1, 1, near), [here])
    log.take(Sample(START + 31.0), events if name == "robot_0" else [])
    return log


def course(name, time, known):
    report = RobotReport(name, state=4, exploration_finished=time is not None, exploration_time=time or 0.0,
        start_time=START, goals=9, goals_reached=3, goals_failed=2, auctions=2, sees_merges=True,
        radio={"bytes_sent": 70, "frames_sent": 7, "packets_received_by_hops": [1]})  # fmt: skip
    grid = OccupancyGrid.of(np.array([[0, 100], [-1, 0]], dtype=np.int8), 0.05, Pose(-1.0, -1.0))
    start = STARTS[name]
    plan = SimpleNamespace(name=name, start=start)
    return Course(plan, report, log_of(name), driven(30.0, start), FIGURES, grid, grid, known)


def plan_of(courses, seed=1, base=None):
    options = SimpleNamespace(**{**vars(OPTIONS), "seed": seed})
    return SimpleNamespace(options=options, robots=[one.plan for one in courses], base=base, isolation="namespaces")


def record(time=20.0, seed=1, reason="", failed=False, base=None, restarted="explorer"):
    known = [np.array([START, START + 8.0, np.inf]), np.array([np.inf, np.inf, START + 12.0])]
    courses = [course(f"robot_{number}", time, since) for number, since in enumerate(known)]
    outcome = Outcome(
        START, START + 30.0, reason, failed, ["robot_1 was late"], {"robot_0": {restarted: 1}, "base": {}}
    )
    cpu = {"robot_0": {"explorer": 0.1}, "robot_1": {"explorer": 0.2}}
    plan = plan_of(courses, seed, None if base is None else SimpleNamespace(name="base", start=(0.0, 0.0)))
    return mission_record(plan, outcome, Seen(courses, base, REFERENCE), Ran(1.0e9, cpu, 1.0), {"code": "c"})


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
    assert found.measured.cpu_by_host["robot_1"] == {"explorer": pytest.approx(6.0)}
    assert found.restarts == {"robot_0": {"explorer": 1}} and found.code == "c"


def test_a_mission_without_an_end_is_unfinished(tmp_path):
    write_record(record(time=None, reason="interrupted"), tmp_path / "record.json")
    (found,) = load_records(tmp_path).records
    assert (found.outcome.status, found.outcome.reason, found.team.exploration_time) == (
        "unfinished",
        "interrupted",
        None,
    )


def test_a_mission_in_which_something_broke_has_failed():
    found = record(reason="explorer of robot_0 died", failed=True)
    assert (found.outcome.status, found.team.exploration_time) == ("failed", None)
    assert found.robots["robot_0"].finished_at == 20.0


def test_a_mission_that_never_ended_is_counted_as_failed(missions):
    plan = plan_of([course("robot_0", None, None)], seed=3)
    (missions / "mission-3").mkdir()
    write_record(begun_record(plan, {"code": "c"}), missions / "mission-3" / "record.json")
    records = load_records(missions)
    assert records.counts == {"finished": 2, "unfinished": 0, "failed": 1}
    (lost,) = (each for each in records.records if each.failed)
    assert (lost.asked.world, lost.asked.seed, lost.asked.scenario) == ("small8x8", 3, "ros_stack")
    assert "before it could write" in lost.outcome.reason


def test_what_the_team_knew_together_is_told_over_time(missions):
    found = load_record(missions / "mission-1" / "record.json")
    series = found.team.series
    assert series.time == (0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0)
    assert series.coverage[:4] == pytest.approx((1 / 3, 1 / 3, 2 / 3, 1.0), abs=1e-5)
    assert found.final_coverage == 1.0 and found.team.overlap == 0.0
    assert series.bytes[:3] == (0, 100, 200) and series.frames[:3] == (0, 10, 20)
    assert series.distance[:3] == pytest.approx((0.0, 10.0, 20.0), abs=0.2)


def test_missions_of_the_stack_make_a_report(missions, tmp_path):
    records = load_records(missions)
    assert [each.asked.seed for each in records.records] == [1, 2]
    report = make_report(missions, tmp_path / "report", with_bound=False)
    text = (tmp_path / "report" / "report.html").read_text()
    assert report is not None and "2 missions: 2 finished" in text and "Transforms to other robots" in text


def test_transforms_are_judged_by_where_the_robots_were():
    robots = record().robots
    assert robots["robot_0"].merges == (
        Merge("robot_1", 4.0, Pose(1.08, 0.5, 0.0), pytest.approx(0.08, abs=1e-3), 0.0, "right", True),
    )
    assert robots["robot_1"].merges == ()


def test_those_of_a_robot_whose_map_was_lost_are_not_judged(tmp_path):
    """Nobody knows which of its maps another robot means."""
    found = record(restarted="slam")
    assert found.merges_recorded and not found.merges_judged
    assert [merge.right for merge in found.robots["robot_0"].merges] == [None]
    write_record(found, tmp_path / "record.json")
    make_report(tmp_path, tmp_path / "report", with_bound=False)
    assert "Transforms to other robots" not in (tmp_path / "report" / "report.html").read_text()


def test_what_the_base_station_sends_and_says_is_the_teams():
    base = RobotLog()
    for second in range(31):
        base.take(Sample(START + second, bytes=1000 * second, frames=100 * second), [])
    base.take(
        Sample(START + 31.0), [{"kind": "note", "at": START + 9.0, "text": "map_merger: hello", "warning": False}]
    )
    found = record(base=base)
    assert found.team.series.bytes[:3] == (0, 5100, 10200) and found.team.series.frames[:3] == (0, 510, 1020)
    assert Note(9.0, "base", "map_merger: hello") in found.notes and list(found.robots) == ["robot_0", "robot_1"]


def test_it_says_what_a_record_of_virtual_time_says():
    """But for maps on the way, and what differs between the hosts by its nature."""
    ours, virtual = record(), run_trial(Trial("small8x8", 2, 1, limit=2.0))
    theirs = virtual.robots["robot_0"]
    assert ours.robots["robot_0"].counters.keys() == theirs.counters.keys()
    assert {name for name, column in vars(ours.robots["robot_0"].series).items() if column} == {
        name for name, column in vars(theirs.series).items() if column
    }
    assert {name for name, column in vars(ours.team.series).items() if column} == {
        name for name, column in vars(virtual.team.series).items() if column
    }
    settings = ours.asked.settings.keys()
    assert (
        virtual.asked.settings.keys() - settings == {"deaths", "joins"} and ours.measured.host == virtual.measured.host
    )
    assert ours.measured.started == "2001-09-09T01:46:40" and virtual.measured.started


def test_a_mission_of_the_stack_is_replayed(missions):
    found = read_record(missions / "mission-1" / "record.json")
    series = found.robots["robot_0"].series
    assert series.time[:3] == pytest.approx((0.0, 1.0, 2.0)) and series.x[:3] == pytest.approx((1.0, 2.0, 3.0))
    assert math.isclose(series.distance[-1], 30.0, abs_tol=0.1)
    assert "robot_0" in make_page(found)
    page = page_data(found)
    (merge,) = page["merges"]
    assert (merge["at"], merge["kind"], merge["name"]) == (4, "right", "robot_1")
    goals, auctions = page["robots"][0]["goals"], page["robots"][0]["auctions"]
    assert [(goal["set"], goal["end"], goal["x"], goal["outcome"]) for goal in goals] == [
        (1, 3, 3, "failed"), (3.5, None, 4, "")
    ]  # fmt: skip
    (opened,) = auctions
    assert opened == {
        "at": 0.5, "id": 17, "clusters": 4, "unit": 7, "offers": [[2, 2, {"robot_1": 3.5}, "robot_1"]],
        "answered": {"robot_1": 0.75}, "decided": 1,
    }  # fmt: skip
    assert page["links"] == [[0, 30, 0, 1, False]] and page["team"]["explored"]
    assert {"robot_0 failed to reach its goal: no way", "robot_0: explorer: no way"} <= {
        event["text"] for event in page["events"]
    }
    assert not [note for note in page["notes"] if "recorded" in note], page["notes"]


def test_two_missions_of_one_seed_are_refused(missions):
    write_record(record(seed=1), missions / "mission-2" / "record.json")
    with pytest.raises(RecordError, match=r"mission-2/record.json and .*mission-1/record.json record the same trial"):
        load_records(missions)
