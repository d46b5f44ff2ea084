"""What a benchmark that is interrupted leaves behind, and what is published."""

import json
import re
import subprocess
from pathlib import Path

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


REPOSITORY = Path(__file__).resolve().parents[3]


def commands(target):
    """What `make target` would run."""
    command = ["make", "--dry-run", "--no-print-directory", target]
    return subprocess.run(command, cwd=REPOSITORY, stdout=subprocess.PIPE, text=True, check=True).stdout


def parts_run(target):
    text = commands(target)
    named = re.findall(r"--part (\w+)", text)
    listed = [part for names in re.findall(r"for part in ([\w ]+);", text) for part in names.split()]
    return named + listed


def test_each_part_of_bench_engine_is_published_by_one_target():
    source = (REPOSITORY / "src/adhoc_communication/test/bench/bench_engine.cpp").read_text(encoding="utf-8")
    known = re.findall(r'\{"(\w+)", measure_', source)
    assert sorted(parts_run("bench-adhoc") + parts_run("bench-adhoc-long")) == sorted(known)


def test_a_target_publishes_its_own_rows_only():
    for target in ("bench-adhoc", "bench-adhoc-long"):
        assert "publish bench --update" in commands(target), target
    assert "--minutes" not in commands("bench-adhoc"), "the rows of ten minutes are those of bench-adhoc-long"
    assert "--minutes 10 " in commands("bench-adhoc-long")
