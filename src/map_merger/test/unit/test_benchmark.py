"""The registration benchmark: its measures against plain cases, its generators, its reader of logs."""

import functools
import gzip
import math
import os
import signal

import numpy as np
import pytest

from map_merger import benchmark
from map_merger.benchmark import figures, real_logs, records, report, sweep
from map_merger.benchmark.families import self_alias
from map_merger.benchmark.outcome import thinned
from map_merger.grid import free_cells, known_box
from map_merger.surface import landmarks_of
from map_merger.synthetic import KINDS, Survey, Surveyor, cast, generated, office_plan, pair_of, rearranged
from mr_grid import GridInfo, OccupancyGrid, Pose


def test_classes_of_outcomes():
    assert benchmark.classify(np.array([0.05, 0.2]), 0.0) == "imprecise"
    assert benchmark.classify(np.array([0.05, 0.1]), 0.0) == "right"
    assert benchmark.classify(np.array([0.0, 0.26]), 0.0) == "wrong"
    assert benchmark.classify(np.array([0.0]), math.radians(2.1)) == "wrong"


def test_intervals():
    assert benchmark.interval(0, 3000)[1] == pytest.approx(0.001, rel=0.01), "three over the number of trials"
    assert benchmark.interval(5, 10) == pytest.approx((0.187, 0.813), abs=1e-3)
    assert benchmark.interval(10, 10)[1] == 1.0
    assert benchmark.interval(0, 0) == (0.0, 1.0)


def test_thinned_lines_are_as_long_as_the_wall():
    mask = np.zeros((20, 120), bool)
    mask[8:11, 10:110] = True
    line = thinned(mask)
    assert line.sum(axis=0).max() == 1 and abs(int(line.sum()) - 100) <= 3
    assert not (line & ~mask).any()


def test_shared_wall_counts_a_wall_once_however_thick():
    cells = np.zeros((40, 240), np.int8)
    cells[20:23, 20:220] = 100
    grid = OccupancyGrid(GridInfo(240, 40, 0.05), cells)
    assert benchmark.shared_wall(grid, grid, Pose()) == pytest.approx(10.0, abs=0.2)
    assert benchmark.shared_wall(grid, grid, Pose(5.0, 0.0, 0.0)) == pytest.approx(5.0, abs=0.2)
    assert benchmark.shared_wall(grid, grid, Pose(0.0, 0.5, 0.0)) == 0.0


def test_a_copy_of_the_room_makes_a_self_alias():
    random = np.random.default_rng(3)
    for same, start in ((True, (14.3, 2.4)), (False, (2.4, 2.4))):
        surveyor = Surveyor(office_plan(random, same=same))
        first = surveyor.explore(random, Survey(path_length=3.0), start=(2.0, 2.4))
        second = surveyor.explore(random, Survey(path_length=3.0), start=start)
        truth = pair_of(first, second).truth
        assert self_alias(landmarks_of(first.grid), landmarks_of(second.grid), truth) == same


def test_a_seed_repeats_a_pair():
    first, second = benchmark.draw_case(5), benchmark.draw_case(5)
    assert np.array_equal(first.source[-1].cells, second.source[-1].cells)
    assert (first.truth, first.shared, first.alias) == (second.truth, second.shared, second.alias)


def test_a_rough_prior_is_rough_and_near():
    case = benchmark.draw_case(0)
    prior = benchmark.rough_prior(case).transform
    turn = abs(math.degrees(prior.yaw - case.truth.yaw)) % 360.0
    assert 0.0 < min(turn, 360.0 - turn) <= 20.0


def test_rows_say_what_missed():
    wrong = benchmark.Outcome("wrong", "accepted")
    trials = [benchmark.Trial(7, "offices", 30.0, False, 0.0, {"rule": wrong})]
    row = figures.wrong_row("wrong", trials, "rule", "command")
    assert not row["holds"] and row["value"] == 1 and "[7]" in row["detail"]
    assert not figures.wrong_row("wrong", [], "rule", "command")["holds"], "no trials prove nothing"
    assert not figures.share_row("right", [], "rule", 0.0, "command")["holds"]


def test_every_rule_answers_a_pair():
    trial = report.trial_of_seed(1)
    assert set(trial.outcomes) == set(benchmark.RULES)
    assert trial.outcomes["two maps, rough prior"].kind == "right"
    assert len(figures.table([trial], list(benchmark.RULES))) == 1 + 4 * len(benchmark.RULES)


def trial(seed, kind="right", error=0.02):
    outcomes = {"two maps": benchmark.Outcome(kind, "accepted", error, error, 0.0, 0.1)}
    return benchmark.Trial(seed, "offices", 30.0, False, 0.02, outcomes)


def test_trials_are_kept_as_they_come_and_a_torn_line_is_made_again(tmp_path):
    """After 248 of 3000 pairs a run died, and with it all that it had measured."""
    path = tmp_path / "out" / "merge.trials.jsonl"
    first = records.TrialFile(path, ["two maps"])
    first.add(trial(3))
    first.add(trial(4, "declined", math.inf))
    with open(path, "a") as file:
        file.write('{"seed": 5, "fam')
    again = records.TrialFile(path, ["two maps"])
    assert again.trials == {3: trial(3), 4: trial(4, "declined", math.inf)}
    again.add(trial(5))
    assert set(records.TrialFile(path, ["two maps"]).trials) == {3, 4, 5}


