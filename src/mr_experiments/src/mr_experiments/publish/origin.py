"""When the rows of a published table were measured, and which code they are of: columns of its CSV, a line below it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from mr_experiments.common.checkout import commit_at

MEASURED, COMMIT = "measured", "commit"


def with_origin(rows: Iterable[Mapping[str, Any]], paths: Iterable[Path], commit: str = "") -> list[dict[str, Any]]:
    """Rows of what was written to these files: the day (UTC) of the last of them, and the commit, or else the one that
    was there then."""
    seconds = max(path.stat().st_mtime for path in paths)
    day = datetime.fromtimestamp(seconds, timezone.utc).date().isoformat()
    return [{**row, MEASURED: day, COMMIT: commit or commit_at(seconds)} for row in rows]


def line_of(rows: Sequence[Mapping[str, str]]) -> str:
    """One sentence; empty for a table that does not say it."""
    if not rows:
        return "Not measured yet."
    if MEASURED not in rows[0]:
        return ""
    days = sorted({row[MEASURED] for row in rows})
    commits = list(dict.fromkeys(row[COMMIT] or "unknown" for row in rows))
    when = f"on {days[0]}" if len(days) == 1 else f"from {days[0]} to {days[-1]}"
    return f"Measured {when}, code {', '.join(commits)}."
