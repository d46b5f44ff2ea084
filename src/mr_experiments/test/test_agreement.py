"""The comparison of the ROS stack with virtual time, on made-up missions."""

import json

import pytest
from made_missions import made_mission, made_robot

from mr_experiments.report.agreement import MINIMUM_MISSIONS, Verdict, agreements, rows_of, stack_runs, virtual_runs
from mr_experiments.report.agreement_command import main
from mr_experiments.report.record_set import load_records
from mr_experiments.report.stack_missions import ATTEMPTS, NO_RECORD, begin_attempt, read_attempts
from mr_measures.record import files
from mr_measures.record.robot_record import MapFigures

TIMES = [100.0 + (7 * seed) % MINIMUM_MISSIONS for seed in range(MINIMUM_MISSIONS)]  # 100 s to 111 s


def record_of(time, errors, seed, world, code, scenario):
    robots = [made_robot(map=MapFigures(error=error)) for error in errors]
    status, settings = "finished" if time else "unfinished", {"world": world, "seed": seed, "scenario": scenario}
    return made_mission(robots, status, time or 900.0, settings=settings, versions={"code": code})


def write_mission(folder, time, errors, seed=0, world="/worlds/w.world"):
    folder.mkdir(parents=True, exist_ok=True)
    files.write_record(record_of(time, errors, seed, world, "c", "ros_stack"), folder / "record.json")


def write_record(folder, seed, time, errors, world="w", code="c"):
    folder.mkdir(exist_ok=True)
    files.write_record(record_of(time, errors, seed, world, code, "launch"), folder / f"{len(errors)}-{seed}.json")


@pytest.fixture
def folders(tmp_path):
    """Missions of one robot that take 2 % longer in virtual time."""
    missions, records = tmp_path / "missions", tmp_path / "records"
    for seed, time in enumerate(TIMES):
        write_mission(begin_attempt(missions, "w", 1, seed, "c", "abc"), time, [0.1 * seed], seed)
        write_record(records, seed, 1.02 * time, [0.1])
    return missions, records


def compared(missions, records):
    (entry,) = agreements(stack_runs(missions), virtual_runs(records))
    return entry


def scaled(folder, factors):
    """Records whose times are those of the stack's missions times factors that take turns."""
    for seed, time in enumerate(TIMES):
        write_record(folder, seed, time * factors[seed % len(factors)], [0.1])
    return folder


def test_near_is_equivalent(folders):
    entry = compared(*folders)
    assert entry.mean.value == pytest.approx(1.02) and entry.median.value == pytest.approx(1.02)
    assert 0.95 < entry.mean.interval.low < 1.02 < entry.mean.interval.high < 1.08
    assert entry.verdict is Verdict.EQUIVALENT and entry.error_within and entry.holds


@pytest.mark.parametrize("factors, verdict", [
    ((1.3,), Verdict.DIFFERENT), ((0.7,), Verdict.DIFFERENT),
    ((1.14,), Verdict.UNDECIDED),  # within the bar, but its interval is not
    ((1.16,), Verdict.UNDECIDED),  # outside, but its interval is not
    ((0.6, 1.7), Verdict.UNDECIDED),  # scatters too much
])  # fmt: skip
def test_verdict_is_the_interval_s(folders, tmp_path, factors, verdict):
    entry = compared(folders[0], scaled(tmp_path / "other", factors))
    assert entry.verdict is verdict and not entry.holds


@pytest.mark.parametrize("side", ["stack", "virtual"])
def test_too_few_missions_give_no_verdict(folders, side):
    missions, records = folders
    if side == "stack":
        write_mission(missions / "w-1-0", None, [0.1])  # not finished: it has no time
    else:
        (records / "1-0.json").unlink()
    entry = compared(missions, records)
    assert entry.verdict is Verdict.TOO_FEW and not entry.holds
    assert "too few missions, 12 on either side are needed" in rows_of(entry)[0]["detail"]


def test_attempts_without_record_are_counted_and_named(folders):
    missions, records = folders
    (missions / "stopped" / "logs").mkdir(parents=True)  # by rosrun mr_launch team, beside what was noted
    (missions / "stopped" / "robot_0").mkdir()
    begin_attempt(missions, "w", 1, 77, "c", "abc")  # and nothing is left of it
    entry = compared(missions, records)
    assert entry.verdict is Verdict.EQUIVALENT and not entry.holds
    lost = rows_of(entry)[1]
    assert lost["value"] == 2 and not lost["holds"] and lost["detail"].startswith("of 14 of the ROS stack")
    assert "stopped (no record)" in lost["detail"] and "w-1-77 (no record)" in lost["detail"]


def test_attempt_of_unknown_team_size_counts_for_all(folders):
    missions, _ = folders
    (missions / "sudden" / "logs").mkdir(parents=True)
    write_mission(missions / "two", 50.0, [0.0, 1.0])
    assert [[one.name for one in runs.not_finished] for runs in stack_runs(missions).values()] == [["sudden"]] * 2


