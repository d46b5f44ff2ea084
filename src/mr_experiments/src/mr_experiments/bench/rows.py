"""Rows of benchmarks: what was measured, its bar, and whether that holds."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, Sequence

Row = dict[str, Any]  # what, bar, value, unit, holds, detail; the value None: never


def row_of(what: str, bar: str, value: float | None, unit: str, holds: bool, detail: str) -> Row:
    """An infinite value becomes None: never."""
    told = None if value is not None and math.isinf(value) else value
    return {"what": what, "bar": bar, "value": told, "unit": unit, "holds": holds, "detail": detail}


def text_of(row: Row) -> str:
    """A line for people."""
    value = "never" if row["value"] is None else f"{row['value']:.4g} {row['unit']}"
    return f"{'ok  ' if row['holds'] else 'MISS'} {row['what']}: {value} (bar {row['bar']}) {row['detail']}"


def printed(row: Row) -> Row:
    """The row, which stands on the terminal now."""
    print(text_of(row), flush=True)
    return row


def write_rows(rows: Sequence[Row], path: Path) -> None:
    """As JSON. OSError if that is not possible."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")


def exit_code(rows: Sequence[Row]) -> int:
    """0 if every bar holds, 1 otherwise. Without rows none does."""
    return 0 if rows and all(row["holds"] for row in rows) else 1
