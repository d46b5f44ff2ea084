"""How the process asks the system for memory."""

from __future__ import annotations

import ctypes

_TRIM_THRESHOLD, _TOP_PAD, _MMAP_THRESHOLD = -1, -2, -3  # of glibc's mallopt
_KEPT, _STEP, _LARGEST = 512 << 20, 16 << 20, 32 << 20  # bytes; glibc takes no larger threshold for mmap


def keep_freed_memory() -> None:
    """Freed memory stays with the process, up to 512 MB, for the next array. Without this every map that is copied
    makes the system clear fresh pages, some percent of the time of a mission. Does nothing but with glibc."""
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        for parameter, value in ((_TRIM_THRESHOLD, _KEPT), (_TOP_PAD, _STEP), (_MMAP_THRESHOLD, _LARGEST)):
            mallopt(parameter, value)
