"""Two record sets whose differences are known."""

import csv
from dataclasses import replace

import pytest
from sample_records import failed_record, make_record, write_random_set, write_record

from mr_experiments.common.statistics import Verdict
from mr_experiments.report.comparison import compare_sets, comparison_table
from mr_experiments.report.record_set import load_records
from mr_experiments.report.report import make_report
from mr_measures.record.files import RecordError


def write_set(folder, trials, *, faster=0.0, more_bytes=0, **trial):
    for seed in range(1, trials + 1):
        # The scatter between the seeds is larger than any difference, so only pairs can show it.
        times = [100.0 + 40.0 * seed - faster - (seed % 2), 90.0]
        record = make_record(2, seed, times=times, with_maps=False, **{"limit": 999.0, **trial})
        record["robots"]["robot_0"]["radio"]["bytes_sent"] += more_bytes
        write_record(folder, record)
    return load_records(folder)


def rows_of(comparison):
    return {row.metric.name: row for row in comparison.rows}


def test_differences_and_verdicts(tmp_path):
    now = write_set(tmp_path / "now", 8, faster=5.0, more_bytes=1000)
    before = write_set(tmp_path / "before", 8)
    comparison = compare_sets(now, before)
    rows = rows_of(comparison)
    assert (comparison.pairs, comparison.only_candidate, comparison.only_baseline) == (8, 0, 0)
    assert rows["exploration_time_s"].difference.mean == pytest.approx(-5.0)
    assert rows["exploration_time_s"].difference.verdict is Verdict.BETTER
    assert rows["kilobytes"].difference.mean == pytest.approx(1.0)
    assert rows["kilobytes"].difference.verdict is Verdict.WORSE
    for name in ("distance_m", "abs_map_error_percent", "coverage", "moving", "overlap", "finished"):
        assert rows[name].difference.verdict is Verdict.NOT_SHOWN, name


def test_turned_round_the_verdicts_are_too(tmp_path):
    fast, slow = write_set(tmp_path / "a", 8, faster=5.0), write_set(tmp_path / "b", 8)
    assert rows_of(compare_sets(slow, fast))["exploration_time_s"].difference.verdict is Verdict.WORSE


def test_a_row_of_too_few_pairs_says_so(tmp_path):
    fast, slow = write_set(tmp_path / "a", 3, faster=5.0), write_set(tmp_path / "b", 3)
    table = comparison_table(compare_sets(fast, slow))
    assert {row[-1] for row in table.rows} == {"too few pairs (3 of 6)"}
    assert "it has at least 6 pairs of its own" in table.explanation


def test_trials_without_partner_or_result_are_counted(tmp_path):
    write_set(tmp_path / "a", 8)
    write_record(tmp_path / "a", make_record(2, 9, times=[90.0, None], status="unfinished", reason="limit"))
    write_record(tmp_path / "a", failed_record(2, 10, "IndexError"))
    write_record(tmp_path / "a", make_record(1, 1))
    write_set(tmp_path / "b", 12)
    comparison = compare_sets(load_records(tmp_path / "a"), load_records(tmp_path / "b"))
    rows = rows_of(comparison)
    assert (comparison.pairs, comparison.only_candidate, comparison.only_baseline) == (10, 1, 2)
    assert rows["finished"].difference.pairs == 10
    assert rows["finished"].candidate == pytest.approx(0.8)
    assert rows["exploration_time_s"].difference.pairs == 8
    assert rows["distance_m"].difference.pairs == 9  # the unfinished one has a distance, the failed one has not


def test_other_strategies_are_paired_only_on_request(tmp_path):
    first, second = write_set(tmp_path / "a", 6, strategy=7), write_set(tmp_path / "b", 6, strategy=3)
    with pytest.raises(RecordError, match=r"no trial of .*a has a partner in .*b"):
        compare_sets(first, second)
    comparison = compare_sets(first, second, across=["strategy"])
    assert comparison.pairs == 6
    assert comparison_table(comparison).columns[2].name == "robots"
    write_set(tmp_path / "a", 6, strategy=1)
    with pytest.raises(RecordError, match="would both be paired"):
        compare_sets(load_records(tmp_path / "a"), second, across=["strategy"])


def test_files_of_a_comparison(tmp_path):
    write_random_set(tmp_path / "a", generator_seed=1, with_maps=False)
    write_random_set(tmp_path / "b", generator_seed=2, slower=1.5, with_maps=False)
    report = make_report(tmp_path / "a", tmp_path / "out", against=tmp_path / "b", with_bound=False)
    assert report.page.read_text().count(">better<") >= 4
    with (tmp_path / "out" / "tables" / "comparison.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert report.comparison is not None and len(rows) == len(report.comparison.rows)
    times = [row for row in rows if "exploration time" in row["metric"]]
    assert [row["verdict"] for row in times] == ["better"] * 4
    assert all(float(row["difference_high"]) < 0.0 for row in times)


def test_pairs_with_unequal_settings_are_named(tmp_path):
    first, second = write_set(tmp_path / "a", 6, limit=900.0), write_set(tmp_path / "b", 6, limit=1800.0)
    assert compare_sets(first, second).notes[1:] == (
        "Comparison: setting limit differs between the two trials of 6 of 6 pairs",
    )
    assert len(compare_sets(first, first).notes) == 1


def test_it_is_told_which_code_made_either_set(tmp_path):
    """A tutorial has its reader look whether the change was there."""
    first, second = write_set(tmp_path / "a", 6), write_set(tmp_path / "b", 6)
    changed = tuple(replace(record, versions={"code": "c2"}) for record in second.records)
    assert compare_sets(first, first).notes == ("Comparison: both sets were made by the code unknown",)
    assert compare_sets(first, replace(second, records=changed)).notes == (
        "Comparison: this set was made by the code unknown, the other one by c2",
    )
