"""What the fuzzers have been given so far, and variants of it: no crash, no broken promise."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))
import run_fuzz

HERE = Path(__file__).resolve().parent
VECTORS = HERE.parent.parent / "docs" / "protocol_vectors.json"
VARIANTS = 100_000  # of each stored input
VARIANTS_OF_ALL = {"fuzz_engine": 60_000}  # inputs together; two engines take longer than a parser


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


def test_frames_of_all_types_reach_the_engines():
    """Made by the fuzzer; from inputs with none of a type it would hardly ever come to one."""
    command = [str(Path(os.environ["FUZZ_REPLAY"]) / "corpus_types"), str(HERE / "corpus" / "fuzz_engine")]
    taken = subprocess.run(command, stdout=subprocess.PIPE, check=True, timeout=120).stdout
    frames = json.loads(VECTORS.read_text())["frames"]
    assert {int(line) for line in taken.split()} == {example["header"]["type"] for example in frames}


def test_without_clang_one_sentence_says_what_to_do(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(run_fuzz.FuzzError, match=r"clang.*not installed: run tools/install_dependencies fuzz"):
        run_fuzz.build(tmp_path)
