"""One program for all benchmarks."""

import importlib
from pathlib import Path

import pytest

from mr_experiments.bench.bench_command import BENCHMARKS, main


def test_help_lists_all(capsys):
    assert main(["--help"]) == 0
    listed = [line.split()[0] for line in capsys.readouterr().out.splitlines() if line.startswith("  ")]
    assert listed == list(BENCHMARKS)


@pytest.mark.parametrize("name", BENCHMARKS)
def test_each_has_options_and_says_its_name(name, capsys):
    with pytest.raises(SystemExit) as ended:
        main([name, "--help"])
    assert ended.value.code == 0
    told = capsys.readouterr().out
    assert told.startswith(f"usage: bench {name} ")
    assert "--out" in told


@pytest.mark.parametrize(
    "arguments, told",
    [([], "which benchmark"), (["slma"], "is slam meant?"), (["--out", "x"], "there is no benchmark --out")],
)
def test_what_is_no_benchmark_is_one_line(arguments, told, capsys):
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert error.startswith("bench: ")
    assert told in error
    assert error.count("\n") == 1


def test_every_benchmark_of_the_folder_is_listed():
    """A module with a command line that no name leads to is a benchmark that nobody can run."""
    folder = importlib.import_module("mr_experiments.bench").__path__[0]
    with_main = {path for path in Path(folder).glob("bench_*.py") if "def main(" in path.read_text()}
    assert {path.stem for path in with_main} == {b.module for b in BENCHMARKS.values()} | {"bench_command"}
