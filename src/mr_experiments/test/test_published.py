"""Figures in pages come from result files."""

import json
import os
import re
import subprocess
from datetime import datetime, timezone
from pathlib import Path

import pytest
from made_missions import made_mission, made_robot

from mr_experiments.bench.explore_missions import MissionRow
from mr_experiments.publish import publish_command
from mr_experiments.publish.mission_table import mission_rows, world_rows
from mr_experiments.publish.published import PublishError, render
from mr_measures.record.files import write_record
from mr_measures.record.robot_record import Contacts, MapFigures
from mr_measures.record.series import RobotSeries, TeamSeries

ROOT = Path(__file__).resolve().parents[3]
ROWS = [{"robots": "1", "mean": "238.03"}, {"robots": "4", "mean": "103.94"}, {"robots": "8", "mean": ""}]


def read(name):
    return {"t.csv": ROWS}[name]


def marked(asked, inside=""):
    return f"before <!-- published: {asked} -->{inside}<!-- end --> after"


def test_a_table_and_a_value_are_written_anew():
    page = marked('table t.csv robots=R "mean=mean T|.0f"', "\n\n| old |\n")
    table = "| R | mean T |\n| --- | --- |\n| 1 | 238 |\n| 4 | 104 |\n| 8 | \N{EN DASH} |"
    assert render(page, read) == marked('table t.csv robots=R "mean=mean T|.0f"', f"\n\n{table}\n\n")
    value = marked("value t.csv mean|.1f where robots=4", "99")
    assert render(value, read) == value.replace("99", "103.9")
    assert render(render(page, read), read) == render(page, read)


@pytest.mark.parametrize(
    "page, trouble",
    [
        (marked("value t.csv median where robots=4"), "line 1: t.csv has no column median, but robots, mean"),
        ("\n" + marked("value t.csv mean"), "line 2: 3 rows of t.csv are so; a value needs one"),
        (
            marked("figure t.csv mean"),
            "line 1: 'figure t.csv mean' is neither a table, an origin nor the value of one column",
        ),
        (marked("table t.csv mean where robots"), "line 1: 'robots' behind `where` is no COLUMN=VALUE"),
        ("<!-- published: value t.csv mean -->", "line 1: no <!-- end --> after the marker"),
        (marked('table t.csv "mean'), "line 1: cannot read 'table t.csv \"mean': No closing quotation"),
    ],
)
def test_what_cannot_be_filled_is_named(page, trouble):
    with pytest.raises(PublishError, match=f"^{re.escape(trouble)}$"):
        render(page, read)


def record(robots, seed, time, **differences):
    series = TeamSeries(time=(0.0, 0.5 * time, time), coverage=(0.1, 0.98, 1.0))
    figures = MapFigures(coverage=0.998, error=-0.2, wrong_walls=0.01)
    lost = RobotSeries(time=(0.0, 1.0), x=(1.0, 4.0), y=(0.0, 4.0))
    robot = made_robot(distance=50.0, map=figures, collisions=Contacts(0, 1), finished_at=time - 2.0, series=lost)
    settings = {"seed": seed, **differences}
    return made_mission([robot] * robots, time=time, settings=settings, series=series, versions={"code": "abc"})


def test_a_benchmark_updates_its_own_rows_of_a_table(tmp_path):
    table, rows = tmp_path / "t.csv", tmp_path / "rows.json"

    def publish(*found, update):
        rows.write_text(json.dumps([{"what": what, "value": value} for what, value in found]))
        arguments = ["bench", str(rows), str(table), *(["--update"] if update else [])]
        assert publish_command.main(arguments) == 0
        return [(row["what"], row["value"]) for row in publish_command.read_table(table)]

    publish(("long", 600), ("short", 1), update=False)
    assert publish(("short", 2), ("new", 3), update=True) == [("long", "600"), ("short", "2"), ("new", "3")]
    assert publish(("short", 2), update=False) == [("short", "2")]


def test_missions_of_a_kind_make_one_row():
    records = [
        record(2, 1, 100.0),
        record(2, 2, 120.0),
        record(1, 1, 200.0),
        record(1, 1, 210.0, odometry="random_walk"),
    ]
    rows = mission_rows(records)
    assert [(row["robots"], row["odometry"], row["trials"]) for row in rows] == [
        (1, "bias", 1), (2, "bias", 2), (1, "random_walk", 1),
    ]  # fmt: skip
    two = rows[1]
    assert two["time_mean"] == 110.0 and two["time_longest"] == 120.0 and two["ends_most"] == 2.0
    assert two["after_known"] == pytest.approx(0.25) and two["distance"] == 100.0
    assert (two["wrong_maps"], two["maps"], two["collisions"], two["not_home"]) == (4, 4, 4, 4)


def test_missions_that_failed_are_counted_and_enter_no_mean():
    crashed = made_mission([], settings={"seed": 2, "robots": 1}, status="failed")
    (row,) = mission_rows([record(1, 1, 100.0), crashed])
    assert (row["trials"], row["failed"], row["finished"], row["distance"], row["maps"]) == (2, 1, 1, 50.0, 1)


