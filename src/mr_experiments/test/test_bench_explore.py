"""The benchmark of exploration: which worlds, what is kept of missions, what the table says."""

import json
from dataclasses import replace

import pytest
from made_missions import made_mission, made_robot

from mr_experiments.bench import bench_explore_command as command
from mr_experiments.bench.bench_explore import table, text_table
from mr_experiments.bench.explore_missions import (
    LONGEST_M,
    SHORTEST_M,
    MissionRow,
    append,
    as_json,
    fast_trials_of,
    key_of,
    read_rows,
    row_of,
    trials_of,
    world_name,
)
from mr_experiments.sweep.sweep import Done
from mr_measures.record.files import write_record
from mr_measures.record.series import TeamSeries
from mr_plans import parse_name


def mission(world="a", robots=1, strategy=7, time=100.0, **other):
    values = {
        "seed": 1, "limit": 3600.0, "code": "c", "status": "finished", "reason": "", "known_at": 90.0,
        "first_end": 98.0, "coverage": (1.0,) * robots, "wrong_walls": (0.0,) * robots, "distance": 10.0,
        "contacts": 0, "not_home": 0,
    }  # fmt: skip
    return MissionRow(world=world, robots=robots, strategy=strategy, time=time, **{**values, **other})


def entry(rows, what, bounds=None):
    found = [row for row in table(rows, bounds or {}) if row["what"].startswith(what)]
    assert len(found) == 1, [row["what"] for row in table(rows, bounds or {})]
    return found[0]


def test_worlds_are_of_all_kinds_and_sizes_and_those_of_their_seed():
    names = [parse_name(world_name(seed)) for seed in range(5001, 5031)]
    assert {name.kind for name in names} == {"office", "equalrooms", "hall", "cave", "loop"}
    lengths = [name.size[0] for name in names]
    assert SHORTEST_M <= min(lengths) < 22 and 43 < max(lengths) <= LONGEST_M
    assert all(name.size[1] < name.size[0] or name.size[1] == 17.0 for name in names)
    assert world_name(5001) == world_name(5001) != world_name(5006)


def test_ratios_are_means_over_worlds_of_missions_with_the_same_strategy():
    rows = [mission("a"), mission("a", 2, time=50.0), mission("b"), mission("b", 2, time=80.0)]
    found = entry([*rows, mission("b", 2, 0, time=1.0), mission("c", 2)], "mean T(2)")
    assert found["value"] == pytest.approx(0.65) and found["holds"] and "2 of 2" in found["detail"]


def test_an_unfinished_mission_misses_the_bar_and_is_named():
    rows = [mission("a"), mission("a", 4, time=40.0), mission("b"), mission("b", 4, time=None, status="unfinished")]
    found = entry(rows, "mean T(4)")
    assert found["value"] == pytest.approx(0.4) and not found["holds"] and "1 of 2" in found["detail"]
    assert "b R4" in entry(rows, "missions")["detail"] and not entry(rows, "missions")["holds"]


def test_the_worst_world_counts():
    rows = [row for world, time in (("a", 30.0), ("b", 90.0)) for row in (mission(world), mission(world, 4, time=time))]
    assert entry(rows, "worst T(4)")["value"] == pytest.approx(0.9) and not entry(rows, "worst T(4)")["holds"]


def test_bound_strategies_coverage_and_ends():
    rows = [
        mission(), mission(strategy=0, time=200.0), mission(robots=4, coverage=(1.0, 1.0, 0.9, 1.0), first_end=70.0),
    ]  # fmt: skip
    assert entry(rows, "mean T / bound, R = 1", {("a", 1): 50.0, ("a", 4): 20.0})["value"] == pytest.approx(2.0)
    assert entry(rows, "strategy 7 over strategy 0, R = 1")["value"] == pytest.approx(0.5)
    assert entry(rows, "coverage, worst")["value"] == pytest.approx(0.9)
    assert entry(rows, "after 99")["value"] == pytest.approx(10.0)
    assert entry(rows, "last robot")["value"] == pytest.approx(30.0)
    assert text_table(rows, {("a", 1): 50.0}) == ["a: 7/R1 100 (50), 0/R1 200 (50), 7/R4 100"]


