"""What the fuzzers have been given so far, and variants of it: no crash, no broken promise."""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))
import run_fuzz

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[3]
VECTORS = HERE.parent.parent / "docs" / "protocol_vectors.json"
VARIANTS = 100_000  # of each stored input
# Inputs together: two engines take longer than a parser, and so do sums and whole messages.
VARIANTS_OF_ALL = {"fuzz_engine": 52_000, "fuzz_sealed": 10_000, "fuzz_message": 300_000, "fuzz_payload": 300_000}


@pytest.mark.parametrize("target", run_fuzz.TARGETS)
def test_nothing_is_found(target):
    corpus = HERE / "corpus" / target
    inputs = len(list(corpus.iterdir()))
    variants = VARIANTS_OF_ALL[target] // inputs if target in VARIANTS_OF_ALL else VARIANTS
    replay = Path(os.environ["FUZZ_REPLAY"]) / f"replay_{target}"
    command = [str(replay), str(run_fuzz.TARGETS[target]), str(variants), str(corpus)]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout[-4000:]}"
    assert done.stdout == f"{inputs * (1 + variants)} inputs\n"


@pytest.mark.parametrize("target", ["fuzz_engine", "fuzz_sealed"])
def test_frames_of_all_types_reach_the_engines(target):
    """Made by the fuzzer; from inputs with none of a type it would hardly ever come to one."""
    command = [str(Path(os.environ["FUZZ_REPLAY"]) / "corpus_types"), str(HERE / "corpus" / target)]
    taken = subprocess.run(command, stdout=subprocess.PIPE, check=True, timeout=120).stdout
    frames = json.loads(VECTORS.read_text())["frames"]
    assert {int(line) for line in taken.split()} == {example["header"]["type"] for example in frames}


FUZZER = """#!/bin/sh
touch {folder}/corpus/fuzz_text/new
echo "stat::number_of_executed_units: {inputs}"
echo "stat::average_exec_per_sec: 7"
exit {status}
"""


def fuzzer(folder, inputs, status=0):
    """What run_fuzz takes for the built fuzz_text."""
    (folder / "fuzz_text").write_text(FUZZER.format(folder=folder, inputs=inputs, status=status))
    (folder / "fuzz_text").chmod(0o755)


def test_all_runs_together_are_a_row(tmp_path):
    ledger = tmp_path / "runs.csv"
    fuzzer(tmp_path, 30_000_000)
    assert run_fuzz.run(tmp_path, "fuzz_text", 5, ledger) == (30_000_000, 7)
    assert (run_fuzz.row(ledger)["value"], run_fuzz.row(ledger)["holds"]) == (30_000_000, False)
    fuzzer(tmp_path, 70_000_000, status=77)
    with pytest.raises(run_fuzz.FuzzError, match="fuzz_text found a fault"):
        run_fuzz.run(tmp_path, "fuzz_text", 5, ledger)
    row = run_fuzz.row(ledger)
    assert (row["value"], row["holds"]) == (100_000_000, True)
    assert row["detail"].startswith("2 runs, 1 of which found a fault;")
    assert row["detail"].endswith("fuzz_text 100000000, fuzz_engine 0, fuzz_sealed 0, fuzz_message 0, fuzz_payload 0")


def test_the_published_row_is_that_of_the_kept_runs():
    with (REPOSITORY / "docs" / "results" / "data" / "radio.csv").open(newline="", encoding="utf-8") as file:
        published = {row["what"]: row for row in csv.DictReader(file)}
    row = run_fuzz.row()
    stored = published[row["what"]]
    assert {name: stored[name] for name in row} == {name: str(value) for name, value in row.items()}


def test_without_clang_one_sentence_says_what_to_do(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(run_fuzz.FuzzError, match=r"clang.*not installed: run tools/install_dependencies fuzz"):
        run_fuzz.build(tmp_path)
