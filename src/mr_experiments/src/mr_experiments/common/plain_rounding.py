"""Numbers rounded alike on every x86-64 processor, so that a mission repeats bit for bit on another computer.

glibc's sines and numpy's loops exist in variants of which the processor takes the fastest. Those with fused
multiplications round otherwise in the last bit, and a mission is chaotic: one such bit may end in another choice of
goals. The plain variants take the same time here (guard of 22 missions: 48.4 s of processor time with either).
"""

from __future__ import annotations

import os
import platform
import sys

SETTINGS = {
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX512F",
    "NPY_DISABLE_CPU_FEATURES": "AVX F16C FMA3 AVX2 AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL",
}
"""What glibc and numpy read when they are loaded. On other processors than x86-64 they have no effect."""


def plain_environment() -> dict[str, str]:
    """The environment for a process that rounds plainly. What the user has set himself stays."""
    return {**SETTINGS, **os.environ} if platform.machine() == "x86_64" else dict(os.environ)


def restart_with_plain_rounding() -> None:
    """Starts this program again where it does not round plainly yet. To be called before anything is imported that
    computes; processes forked later round as this one."""
    environment = plain_environment()
    if environment != dict(os.environ):
        os.execve(sys.executable, [sys.executable, *sys.orig_argv[1:]], environment)
