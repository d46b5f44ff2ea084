"""Which commit of this project was there at a moment."""

from __future__ import annotations

import subprocess
from pathlib import Path


def commit_at(seconds: float) -> str:
    """Short name of the last commit until then, `seconds` since 1970; empty where this is no checkout of git."""
    command = ["git", "-C", str(Path(__file__).parent), "log", "-1", "--format=%h", f"--before=@{int(seconds)}"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
    except OSError:
        return ""
