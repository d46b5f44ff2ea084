"""SLAM beside its peers: the rows, and what is said where they are not built."""

import sys

import numpy as np
import pytest

from mr_experiments.bench.slam_comparison import OURS, comparison_rows, measures_of, table
from mr_experiments.bench.slam_peers import peers
from mr_experiments.common.command_line import CallError
from mr_sim.slam_evaluation import Evaluation


def evaluation(walls: float, error: float) -> Evaluation:
    return Evaluation(error, error, error, np.empty(0), 0.0, walls, 1.0, 0.0, (1.0, 5.0))


SETTINGS = {
    ("pioneers", "a random walk"): {
        OURS: measures_of([evaluation(0.02, 0.1), evaluation(0.04, 0.3)]),
        "ICP": measures_of([evaluation(0.01, 0.5)]),
        "RBPF": measures_of([evaluation(0.06, 0.4)]),
    }
}


def test_ours_is_measured_by_the_best_peer_and_time_does_not_count() -> None:
    walls, worst, error, time, _ = comparison_rows(SETTINGS)
    assert walls["value"] == pytest.approx(3.0) and walls["bar"] == "<= 1 (ICP)" and not walls["holds"]
    assert not worst["holds"]
    assert error["detail"] == "ICP 0.5, RBPF 0.4; 2 logs"
    assert (time["bar"], time["holds"], time["detail"]) == ("-", True, "ICP 1, RBPF 1; 2 logs")
    assert error["value"] == pytest.approx(0.2) and error["bar"] == "<= 0.4 (RBPF)" and error["holds"]


def test_the_table_has_a_line_for_each_engine() -> None:
    head, *lines = table(SETTINGS).splitlines()
    assert "time per scan, worst [ms]" in head
    assert [line.split()[4] for line in lines] == [OURS, "ICP", "RBPF"]


def test_peers_that_are_not_built_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "_slam_peers", None)
    with pytest.raises(CallError, match="make bench-slam-peers"):
        peers()
