"""When a team counts as merged, and the rows of the benchmark."""

import json
import math
from dataclasses import replace

import pytest
from made_missions import made_mission, made_robot

from mr_experiments.bench import bench_merging, bench_merging_command
from mr_experiments.bench.bench_merging import PARTS, Request, wrong_row
from mr_experiments.bench.merge_times import all_settled_at, classes_of_pairs, known_at, quantile, settled_at
from mr_experiments.common.code_version import code_version
from mr_experiments.sweep.record import run_trial
from mr_experiments.sweep.trial_process import record_path
from mr_experiments.trial.trial import Trial
from mr_grid import Pose
from mr_measures.record.mission_record import Measured
from mr_measures.record.robot_record import Merge
from mr_measures.record.series import TeamSeries


def entry(at, kind="right", other="robot_1"):
    """`kind` None: the transform was revoked."""
    return Merge(other, at, None) if kind is None else Merge(other, at, Pose(), kind=kind, right=kind != "wrong")


def record(first, second, status="unfinished", seed=1, time=60.0, **parts):
    """Of two robots with these merges."""
    second = [replace(one, partner="robot_0") for one in second]
    robots = [made_robot(merges=tuple(merges)) for merges in (first, second)]
    return made_mission(robots, status, time, settings={"seed": seed}, **parts)


@pytest.mark.parametrize(
    "entries, since",
    [
        ([], math.inf),
        ([entry(3.0)], 3.0),
        ([entry(3.0, "imprecise"), entry(5.0)], 3.0),
        ([entry(3.0, "wrong"), entry(9.0)], 9.0),
        ([entry(3.0), entry(9.0, "wrong")], math.inf),
        ([entry(3.0), entry(9.0, "wrong"), entry(12.0)], 12.0),
        ([entry(3.0), entry(9.0, None)], math.inf),
        ([entry(3.0), entry(9.0, None), entry(20.0)], 20.0),
    ],
)
def test_transform_counts_from_when_it_is_right_and_stays(entries, since):
    assert settled_at(entries) == since


def test_team_is_merged_when_the_last_direction_is():
    assert all_settled_at(record([entry(3.0)], [entry(8.0)])) == 8.0
    assert all_settled_at(record([entry(3.0)], [])) == math.inf


def test_pair_counts_once_and_by_its_worst():
    assert classes_of_pairs(record([entry(3.0)], [entry(4.0, "wrong"), entry(5.0)])) == ["wrong"]
    assert classes_of_pairs(record([entry(3.0, "imprecise")], [entry(4.0)])) == ["imprecise"]
    assert classes_of_pairs(record([], [entry(4.0, None)])) == ["none"]


def test_quantiles_reach_into_what_never_came():
    values = [4.0, 1.0, math.inf, 3.0]
    assert (quantile(values, 0.5), quantile(values, 0.75), quantile(values, 0.95)) == (3.0, 4.0, math.inf)
    assert quantile([], 0.5) == math.inf


def test_share_that_is_known_at_a_time():
    made = record([], [], series=TeamSeries(time=(0.0, 10.0), coverage=(0.2, 0.4)))
    assert known_at(made, 5.0) == pytest.approx(0.3)
    assert known_at(made, math.inf) == math.inf


def test_rows_of_robots_that_start_side_by_side():
    fast, slow = record([entry(3.0)], [entry(4.0)]), record([entry(3.0)], [])
    median, high = PARTS["paper"].rows({2: [fast, fast, slow]})
    assert (median["value"], median["holds"]) == (4.0, True)
    assert (high["value"], high["holds"]) == (None, False)
    assert "1 of 3 missions without" in high["detail"]


def test_failed_mission_counts_as_never_merged():
    failed = record([entry(3.0)], [entry(4.0)], status="failed")
    assert [row["holds"] for row in PARTS["paper"].rows({2: [failed]})] == [False, False]


def test_row_of_wrong_transforms():
    good, bad = record([entry(3.0)], [entry(4.0)]), record([entry(3.0)], [entry(4.0, "wrong")], seed=7)
    held = wrong_row([good] * 300)
    assert held["holds"] and held["value"] == 0.0 and "300 pairs" in held["detail"]
    assert "at most 0.99 % at 95 %" in held["detail"]
    missed = wrong_row([good, bad])
    assert not missed["holds"] and missed["value"] == 1.0 and "s7" in missed["detail"]


def test_whole_missions_of_equal_rooms():
    def whole(time, *merges):
        return record(merges, merges, "finished", time=time, overlap=0.5)

    (row,) = PARTS["equal_whole"].rows({1: [whole(300.0)], 4: [whole(150.0, entry(3.0))]})
    assert (row["value"], row["holds"]) == (0.5, True)
    assert not PARTS["equal_whole"].rows({1: [whole(300.0)], 4: [whole(150.0)]})[0]["holds"]


def test_cost_is_that_of_merging_and_registration():
    spent = {"merging": 0.5, "registration": 0.3, "slam": 9.0}
    made = record([], [], time=100.0, measured=Measured(cpu_by_component=spent))
    (row,) = PARTS["cost"].rows({3: [made]})
    assert (row["value"], row["holds"]) == (8.0, True)


def test_missions_end_early_where_robots_are_only_to_meet():
    request = Request(range(5, 7), 60.0)
    assert {trial.limit for trial in PARTS["paper"].trials(request)} == {60.0}
    assert {trial.limit for trial in PARTS["turtlebot"].trials(request)} == {120.0}
    assert {(trial.robots, trial.seed) for trial in PARTS["narrow"].trials(request)} == {(2, 5), (2, 6), (4, 5), (4, 6)}
    assert {trial.limit for trial in PARTS["equal_whole"].trials(request)} == {1800.0}


def test_command_goes_on_where_it_was_and_redoes_what_other_code_made(tmp_path, monkeypatch, capsys):
    part = bench_merging.Part(
        "paper", lambda request: [Trial("small8x8", 2, seed, limit=request.until) for seed in request.seeds],
        PARTS["paper"].rows,
    )  # fmt: skip
    monkeypatch.setitem(bench_merging_command.PARTS, "paper", part)
    call = ["--only", "paper", "--seeds", "2", "--until", "2", "--jobs", "1", "--out", str(tmp_path / "merging.json")]
    assert bench_merging_command.main(call) in (0, 1)
    assert "2 of 2 missions to run" in capsys.readouterr().out
    path = record_path(tmp_path / "merging" / "paper-2", Trial("small8x8", 2, 1001, limit=2.0))
    assert json.loads(path.read_text())["versions"]["code"] == code_version()
    path.write_text(path.read_text().replace(code_version(), "0123456789ab"))
    bench_merging_command.main(call)
    assert "1 of 2 missions to run" in capsys.readouterr().out
    rows = json.loads((tmp_path / "merging.json").read_text())
    assert all(set(row) == {"what", "bar", "value", "unit", "holds", "detail"} for row in rows)


@pytest.mark.parametrize("bad", [["--seeds", "0"], ["--until", "nan"], ["--jobs", "0"], ["--only", "nothing"]])
def test_bad_calls(bad, capsys):
    assert bench_merging_command.main(bad) == 2
    assert capsys.readouterr().err.startswith("bench merging: ")


def test_records_hold_the_class_of_each_transform():
    made = run_trial(Trial("small8x8", 2, 1, limit=60.0))
    merges = [merge for robot in made.robots.values() for merge in robot.merges if merge.accepted]
    assert merges and {merge.kind for merge in merges} <= {"right", "imprecise", "wrong"}