def test_trials_of_other_code_or_other_rules_do_not_count(tmp_path, monkeypatch):
    path = tmp_path / "merge.trials.jsonl"
    records.TrialFile(path, ["two maps"]).add(trial(3))
    assert not records.TrialFile(path, ["two maps", "ORB"]).trials
    records.TrialFile(path, ["two maps"]).add(trial(3))
    monkeypatch.setattr(records, "code_digest", lambda: "other")
    assert not records.TrialFile(path, ["two maps"]).trials


def test_every_change_of_the_code_gives_it_another_name(tmp_path, monkeypatch):
    monkeypatch.setattr(records, "_PACKAGE", tmp_path)
    (tmp_path / "search.py").write_text("STEP = 1\n")
    before = records.code_digest()
    assert records.code_digest() == before
    (tmp_path / "search.py").write_text("STEP = 2\n")
    assert records.code_digest() != before


def dies_once(seed, mark):
    """Kills its process the first time that it is asked for seed 2."""
    if seed == 2 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return trial(seed)


def test_a_killed_process_costs_no_trial(tmp_path):
    """A pool waited for ever for the pair of a process that had been killed."""
    seeds = list(range(6))
    found = list(sweep.trials_of(seeds, 2, functools.partial(dies_once, mark=tmp_path / "dead")))
    assert (tmp_path / "dead").exists()
    assert sorted(each.seed for each in found) == seeds


def always_dies(seed):
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_seed_that_kills_every_process_is_told():
    with pytest.raises(RuntimeError, match=r"killed 3 times over the seeds \[7\]"):
        list(sweep.trials_of([7], 1, always_dies))


@pytest.mark.parametrize("kind", KINDS)
def test_buildings_are_closed_and_repeat(kind):
    plan, again = generated(kind, 4, 30.0), generated(kind, 4, 30.0)
    assert np.array_equal(plan.walls, again.walls)
    if kind != "bare_rooms":
        assert not np.array_equal(plan.walls, generated(kind, 5, 30.0).walls)
    assert plan.walls[[0, -1]].all() and plan.walls[:, [0, -1]].all()
    assert 20.0 <= plan.walls.shape[1] * plan.resolution <= 36.0


@pytest.mark.parametrize("kind, length", [("castle", 26.0), ("offices", 5.0), ("offices", 500.0)])
def test_buildings_that_there_are_not(kind, length):
    with pytest.raises(ValueError, match=r"castle|metres|m long"):
        generated(kind, 1, length)


def test_moved_furniture_keeps_walls_and_amount():
    plan = generated("offices", 2, 26.0)
    moved = rearranged(plan, np.random.default_rng(1), 1.0)
    assert np.array_equal(plan.walls & ~plan.furniture, moved.walls & ~moved.furniture)
    assert moved.furniture.sum() == plan.furniture.sum()
    assert not np.array_equal(plan.furniture, moved.furniture)


def log_line(walls, pose):
    survey = Survey(beams=181, view=math.pi, reach=12.0)
    ranges = cast(walls, 0.05, pose, survey)
    return f"FLASER 181 {' '.join(f'{value:.3f}' for value in ranges)} {' '.join(map(str, pose))} 0 0 0 1.0 host 1.0\n"


def test_logs_are_read_plain_or_packed_and_cut_into_pairs(tmp_path):
    walls = generated("loops", 1, 26.0).walls
    along = np.arange(2.0, 24.0, 0.4)
    poses = [(x, 5.8, 0.0) for x in along] + [(x, 5.8, math.pi) for x in along[::-1]]
    text = "# a comment\nODOM 1 2 3\n" + "".join(log_line(walls, pose) for pose in poses)
    (tmp_path / "plain.log").write_text(text)
    with gzip.open(tmp_path / "packed.log.gz", "wt") as file:
        file.write(text)
    packed, plain = real_logs.logs_of(tmp_path)
    assert (packed.name, plain.name) == ("packed", "plain") and np.array_equal(packed.ranges, plain.ranges)
    cases = list(real_logs.cases_of(plain, 1, 3))
    assert len(cases) == 3 and max(case.shared for case in cases) > 5.0


def test_failed_readings_are_not_free_space():
    """Readings of the laser's full scale were drawn as free up to 12 m, through walls of glass."""
    ranges = np.full((40, 181), 3.0)
    ranges[:, 100] = 80.0
    poses = np.column_stack([np.linspace(0.0, 20.0, 40), np.zeros(40), np.zeros(40)])
    log = real_logs.Log("log", poses, ranges)
    case = next(real_logs.cases_of(log, 1, 1))
    free = free_cells(case.target[-1])
    assert free.any() and known_box(case.target[-1]).shape[0] * 0.05 < 8.0


def test_folders_without_logs_are_named(tmp_path):
    with pytest.raises(ValueError, match=r"no .*log"):
        real_logs.logs_of(tmp_path)
    (tmp_path / "empty.log").write_text("nothing\n")
    with pytest.raises(ValueError, match=r"empty\.log"):
        real_logs.logs_of(tmp_path)
