"""What the fuzzers have been given so far, and variants of it: no crash, no broken promise."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))
import run_fuzz

HERE = Path(__file__).resolve().parent
VARIANTS = {"fuzz_engine": 4000}  # of each stored input; two engines take longer than a parser
MOST_VARIANTS = 100_000


@pytest.mark.parametrize("target", run_fuzz.TARGETS)
def test_nothing_is_found(target):
    corpus, variants = HERE / "corpus" / target, VARIANTS.get(target, MOST_VARIANTS)
    replay = Path(os.environ["FUZZ_REPLAY"]) / f"replay_{target}"
    command = [str(replay), str(run_fuzz.TARGETS[target]), str(variants), str(corpus)]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout[-4000:]}"
    assert done.stdout == f"{len(list(corpus.iterdir())) * (1 + variants)} inputs\n"


def test_without_clang_one_sentence_says_what_to_do(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(run_fuzz.FuzzError, match=r"clang.*not installed: run tools/install_dependencies fuzz"):
        run_fuzz.build(tmp_path)