def test_fast_missions_are_compared_with_full_ones_and_count_nowhere_else():
    rows = [
        mission(), mission(time=80.0, fast=True), mission("office26x15"), mission("office26x15", time=120.0, fast=True),
        mission("b", time=50.0, fast=True), mission("b", time=None, status="unfinished"),
    ]  # fmt: skip
    found = entry(rows, "mean T, fast mode over full, R = 1")
    assert found["value"] == pytest.approx(1.0) and not found["holds"], "b is not finished in full mode"
    assert entry(rows[:4], "mean T, fast mode over full, R = 1")["holds"]
    assert "of 2 " in entry(rows, "missions")["detail"] and "2 maps" in entry(rows, "coverage, mean")["detail"]
    assert text_table(rows[:2], {}) == ["a: 7/R1 100, 7/R1 fast 80"]


def test_fast_trials_are_of_the_same_worlds_and_seeds():
    fast = {key_of(trial)[:-1] for trial in fast_trials_of([5001, 5002], [1], 7, 60.0) if trial.fast}
    full = [*trials_of([5001, 5002], [1], [7], 60.0), *fast_trials_of([5001, 5002], [1], 7, 60.0)]
    assert len({trial.key for trial in fast_trials_of([5001], [1], 7, 60.0)}) == 3, "a record of its own for each"
    assert len(fast) == 4 and fast <= {key_of(trial)[:-1] for trial in full if not trial.fast}


def test_a_row_tells_when_99_percent_was_known():
    def known_at(times, shares):
        return row_of(made_mission([made_robot()], series=TeamSeries(time=times, coverage=shares))).known_at

    assert known_at((0.0, 10.0, 20.0), (0.0, 0.98, 1.0)) == pytest.approx(15.0)
    assert known_at((0.0, 10.0), (0.0, 0.98)) is None


def test_contacts_and_robots_that_are_not_home_have_rows_and_name_their_missions():
    rows = [mission(), mission("b", 2, contacts=3), mission("c", not_home=1)]
    assert entry([mission()], "contacts")["holds"]
    touched, away = entry(rows, "contacts"), entry(rows, "robots that did not get home")
    assert (touched["value"], touched["holds"], touched["detail"]) == (3, False, "3 missions b R2 strategy 7")
    assert (away["value"], away["detail"]) == (1, "3 missions c R1 strategy 7")


def test_rows_survive_a_line_that_was_cut_off(tmp_path):
    path = tmp_path / "rows.jsonl"
    append(path, as_json(mission(robots=2)))
    path.write_text(path.read_text() + '{"world": "b", "ro\n')
    append(path, as_json(mission("c")))
    assert read_rows(path) == [mission(robots=2), mission("c")] and read_rows(tmp_path / "none") == []


def test_a_run_goes_on_and_repeats_missions_of_other_code(tmp_path, monkeypatch, capsys):
    """No mission is run: the pool is one that writes what a mission would."""
    ran = []

    class Pool:
        def __init__(self, jobs):
            pass

        def run(self, trials, folder, tell):
            for trial in trials:
                ran.append(trial.robots)
                robots = [made_robot(finished_at=9.0)] * trial.robots
                code = {"code": command.code_version()}
                record = made_mission(robots, time=9.0, settings=trial.to_json(), versions=code)
                write_record(record, folder / f"{trial.key}.json")
                yield Done(trial, "finished", "", 9.0, (), 1.0, "")

    monkeypatch.setattr(command, "LocalPool", Pool)
    out = tmp_path / "explore.json"
    arguments = ["--out", str(out), "--worlds", "1", "--strategies", "7", "--no-bounds", "--fast-worlds", "0"]
    command.main([*arguments, "--robots", "1", "2"])
    assert ran == [1, 2] and "left" in capsys.readouterr().out
    command.main([*arguments, "--robots", "1", "2", "4"])
    assert ran == [1, 2, 4], "what is recorded is not run again"
    rows = read_rows(out.with_suffix(".jsonl"))
    out.with_suffix(".jsonl").write_text("")
    append(out.with_suffix(".jsonl"), as_json(replace(rows[0], code="of another day")))
    command.main([*arguments, "--robots", "1", "--only-table"])
    assert ran == [1, 2, 4]
    command.main([*arguments, "--robots", "1"])
    assert ran == [1, 2, 4, 1]
    assert [row["what"] for row in json.loads(out.read_text())][-1] == "missions that finished"
    capsys.readouterr()
    command.main([*arguments, "--robots", "1", "--first-seed", "5005"])
    assert "generated:office:5005" in capsys.readouterr().out, "no picture of an office in its place"


def test_keys_of_trials_and_rows_agree():
    trial = trials_of([5001], [2], [7], 60.0)[0]
    row = mission(trial.world, 2, 7, seed=5001, limit=60.0)
    assert key_of(trial) == row.key


def test_bad_calls(capsys):
    assert command.main(["--worlds", "0"]) == 2 and "--worlds" in capsys.readouterr().err
