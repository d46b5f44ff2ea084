"""Rows of a benchmark: what was measured, against which bar."""

from __future__ import annotations

import json
from pathlib import Path


class Rows:
    """Each row is printed and written as it comes, so that a run which is interrupted keeps what it has.

    `file`: for the rows as JSON, a list of {what, bar, value, unit, holds, detail}; None for no file.
    """

    def __init__(self, file: Path | None):
        self._file = file
        self._rows: list[dict[str, object]] = []

    def add(self, row: dict[str, object]) -> None:
        """Takes the row and replaces the file at once, so that it is whole at any moment."""
        print(
            f"{'ok  ' if row['holds'] else 'MISS'} {row['what']}: {row['value']} {row['unit']} (bar {row['bar']}) "
            f"{row['detail']}",
            flush=True,
        )
        self._rows.append(row)
        if self._file is None:
            return
        self._file.parent.mkdir(parents=True, exist_ok=True)
        new = self._file.with_name(self._file.name + ".new")
        new.write_text(json.dumps(self._rows, indent=2) + "\n", encoding="utf-8")
        new.replace(self._file)

    def status(self) -> int:
        """What the program ends with: 1 when a bar was missed."""
        return 0 if all(row["holds"] for row in self._rows) else 1
