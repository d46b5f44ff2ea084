"""The benchmark of SLAM: what it records, keeps and says."""

import json
import os
import signal
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mr_experiments.bench import bench_slam, slam_logs
from mr_experiments.bench.bench_slam import LOOP_END, Spent, loop_row, time_rows
from mr_experiments.common.bounded import Bounds, bounded
from mr_experiments.host.mission import Mission
from mr_experiments.trial.scenario import load_scenario
from mr_experiments.trial.trial import Trial
from mr_grid import OccupancyGrid, Pose
from mr_robot.platforms.engines import defaults_of
from mr_robot.slam.engine import LaserScan, SlamError, SlamOptions, SlamUpdate
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
    assert [row["unit"] for row in rows] == ["%"] * 5 + ["robots", "%"] + ["ms"] * 2 + ["logs"]
    assert all(row["holds"] for row in rows)
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
    assert options.free_range == free_range != defaults_of(SlamOptions)["free_range"]


def killed() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


class Endless:
    """SLAM that stops for ever at its first scan, in one way or another."""

    def __init__(self, way: Callable[[], object]) -> None:
        self._way = way

    def process(self, scan: LaserScan, odometry: Pose, time: float) -> SlamUpdate:
        while True:
            self._way()

    def map(self) -> OccupancyGrid:
        raise NotImplementedError


KEPT: list[np.ndarray] = []


@pytest.mark.parametrize("way, patience, reason", [
    (int, 100.0, "took more than 1 s of processor time"),
    (threading.Event().wait, 0.1, "did not end in 0.1 s"),
    (lambda: KEPT.append(np.empty(1 << 24)), 100.0, "took more than 1.1 GB of memory"),
    (killed, 100.0, "its process was ended by SIGKILL"),
])  # fmt: skip
def test_slam_that_does_not_end_is_ended(
    way: Callable[[], object], patience: float, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It took the computer with it."""
    monkeypatch.setattr(slam_logs, "LOG_TIME", (0.2, 0.1))  # s
    monkeypatch.setattr(slam_logs, "MOST_MEMORY", 1 << 30)
    monkeypatch.setattr("mr_experiments.common.bounded.BUSY", patience)
    found = bench_slam.judged({"small8x8-s1": log_of("small8x8")}, "ours", lambda _: Endless(way))
    assert found.failed == [f"small8x8-s1, ours: {reason}"]
    assert not found.results and np.isinf(found.with_lost[0].q95_error)


def test_logs_without_a_result_are_named_in_a_row_that_does_not_hold(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(bench_slam, "slam_of", lambda _: Endless(killed))
    monkeypatch.setattr(slam_logs, "recorded", lambda trial, folder: log_of("small8x8"))
    out = tmp_path / "rows.json"
    assert bench_slam.main(["--kinds", "halls", "--missions", "2", "--out", str(out)]) == 1
    (row,) = json.loads(out.read_text())
    assert (row["what"], row["value"], row["holds"]) == ("logs without a result", 4.0, False)
    first = "odometry with a constant bias, generated-hall-73001-48x20-s73001, ours: its process was ended by SIGKILL; "
    assert row["detail"].startswith(first)


def test_slam_that_does_not_end_is_not_better_than_its_peers(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(bench_slam, "slam_of", lambda _: Endless(killed))
    monkeypatch.setattr(bench_slam, "peers", lambda: {"MRPT ICP": lambda _: Endless(killed)})
    monkeypatch.setattr(slam_logs, "recorded", lambda trial, folder: log_of("small8x8"))
    out = tmp_path / "rows.json"
    assert bench_slam.main(["--peers", "--kinds", "halls", "--missions", "1", "--out", str(out)]) == 1
    *compared, last = json.loads(out.read_text())
    assert not any(row["holds"] for row in compared if row["bar"] != "-")
    assert (last["what"], last["value"], last["holds"]) == ("logs without a result", 2.0, False)


def test_a_mission_that_cannot_be_recorded_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(slam_logs, "record", lambda trial: killed())
    found, failed = slam_logs.drives(slam_logs.KINDS["halls"], 5, 1, tmp_path)
    assert (found, failed) == ([], ["generated-hall-5-48x20-s5, recorded: its process was ended by SIGKILL"])


def test_what_is_wrong_in_the_other_process_is_raised_in_this_one() -> None:
    def fail() -> None:
        raise SlamError("no such scan")

    with pytest.raises(SlamError, match="no such scan") as caught:
        bounded(fail, Bounds(10.0, 1 << 30))
    assert "in fail" in str(caught.value.__cause__)


def test_the_numbers_of_logs_are_settled_beforehand() -> None:
    counts = {name: len(slam_logs.trials(kind, 1)) for name, kind in slam_logs.KINDS.items()}
    assert counts == {
        "pioneers": 20, "turtlebots": 20, "halls": 10, "loops": 10, "equal rooms": 10, "large floor": 6,
        "large loops": 12,
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
