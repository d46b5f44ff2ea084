"""How the benchmarks tell and keep what they have measured."""

import json
from pathlib import Path

import pytest

from map_merger.benchmark.rows import conclude


def row(holds):
    return {"what": "time", "bar": "<= 2", "value": 1, "unit": "s", "holds": holds, "detail": ""}


@pytest.mark.parametrize(("all_hold", "code"), [((True, None), 0), ((True, False), 1), ((None,), 0), ((), 0)])
def test_a_bar_that_is_missed_is_told_and_a_figure_without_one_is_no_miss(all_hold, code, tmp_path: Path, capsys):
    rows, path = [row(holds) for holds in all_hold], tmp_path / "bench" / "rows.json"
    assert conclude(rows, path) == code
    assert json.loads(path.read_text()) == rows
    said = capsys.readouterr().out
    assert said.count("MISSED time: 1 s (<= 2)") == all_hold.count(False)
    barred = [holds for holds in all_hold if holds is not None]
    assert said.endswith(f"{sum(barred)} of {len(barred)} bars hold; rows in {path}\n")
