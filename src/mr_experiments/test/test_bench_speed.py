"""The benchmark's rows: what they hold and when they say that a bar is missed."""

import json

import pytest
from made_missions import made_mission, made_robot

from mr_experiments.bench import bench_speed
from mr_experiments.publish import publish_command
from mr_experiments.trial.trial import Trial, TrialError
from mr_measures.record.mission_record import Measured


@pytest.fixture
def fake_trials(monkeypatch):
    def install(time, cpu, status="finished"):
        def run(trial):
            measured = Measured(cpu=cpu, cpu_by_component={"slam": 0.5 * cpu, "navigation": 0.3 * cpu})
            return made_mission([made_robot()], status, time, measured=measured)

        monkeypatch.setattr(bench_speed, "run_trial", run)

    return install


def test_row_of_missions(fake_trials, tmp_path, capsys):
    fake_trials(time=300.0, cpu=20.0)
    out = tmp_path / "new" / "rows.json"
    assert bench_speed.main(["--only", "full", "--runs", "2", "--out", str(out)]) == 0
    (row,) = json.loads(out.read_text())
    assert set(row) == {"what", "bar", "value", "unit", "holds", "detail"}
    assert (row["bar"], row["value"], row["holds"]) == (">= 12", 15.0, True)
    assert "2 of 2 finished" in row["detail"]
    assert row["detail"].endswith("slam 50 %, navigation 30 %, rest 20 %")
    assert capsys.readouterr().out.startswith("ok   mission, 3 robots, office26x15")


def test_slow_and_unfinished_missions_miss_the_bar(fake_trials):
    fake_trials(time=300.0, cpu=26.0)
    assert bench_speed.main(["--only", "full", "--runs", "1"]) == 1
    fake_trials(time=300.0, cpu=20.0, status="unfinished")
    assert bench_speed.main(["--only", "full", "--runs", "1"]) == 1


def test_what_cannot_run_is_a_row(monkeypatch):
    def refuse(_):
        raise TrialError("there is no fast mode")

    monkeypatch.setattr(bench_speed, "run_trial", refuse)
    (row,) = bench_speed.PARTS["fast"](1)
    assert (row["value"], row["holds"], row["detail"]) == (None, False, "skipped: there is no fast mode")


def test_rows_of_the_world_alone_have_the_form_of_the_others(tmp_path):
    """So that they can be published with them."""
    out, table = tmp_path / "rows.json", tmp_path / "speed.csv"
    bench_speed.write_rows(bench_speed.world_rows(0.5, 1), out)
    assert publish_command.main(["bench", str(out), str(table)]) == 0
    assert [row["bar"] for row in publish_command.read_table(table)] == [">= 157", ">= 102", ">= 79", ">= 54"]


def test_sweep_ratio(monkeypatch):
    times = {1: iter([10.0, 12.0, 10.0]), 2: iter([5.0, 8.0, 5.5])}
    monkeypatch.setattr(bench_speed, "sweep_time", lambda workers, _: next(times[workers]))
    (row,) = bench_speed.PARTS["sweep"](3)
    assert (row["value"], row["holds"]) == (1.82, True)


def test_sweep_on_a_cluster_of_its_own():
    pytest.importorskip("distributed")
    assert bench_speed.sweep_time(2, [Trial("small8x8", 1, seed, limit=1.0) for seed in (1, 2)]) > 0.0
