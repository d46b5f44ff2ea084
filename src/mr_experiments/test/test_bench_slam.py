"""The benchmark of SLAM: what it records, keeps and says."""

import json
from pathlib import Path

import numpy as np
import pytest

from mr_experiments.bench import bench_slam, slam_logs
from mr_experiments.bench.bench_slam import LOOP_END, Spent, loop_row, time_rows
from mr_experiments.host.mission import Mission
from mr_experiments.trial.scenario import load_scenario
from mr_experiments.trial.trial import Trial
from mr_robot.slam.engine import SlamOptions
from mr_sim.scan_log import ScanLog
from mr_sim.slam_evaluation import Evaluation


def log_of(world: str) -> ScanLog:
    geometry = np.array([-0.5, 0.01, 0.1, 4.0, 0.0, 0.0, 0.0])
    return ScanLog(world, geometry, np.arange(2.0), np.ones((2, 5), np.float32), np.zeros((2, 3)), np.zeros((2, 3)))


def evaluation(loop_errors: list[float]) -> Evaluation:
    return Evaluation(0.0, 0.0, 0.0, np.array(loop_errors), 0.0, 0.0, 1.0, 0.0, (1.0, 5.0))


def test_a_mission_is_recorded_once_and_judged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(slam_logs, "trials", lambda kind, first, most: [Trial("small8x8", 1, first)])
    call = ["--kinds", "pioneers", "--first-seed", "1"]
    assert bench_slam.main([*call, "--logs", str(tmp_path), "--out", str(tmp_path / "rows.json")]) == 0
    log = ScanLog.load(tmp_path / "small8x8-s1.npz")
    assert len(log.times) > 100 and log.ranges.shape[1] == 541
    rows = json.loads((tmp_path / "rows.json").read_text())
    assert [row["unit"] for row in rows] == ["%"] * 4 + ["ms"] * 2 and all(row["holds"] for row in rows)
    assert rows[0]["detail"].startswith("1 logs; ")
    monkeypatch.setattr(slam_logs, "record", lambda trial: pytest.fail("recorded again"))
    slam_logs.recorded(Trial("small8x8", 1, 1), tmp_path)


@pytest.mark.parametrize("scenario, free_range", [("paper", 8.0), ("turtlebot", 4.0)])
def test_slam_runs_on_a_log_as_it_runs_on_its_robot(scenario: str, free_range: float) -> None:
    """All were judged with the options of a robot that nobody has described."""
    trial = load_scenario(scenario).trial(1, 7, 1, "")
    (robot,) = Mission(trial).robots
    options = slam_logs.slam_of(log_of(trial.world)).options
    assert options == robot.body.slam.options
    assert options.free_range == free_range != SlamOptions().free_range


def test_the_numbers_of_logs_are_settled_beforehand() -> None:
    counts = {name: len(slam_logs.trials(kind, 1)) for name, kind in slam_logs.KINDS.items()}
    assert counts == {
        "pioneers": 20, "turtlebots": 20, "halls": 10, "loops": 10, "large floor": 6, "large loops": 12,
    }  # fmt: skip
    few = slam_logs.trials(slam_logs.KINDS["halls"], 5, 2)
    assert [trial.world for trial in few] == ["generated:hall:5:48x20", "generated:hall:6:48x20"]


def test_each_log_says_how_far_it_is_off_where_its_loops_end() -> None:
    row = loop_row("large loops", [evaluation([0.1] * 90), evaluation([]), evaluation([0.4] * 10)])
    assert row["value"] == pytest.approx(0.4) and row["bar"] == f"<= {LOOP_END:g}" and not row["holds"]
    assert row["detail"] == (
        "100 scans at loop ends; 3 logs, 1 of them without a loop; 1 of 2 above 0.3 m by themselves; "
        "0.95 quantile of each: 0.100, no loop, 0.400 m"
    )
    assert not loop_row("large loops", [evaluation([])])["holds"]


def test_times_are_those_of_all_kinds_and_name_the_slowest() -> None:
    mean, worst = time_rows([Spent("a", 300, 2.0, 70.0), Spent("b", 100, 4.0, 9.0), Spent("b", 100, 6.0, 8.0)])
    assert mean["value"] == pytest.approx(3.2) and mean["holds"]
    assert mean["detail"] == "500 scans, one core; b 5.0, a 2.0"
    assert (worst["value"], worst["holds"], worst["detail"]) == (70.0, False, "a 70.0, b 9.0")


def test_bad_calls_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert bench_slam.main(["--missions", "0"]) == 2
    assert "--missions must be at least 1" in capsys.readouterr().err
