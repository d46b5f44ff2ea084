"""The same rounding on every x86-64 processor."""

import platform
import subprocess
import sys
from pathlib import Path

import pytest

from mr_experiments.common.plain_rounding import plain_environment, plain_settings

PROGRAM = """
import os, sys
from mr_experiments.common.plain_rounding import restart_with_plain_rounding
restart_with_plain_rounding()
print(sys.argv[1:], os.environ.get("GLIBC_TUNABLES"), os.environ.get("NPY_DISABLE_CPU_FEATURES"))
import numpy.core._multiarray_umath as core
print([name for name in ("AVX2", "FMA3", "AVX512F") if core.__cpu_features__[name]])
"""

SETTINGS = plain_settings(Path("/proc/cpuinfo").read_text())

pytestmark = pytest.mark.skipif(platform.machine() != "x86_64", reason="glibc and numpy take these on x86-64 alone")


def test_program_starts_again_once_with_its_arguments(tmp_path, monkeypatch):
    for name in SETTINGS:
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "program.py").write_text(PROGRAM)
    command = [sys.executable, str(tmp_path / "program.py"), "a b", "--c"]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    assert run.stderr == ""
    assert run.stdout.splitlines() == [f"['a b', '--c'] {' '.join(SETTINGS.values())}", "[]"]


def test_what_the_user_has_set_stays(monkeypatch):
    monkeypatch.setenv("GLIBC_TUNABLES", "glibc.malloc.arena_max=1")
    assert plain_environment()["GLIBC_TUNABLES"] == "glibc.malloc.arena_max=1"
    assert plain_environment()["NPY_DISABLE_CPU_FEATURES"] == SETTINGS["NPY_DISABLE_CPU_FEATURES"]


def test_only_what_the_processor_has_is_disabled():
    """On one without AVX-512 numpy warned of it with each command."""
    older = plain_settings("processor\t: 0\nflags\t\t: fpu sse4_2 avx f16c fma avx2 avx512ifma\npower: \n")
    assert older["NPY_DISABLE_CPU_FEATURES"] == "AVX F16C FMA3 AVX2"
    assert "NPY_DISABLE_CPU_FEATURES" not in plain_settings("flags\t\t: fpu sse4_2\n")
