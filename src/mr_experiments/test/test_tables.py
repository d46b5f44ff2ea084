"""Tables of a small set whose figures are worked out by hand."""

import csv
import io

import pytest
from sample_records import failed_record, make_record, write_record

from mr_experiments.report import paper
from mr_experiments.report.derived import all_merged_at, merges_at_end
from mr_experiments.report.paper_tables import distance_table, exploration_time_table, map_error_table
from mr_experiments.report.record_set import load_record, load_records
from mr_experiments.report.scope import scopes
from mr_experiments.report.table import SIGNIFICANT, Column, Table, shown, to_csv
from mr_experiments.report.tables import chapter_tables, outcome_table, trials_table, trouble_table
from mr_experiments.report.team_tables import computing_table, merging_table, radio_table, team_table


@pytest.fixture
def scope(tmp_path):
    """Two robots: three finished trials, one unfinished, one failed; one robot: one finished trial."""
    common = {"world": paper.WORLD, "scenario": paper.SCENARIO}
    write_record(tmp_path, make_record(1, 1, times=[200.0], distances=[80.0], errors=[0.5], **common))
    for seed, end in ((1, 100.0), (2, 120.0), (3, 140.0)):
        distances = [30.0, 30.0 + 10.0 * seed]
        write_record(
            tmp_path, make_record(2, seed, times=[90.0, end], distances=distances, errors=[-1.0, 2.0], **common)
        )
    stuck = make_record(
        2, 4, times=[90.0, None], distances=[30.0, 170.0], errors=[6.0, None], status="unfinished", reason="limit",
        **common,
    )  # fmt: skip
    stuck["robots"]["robot_1"]["collisions"] = {"walls": 8, "robots": 4}
    write_record(tmp_path, stuck)
    write_record(tmp_path, failed_record(2, 5, "explorer: KeyError", **common))
    (only,) = scopes(load_records(tmp_path))
    return only


def cells(table, robots):
    row = next(row for row in table.rows if row[0] == robots)
    return {column.name: cell for column, cell in zip(table.columns, row)}


def test_map_errors_of_all_maps(scope):
    row = cells(map_error_table(scope), 2)
    assert (row["maps"], row["maps_without_error"]) == (7, 1)  # the failed trial has no maps
    assert row["e_percent_mean"] == pytest.approx((3 * -1.0 + 3 * 2.0 + 6.0) / 7)
    assert row["abs_e_percent_mean"] == pytest.approx((3 * 1.0 + 3 * 2.0 + 6.0) / 7)
    assert row["e_percent_q05"] == pytest.approx(-1.0)
    assert row["e_percent_q95"] == pytest.approx(2.0 + 0.7 * 4.0)  # rank 0.95 * 6 = 5.7 of -1 -1 -1 2 2 2 6
    assert row["paper_e_percent_mean"] == 0.19
    assert row["e_percent_mean_low"] <= row["e_percent_mean"] <= row["e_percent_mean_high"]


def test_distance_of_the_team(scope):
    row = cells(distance_table(scope), 2)
    assert row["distance_m_mean"] == pytest.approx((70.0 + 80.0 + 90.0 + 200.0) / 4)
    assert row["paper_distance_m_mean"] == 121
    assert cells(distance_table(scope), 1)["distance_m_mean"] == 80.0


def test_exploration_time_is_that_of_finished_missions(scope):
    row = cells(exploration_time_table(scope), 2)
    assert (row["finished"], row["unfinished"], row["failed"]) == (3, 1, 1)
    assert row["exploration_time_s_mean"] == pytest.approx(120.0)
    assert row["exploration_time_s_q05"] == pytest.approx(102.0)
    assert row["exploration_time_s_q95"] == pytest.approx(138.0)
    assert [row[f"paper_exploration_time_s_{name}"] for name in ("q05", "mean", "q95")] == [649, 783, 942]


def test_the_paper_stands_beside_its_own_world_only(tmp_path):
    write_record(tmp_path, make_record(1, 1, world="small8x8"))
    write_record(tmp_path, make_record(1, 1, world=paper.WORLD, scenario="lossy"))
    for scope in scopes(load_records(tmp_path)):
        assert not any(column.group == "paper" for column in map_error_table(scope).columns)


def test_team_work(scope):
    row = cells(team_table(scope), 2)
    ratios = [max(d) / (sum(d) / 2) for d in ([30.0, 40.0], [30.0, 50.0], [30.0, 60.0], [30.0, 170.0])]
    assert row["balance_mean"] == pytest.approx(sum(ratios) / 4)
    assert row["overlap_mean"] == pytest.approx(0.2)
    assert row["moving_mean"] == pytest.approx(0.8)
    assert (row["collisions_with_walls_mean"], row["collisions_with_robots_mean"]) == (2.0, 1.0)
    alone = cells(team_table(scope), 1)
    assert alone["overlap_mean"] is None and alone["balance_mean"] is None


