"""What a benchmark that is interrupted leaves behind, and what is published."""

import json
import re
import subprocess
from pathlib import Path

import bench_adversaries as bench
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
    for target in ("bench-adhoc", "bench-adhoc-long", "fuzz"):
        assert "publish bench --update" in commands(target), target
    assert "--minutes" not in commands("bench-adhoc"), "the rows of ten minutes are those of bench-adhoc-long"
    assert "--minutes 10 " in commands("bench-adhoc-long")


def report(peak, failed=()):
    tests = [{"name": name, **({"failures": ["x"]} if name in failed else {})} for name in ("Bombs", "Replays")]
    return {"testsuites": [{"peak_kilobytes": str(peak), "testsuite": tests}]}


def test_the_worst_seed_of_the_adversaries_counts():
    reports = [report(20_000), report(64_100), report(30_000)]
    row = bench.memory_row("open team", reports)
    assert (row["value"], row["holds"]) == (64.1, False)
    assert bench.memory_row("open team", reports[:1])["holds"]
    assert not bench.memory_row("open team", [{"tests": 0}])["holds"], "nothing was played"
    row = bench.memory_row("open team", reports[:1], bench.DEFAULT_PACKET)
    assert row["what"].endswith("max_packet_size as by default, open team: peak of the process")
    assert row["detail"].endswith("packets of at most 10 MB")
    row = bench.success_row("open team", reports)
    assert (row["value"], row["holds"], row["detail"]) == (0, True, "2 adversaries, 3 seeds each")
    row = bench.success_row("open team", [report(1), report(1, failed=["Bombs"])])
    assert (row["value"], row["holds"]) == (1, False)
    assert not bench.success_row("open team", [report(1), {"tests": 0}])["holds"], "a seed was not played"
