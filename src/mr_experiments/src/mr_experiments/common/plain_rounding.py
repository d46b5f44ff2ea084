"""Numbers rounded alike on every x86-64 processor, so that a mission repeats bit for bit on another computer.

glibc's sines and numpy's loops exist in variants of which the processor takes the fastest. Those with fused
multiplications round otherwise in the last bit, and a mission is chaotic: one such bit may end in another choice of
goals. The plain variants take the same time here (guard of 22 missions: 48.4 s of processor time with either).
"""

from __future__ import annotations

import os
import platform
import re
import sys
from pathlib import Path

_AVX512 = {"avx512f", "avx512cd"}
_SKYLAKE = {*_AVX512, "avx512vl", "avx512bw", "avx512dq"}
_CANNON_LAKE = {*_SKYLAKE, "avx512ifma", "avx512vbmi"}
_FLAGS = {
    "AVX": {"avx"}, "F16C": {"f16c"}, "FMA3": {"fma"}, "AVX2": {"avx2"},
    "AVX512F": {"avx512f"}, "AVX512CD": _AVX512, "AVX512_SKX": _SKYLAKE, "AVX512_CLX": {*_SKYLAKE, "avx512_vnni"},
    "AVX512_CNL": _CANNON_LAKE,
    "AVX512_ICL": {*_CANNON_LAKE, "avx512_vnni", "avx512_vbmi2", "avx512_bitalg", "avx512_vpopcntdq"},
}  # fmt: skip
"""What numpy calls a processor's features, and the flags of Linux that each is made of."""


def plain_settings(processor: str) -> dict[str, str]:
    """What glibc and numpy read when they are loaded. `processor`: text of /proc/cpuinfo; numpy warns of features that
    the processor does not have. No effect on other processors than x86-64."""
    flags = re.search(r"^flags\s*:(.*)$", processor, re.MULTILINE)
    has = set(flags[1].split()) if flags else set()
    features = " ".join(feature for feature, needs in _FLAGS.items() if needs <= has)
    settings = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX512F"}
    return {**settings, "NPY_DISABLE_CPU_FEATURES": features} if features else settings


def plain_environment() -> dict[str, str]:
    """The environment for a process that rounds plainly. What the user has set himself stays."""
    if platform.machine() != "x86_64":
        return dict(os.environ)
    return {**plain_settings(Path("/proc/cpuinfo").read_text()), **os.environ}


def restart_with_plain_rounding() -> None:
    """Starts this program again where it does not round plainly yet. To be called before anything is imported that
    computes; processes forked later round as this one."""
    environment = plain_environment()
    if environment != dict(os.environ):
        os.execve(sys.executable, [sys.executable, *sys.orig_argv[1:]], environment)