def test_a_trial_counts_once(tmp_path, capsys):
    """Its interval was too narrow where it counted twice."""
    folder, table = tmp_path / "records", str(tmp_path / "t.csv")
    folder.mkdir()
    write_record(record(1, 1, 100.0), folder / "a.json")
    assert publish_command.main(["missions", str(folder), str(folder), table]) == 2
    write_record(record(1, 1, 100.0), folder / "copy.json")
    assert publish_command.main(["missions", str(folder), table]) == 2
    first, second = capsys.readouterr().err.splitlines()
    assert "a.json is given twice" in first and "record the same trial" in second


def test_worlds_are_compared_one_by_one():
    def mission(world, robots, strategy, time):
        return MissionRow(
            world, robots, strategy, 1, 900.0, "c", "finished", "", time, 0.9 * time, time, (1.0,), (), 1.0, 0, 0
        )

    missions = [
        mission("generated:cave:1", 1, 7, 100.0), mission("generated:cave:1", 4, 7, 50.0),
        mission("generated:hall:2", 1, 7, 400.0), mission("generated:hall:2", 4, 7, 100.0),
        mission("generated:hall:2", 1, 0, 500.0),
    ]  # fmt: skip
    cave, hall, every = world_rows(missions)
    assert (cave["kind"], hall["kind"], every["kind"], every["worlds"]) == ("cave", "hall", "all", 2)
    assert every["t4_over_t1"] == pytest.approx(0.375) and hall["best_over_nearest_1"] == 0.8
    assert cave["best_over_nearest_1"] is None and every["after_known_4"] == pytest.approx(0.1)


def test_the_command_writes_tables_and_pages(tmp_path, capsys):
    (tmp_path / "records").mkdir()
    write_record(record(4, 1, 104.2), tmp_path / "records" / "a.json")
    (tmp_path / "records" / "other.json").write_text("[]")
    table, page = tmp_path / "data" / "t.csv", tmp_path / "page.md"
    assert publish_command.main(["missions", str(tmp_path / "records"), str(table)]) == 0
    page.write_text(marked("value data/t.csv time_mean|.0f where robots=4"))
    assert publish_command.main(["pages", "--check", str(page)]) == 1
    assert "out of date" in capsys.readouterr().out
    assert publish_command.main(["pages", str(page)]) == 0
    assert ">104<" in page.read_text() and publish_command.main(["pages", "--check", str(page)]) == 0


def test_of_several_comparisons_the_latest_is_published(tmp_path):
    rows = [{"what": "T", "value": value} for value in (1.1, 0.9)]
    source, table = tmp_path / "agreement.json", tmp_path / "t.csv"
    source.write_text(json.dumps({"comparisons": [{"rows": [row], "commits": ["abc"]} for row in rows]}))
    os.utime(source, (0, 86400.0))
    assert publish_command.main(["bench", str(source), str(table)]) == 0
    assert publish_command.read_table(table) == [
        {"what": "T", "value": "0.9", "measured": "1970-01-02", "commit": "abc"}]  # fmt: skip


def test_a_table_tells_when_it_was_measured_and_of_which_code(tmp_path):
    """Of rows of two files each has its own origin; that of a checkout is the commit that was there then."""
    asked = ["git", "-C", str(ROOT), "log", "-1", "--format=%h %ct"]
    commit, moment = subprocess.run(asked, capture_output=True, text=True, check=True).stdout.split()
    sources = [tmp_path / "a.json", tmp_path / "b.json"]
    for source, seconds in zip(sources, (10**9, int(moment) + 1)):
        source.write_text(json.dumps([{"what": source.stem, "value": 1.0}]))
        os.utime(source, (0, seconds))
    table, page = tmp_path / "t.csv", tmp_path / "page.md"
    assert publish_command.main(["bench", *map(str, sources), str(table)]) == 0
    page.write_text(marked("table t.csv what") + marked("origin t.csv where what=b"))
    assert publish_command.main(["pages", str(page)]) == 0
    day = datetime.fromtimestamp(int(moment) + 1, timezone.utc).date().isoformat()
    both, second = re.findall(r"Measured .*", page.read_text())
    assert both == f"Measured from 2001-09-09 to {day}, code unknown, {commit}."
    assert second.startswith(f"Measured on {day}, code {commit}.<!-- end -->")


def test_bad_sources_are_one_line(tmp_path, capsys):
    assert publish_command.main(["missions", str(tmp_path), str(tmp_path / "t.csv")]) == 2
    assert publish_command.main(["bench", str(tmp_path / "no.json"), str(tmp_path / "t.csv")]) == 2
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 2 and "no records of missions in" in errors[0] and "No such file" in errors[1]


@pytest.mark.parametrize("page", ["docs/results/README.md", "docs/results/radio.md", "docs/comparison.md", "README.md"])
def test_published_figures_are_those_of_the_result_files(page):
    assert publish_command.main(["pages", "--check", str(ROOT / page)]) == 0
