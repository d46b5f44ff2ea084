"""The benchmark of SLAM: what it records, keeps and says."""

import json
from pathlib import Path

import pytest

from mr_experiments.bench import bench_slam
from mr_experiments.trial.trial import Trial
from mr_sim.scan_log import ScanLog


def test_a_mission_is_recorded_once_and_judged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench_slam, "trials", lambda kind, first, count: [Trial("small8x8", 1, first)])
    call = ["--kinds", "pioneers", "--missions", "1", "--logs", str(tmp_path), "--out", str(tmp_path / "rows.json")]
    assert bench_slam.main(call) == 0
    log = ScanLog.load(tmp_path / "small8x8-s1.npz")
    assert len(log.times) > 100 and log.ranges.shape[1] == 541
    rows = json.loads((tmp_path / "rows.json").read_text())
    assert [row["unit"] for row in rows] == ["%"] * 4 + ["ms"] * 2 and all(row["holds"] for row in rows)
    monkeypatch.setattr(bench_slam, "record", lambda trial: pytest.fail("recorded again"))
    bench_slam.recorded(Trial("small8x8", 1, 1), tmp_path)


def test_bad_calls_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert bench_slam.main(["--missions", "0"]) == 2
    assert "--missions must be at least 1" in capsys.readouterr().err
