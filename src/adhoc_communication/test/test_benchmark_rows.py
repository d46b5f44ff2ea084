"""What a benchmark that is interrupted leaves behind."""

import json

from benchmark_rows import Rows


def row(value, holds=True):
    return {"what": "a", "bar": "<= 1", "value": value, "unit": "s", "holds": holds, "detail": ""}


def test_each_row_is_in_the_file_as_soon_as_it_is_measured(tmp_path):
    file = tmp_path / "out" / "rows.json"
    rows = Rows(file)
    rows.add(row(1))
    assert json.loads(file.read_text()) == [row(1)]
    rows.add(row(2, holds=False))
    assert json.loads(file.read_text()) == [row(1), row(2, holds=False)]
    assert [found.name for found in file.parent.iterdir()] == ["rows.json"]


def test_a_missed_bar_ends_the_program_with_one():
    rows = Rows(None)
    rows.add(row(1))
    assert rows.status() == 0
    rows.add(row(2, holds=False))
    assert rows.status() == 1
