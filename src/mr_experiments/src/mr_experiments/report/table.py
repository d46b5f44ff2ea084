"""A table as plain data: for the page, the terminal and CSV."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from typing import Iterable, Union

from mr_experiments.report.record_set import Chapter

Cell = Union[str, float, int, None]

NOTHING = "\N{EN DASH}"  # shown for what does not exist
SIGNIFICANT = -1


@dataclass(frozen=True)
class Column:
    """`name` heads the column of the CSV; `label` and `group` (a heading over several columns) are for people.

    `digits`: after the point, or SIGNIFICANT; whole numbers and text need none. `text` is set to the left.
    """

    name: str
    label: str
    digits: int = 0
    group: str = ""
    text: bool = False


@dataclass(frozen=True)
class Table:
    name: str  # of the CSV file
    title: str
    explanation: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def column(self, name: str) -> list[Cell]:
        index = [column.name for column in self.columns].index(name)
        return [row[index] for row in self.rows]


def shown(value: Cell, column: Column) -> str:
    """A cell as people read it."""
    if value is None:
        return NOTHING
    if isinstance(value, str):
        return value
    digits = _digits(value) if column.digits == SIGNIFICANT else column.digits
    text = f"{value:,.{digits}f}"
    return text[1:] if text.startswith("-") and not any(c in "123456789" for c in text) else text


def _digits(value: float) -> int:
    """After the point, to show four figures that count, but no more than four of them."""
    return 0 if value == 0.0 else min(4, max(0, 3 - math.floor(math.log10(abs(value)))))


def to_csv(tables: Iterable[tuple[Chapter | None, Table]]) -> str:
    """Tables as one, with the columns of all of them; each row is led by its chapter where it has one."""
    header: list[str] = []
    rows: list[dict[str, Cell]] = []
    for chapter, table in tables:
        lead = {} if chapter is None else vars(chapter)
        names = [column.name for column in table.columns]
        rows.extend({**lead, **dict(zip(names, map(_plain, row)))} for row in table.rows)
        header = list(dict.fromkeys([*header, *lead, *names]))
    out = io.StringIO()
    writer = csv.DictWriter(out, header, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return out.getvalue()


def _plain(cell: Cell) -> Cell:
    """Without the noise that sums of decimal fractions end in."""
    return float(f"{cell:.6g}") if isinstance(cell, float) and abs(cell) < 1e6 else cell
