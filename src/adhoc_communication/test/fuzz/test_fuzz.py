"""Each fuzzer for a short time, from the same seed: no crash, no broken promise."""

import os
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))
import run_fuzz

SECONDS = 15


@pytest.fixture(scope="module")
def fuzzers():
    try:
        return run_fuzz.build(Path(os.environ["FUZZ_BUILD"]))
    except run_fuzz.FuzzError as error:
        pytest.fail(str(error), pytrace=False)


@pytest.mark.parametrize("target", run_fuzz.TARGETS)
def test_nothing_is_found(fuzzers, target):
    try:
        executions, _ = run_fuzz.run_alike(fuzzers, target, SECONDS)
    except run_fuzz.FuzzError as error:
        pytest.fail(str(error), pytrace=False)
    assert executions > 100


def test_without_clang_one_sentence_says_what_to_do(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(run_fuzz.FuzzError, match=r"clang.*not installed: run tools/install_dependencies"):
        run_fuzz.build(tmp_path)