def test_a_report_counts_attempts_without_record(folders, tmp_path):
    missions, _ = folders
    begin_attempt(missions, "w", 1, 77, "c", "abc")
    begin_attempt(missions, "w", 1, 3, "c", "abc")  # a seed that has a record, too
    (missions / "sudden" / "logs").mkdir(parents=True)
    found = load_records(missions)
    assert found.counts == {"finished": MINIMUM_MISSIONS, "unfinished": 0, "failed": 2}
    assert [record.asked.seed for record in found.records if record.failed] == [3, 77]
    assert found.lost == (str(missions / "sudden"),)


def test_unfinished_missions_are_named(folders):
    missions, records = folders
    write_mission(missions / "slow", None, [0.1])
    write_record(records, 99, None, [0.1])
    detail = rows_of(compared(missions, records))[1]["detail"]
    assert "slow (unfinished)" in detail and "1-99 (unfinished)" in detail


def test_second_attempt_with_a_seed_is_one_more(tmp_path):
    folders = [begin_attempt(tmp_path, "generated:cave:3", 2, 5, "c", "abc") for _ in range(2)]
    assert [folder.name for folder in folders] == ["generated-cave-3-26x18-2-5", "generated-cave-3-26x18-2-5.2"]
    assert len((tmp_path / ATTEMPTS).read_text().splitlines()) == 2
    write_mission(folders[1], 50.0, [0.0, 1.0], 5)
    lost, finished = read_attempts(tmp_path)
    assert (lost.status, lost.robots, lost.seed, lost.code, lost.commit) == (NO_RECORD, 2, 5, "c", "abc")
    assert (finished.time, finished.errors, finished.seed, finished.code) == (50.0, (0.0, 1.0), 5, "c")


def test_command_writes_rows_and_figure_and_tells(folders, tmp_path, capsys):
    out = tmp_path / "out"
    assert main([*map(str, folders), "--out", str(out)]) == 0
    (comparison,) = json.loads((out / "agreement.json").read_text())["comparisons"]
    assert [row["holds"] for row in comparison["rows"]] == [True, True, True]
    assert comparison["codes"] == {"stack": ["c"], "virtual": ["c"]} and comparison["commits"] == ["abc"]
    (team,) = comparison["teams"]
    assert team["verdict"] == "equivalent within +-15 %" and team["mean_ratio"][0] == 1.02
    assert [(one["seed"], one["time"]) for one in team["stack"]][:2] == [(0, 100.0), (1, 107.0)]
    assert (out / "agreement.png").stat().st_size > 1000
    assert "equivalent within +-15 %; mean 1.020 (" in capsys.readouterr().out


def test_history_is_kept(folders, tmp_path):
    missions, records = folders
    out = tmp_path / "out"
    out.mkdir()
    former = {"rows": [{"what": "of another time"}]}
    (out / "agreement.json").write_text(json.dumps({"comparisons": [former]}))
    for _ in range(2):  # the same again is no second comparison
        assert main([str(missions), str(records), "--out", str(out)]) == 0
    other = scaled(tmp_path / "other", (1.3,))
    assert main([str(missions), str(other), "--out", str(out)]) == 1
    comparisons = json.loads((out / "agreement.json").read_text())["comparisons"]
    assert comparisons[0] == former and len(comparisons) == 3
    assert [entry["teams"][0]["verdict"] for entry in comparisons[1:]] == ["equivalent within +-15 %", "different"]


def test_a_file_that_is_no_history_is_not_overwritten(folders, tmp_path, capsys):
    (tmp_path / "agreement.json").write_text("[1, 2]")
    assert main([*map(str, folders), "--out", str(tmp_path)]) == 2
    assert "agreement.json holds no comparisons" in capsys.readouterr().err
    assert (tmp_path / "agreement.json").read_text() == "[1, 2]"


def test_other_code_is_noted_and_another_world_refused(folders, tmp_path, capsys):
    missions, records = folders
    write_record(records, 3, TIMES[3], [0.1], code="d")
    main([str(missions), str(records), "--out", str(tmp_path / "out")])
    assert "Note: not shown to be of one code: ROS stack c, virtual time c, d" in capsys.readouterr().out
    for seed in range(3):
        write_record(tmp_path / "elsewhere", seed, 100.0, [0.1], world="other")
    assert main([str(missions), str(tmp_path / "elsewhere"), "--out", str(tmp_path / "out")]) == 2
    assert "missions of different worlds are not compared: other, w" in capsys.readouterr().err


@pytest.mark.parametrize("broken, text", [("missions", "no record.json"), ("records", "no records")])
def test_empty_folders_are_named(folders, tmp_path, capsys, broken, text):
    empty = tmp_path / "empty"
    empty.mkdir()
    missions, records = folders
    folders = {"missions": missions, "records": records, broken: empty}
    assert main([str(folders["missions"]), str(folders["records"])]) == 2
    assert text in capsys.readouterr().err