def test_radio_and_computing(scope):
    row = cells(radio_table(scope), 2)
    assert row["kilobytes_per_robot_mean"] == 200.0
    assert (row["packets_sent"], row["packets_failed"]) == (8 * 300, 8 * 3)
    computing = cells(computing_table(scope), 2)
    assert computing["real_time_factor_median"] == 20.0
    assert computing["cpu_ms_per_s_slam"] == pytest.approx(1000.0 * 3.0 / 200.0)


def merge(partner, at, accepted=True, right=True):
    return {"with": partner, "at": at, "transform": [0.0, 0.0, 0.0] if accepted else None, "right": right}


def load_with_merges(folder, *merges):
    record = make_record(len(merges), 1)
    for index, entries in enumerate(merges):
        record["robots"][f"robot_{index}"]["merges"] = entries
    return load_record(write_record(folder, record))


def test_when_all_are_merged(tmp_path):
    missing = load_with_merges(tmp_path, [merge("robot_1", 5.0)], [])
    assert all_merged_at(missing) is None
    both = load_with_merges(tmp_path, [merge("robot_1", 5.0)], [merge("robot_0", 9.0)])
    assert all_merged_at(both) == 9.0
    revoked = [merge("robot_1", 5.0, right=False), merge("robot_1", 7.0, accepted=False), merge("robot_1", 20.0)]
    late = load_with_merges(tmp_path, revoked, [merge("robot_0", 9.0)])
    assert all_merged_at(late) == 20.0


def test_merges_at_the_end_and_on_the_way(tmp_path):
    replaced = [merge("robot_1", 8.0), merge("robot_1", 5.0, right=False)]  # out of order
    record = load_with_merges(tmp_path, replaced, [merge("robot_0", 9.0, right=False)])
    assert merges_at_end(record) == (1, 1)
    (scope,) = scopes(load_records(tmp_path))
    row = cells(merging_table(scope), 2)
    assert (row["accepted_right"], row["accepted_wrong"], row["revoked"]) == (1, 2, 0)
    assert (row["end_right"], row["end_wrong"], row["end_possible"]) == (1, 1, 2)
    assert (row["complete_missions"], row["complete_at_s_median"]) == (1, 9.0)


def test_outcomes_name_every_trial_that_did_not_finish(tmp_path):
    write_record(tmp_path, make_record(1, 1))
    write_record(tmp_path, make_record(1, 2, times=[None], status="unfinished", reason="still exploring"))
    write_record(tmp_path, failed_record(1, 3, "IndexError"))
    records = load_records(tmp_path)
    assert outcome_table(records).rows == (("small8x8", "paper", "7", "bias", 1, 3, 1, 1, 1),)
    rows = trouble_table(records).rows
    assert [(row[5], row[6], row[8]) for row in rows] == [
        (2, "unfinished", "still exploring"),
        (3, "failed", "IndexError"),
    ]


def test_one_row_for_each_trial(scope, tmp_path):
    records = load_records(tmp_path)
    rows = list(csv.DictReader(io.StringIO(to_csv([(None, trials_table(records))]))))
    assert [(row["robots"], row["seed"], row["status"]) for row in rows] == [
        ("1", "1", "finished"), ("2", "1", "finished"), ("2", "2", "finished"), ("2", "3", "finished"),
        ("2", "4", "unfinished"), ("2", "5", "failed"),
    ]  # fmt: skip
    assert (rows[1]["exploration_time_s"], float(rows[1]["distance_m"])) == ("100.0", 70.0)
    assert (float(rows[1]["map_error_percent"]), float(rows[4]["map_error_percent"])) == (0.5, 6.0)
    assert (rows[4]["exploration_time_s"], rows[4]["collisions"]) == ("", "12")
    assert rows[5]["map_error_percent"] == ""


def test_a_chapter_of_failures_only(tmp_path):
    write_record(tmp_path, failed_record(2, 1, "IndexError"))
    (scope,) = scopes(load_records(tmp_path))
    row = cells(exploration_time_table(scope), 2)
    assert (row["failed"], row["exploration_time_s_mean"]) == (1, None)
    assert len(chapter_tables(scope)) == 7


def test_shown_values():
    assert shown(None, Column("a", "a")) == "\N{EN DASH}"
    assert shown(1234.56, Column("a", "a", 1)) == "1,234.6"
    assert shown(-0.001, Column("a", "a", 2)) == "0.00"
    assert shown(7, Column("a", "a")) == "7"
    counting = Column("a", "a", SIGNIFICANT)
    assert [shown(value, counting) for value in (0.0, 0.12345, 12.345, 123456.7)] == ["0", "0.1235", "12.35", "123,457"]


def test_csv_unites_the_columns(scope):
    other = Table("t", "", "", (Column("robots", "R"), Column("extra", "extra")), ((2, None), (3, 0.5)))
    rows = list(csv.DictReader(io.StringIO(to_csv([(scope.chapter, distance_table(scope)), (None, other)]))))
    assert [row["robots"] for row in rows] == ["1", "2", "2", "3"]
    assert rows[0]["world"] == paper.WORLD and rows[0]["distance_m_mean"] == "80.0"
    assert [row["extra"] for row in rows] == ["", "", "", "0.5"]
