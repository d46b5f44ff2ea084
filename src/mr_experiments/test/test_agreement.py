"""The comparison of the ROS stack with virtual time, on made-up missions."""

import json

import pytest

from mr_experiments.agreement import agreements, stack_runs, virtual_runs
from mr_experiments.agreement_command import main


def write_mission(folder, time, errors):
    folder.mkdir(parents=True)
    robots = {f"robot_{i}": {"map_error": error} for i, error in enumerate(errors)}
    (folder / "summary.json").write_text(json.dumps({"team": {"exploration_time": time}, "robots": robots}))


def write_record(folder, seed, time, errors):
    folder.mkdir(exist_ok=True)
    record = {
        "format": 1,
        "trial": {"world": "w", "robots": len(errors), "seed": seed, "scenario": "s", "strategy": 7},
        "outcome": {"status": "finished" if time else "unfinished", "reason": "", "time": time or 900.0},
        "team": {"exploration_time": time},
        "robots": {f"robot_{i}": {"map": {"error": error}} for i, error in enumerate(errors)},
    }
    (folder / f"{len(errors)}-{seed}.json").write_text(json.dumps(record))


@pytest.fixture
def folders(tmp_path):
    missions, records = tmp_path / "missions", tmp_path / "records"
    for seed, time in enumerate((100.0, 110.0, 120.0)):
        write_mission(missions / f"one-{seed}", time, [0.1 * seed])
        write_record(records, seed, time + 11.0, [0.1])
    write_mission(missions / "two", None, [0.0, 1.0])
    write_record(records, 9, None, [0.5, 0.5])
    return missions, records


def test_ratio_of_medians_and_scatter(folders):
    missions, records = folders
    one, two = agreements(stack_runs(missions), virtual_runs(records))
    assert one.ratio == pytest.approx(1.1) and one.error_within and one.holds
    assert two.stack.unfinished == 1 and two.virtual.unfinished == 1
    assert two.ratio is None and not two.holds


def test_command_writes_rows_and_figure_and_tells(folders, tmp_path, capsys):
    missions, records = folders
    assert main([str(missions), str(records), "--out", str(tmp_path / "out")]) == 1
    rows = json.loads((tmp_path / "out" / "agreement.json").read_text())
    assert [row["holds"] for row in rows] == [True, True, False, True]
    assert (tmp_path / "out" / "agreement.png").stat().st_size > 1000
    assert "1.1" in capsys.readouterr().out


def test_too_slow_virtual_time_does_not_hold(folders, tmp_path):
    missions, _ = folders
    for seed in range(3):
        write_record(tmp_path / "slow", seed, 130.0, [0.1])
    (entry,) = agreements(stack_runs(missions), virtual_runs(tmp_path / "slow"))
    assert entry.ratio == pytest.approx(130.0 / 110.0) and not entry.holds


@pytest.mark.parametrize("broken, text", [("missions", "no summary.json"), ("records", "no records")])
def test_empty_folders_are_named(folders, tmp_path, capsys, broken, text):
    empty = tmp_path / "empty"
    empty.mkdir()
    missions, records = folders
    folders = {"missions": missions, "records": records, broken: empty}
    assert main([str(folders["missions"]), str(folders["records"])]) == 2
    assert text in capsys.readouterr().err
