"""Figures in Markdown that come from result files: what stands between two markers is written anew from a CSV.

    <!-- published: table data/explore.csv what="What" "value=Value|.2f" where holds=True -->
    ...
    <!-- end -->
    T of four robots is <!-- published: value data/paper.csv mean|.0f where robots=4 -->104<!-- end --> s.
    <!-- published: origin data/paper.csv -->Measured on 2026-11-27, code 0123abcd.<!-- end -->

A table of a CSV that tells its origin is followed by that line; `origin` writes it by itself. A column is NAME,
NAME=HEADING or NAME=HEADING|FORMAT with a format of Python; `where` keeps the rows whose columns have these values.
"""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from typing import Callable, Mapping, Sequence

from mr_experiments.publish.origin import line_of

MARKED = re.compile(r"(<!-- published: (.*?) -->)(.*?)(<!-- end -->)", re.DOTALL)
EMPTY = "\N{EN DASH}"

Row = Mapping[str, str]
Read = Callable[[str], Sequence[Row]]
"""Rows of the CSV of that name, relative to the page."""


class PublishError(ValueError):
    """A marker that cannot be filled; the text names its line."""


@dataclass(frozen=True)
class _Column:
    name: str
    heading: str
    form: str

    def shown(self, row: Row) -> str:
        text = row[self.name]
        if not text:
            return EMPTY
        return format(float(text), self.form) if self.form else text


def render(page: str, read: Read) -> str:
    """The page with what its markers ask for. Raises PublishError."""
    parts, end = [], 0
    for found in MARKED.finditer(page):
        line = page.count("\n", 0, found.start()) + 1
        try:
            text = _filled(found.group(2), read)
        except PublishError as error:
            raise PublishError(f"line {line}: {error}") from None
        parts += [page[end : found.end(1)], text, found.group(4)]
        end = found.end()
    rest = page[end:]
    if "<!-- published:" in rest:
        line = page.count("\n", 0, end + rest.index("<!-- published:")) + 1
        raise PublishError(f"line {line}: no <!-- end --> after the marker")
    return "".join([*parts, rest])


def _filled(asked: str, read: Read) -> str:
    try:
        kind, file, *words = shlex.split(asked)
    except ValueError as error:
        raise PublishError(f"cannot read {asked!r}: {error}") from None
    split = words.index("where") if "where" in words else len(words)
    columns, rows = [_column(word) for word in words[:split]], read(file)
    wanted = dict(_condition(word) for word in words[split + 1 :])
    for name in [*(column.name for column in columns), *wanted]:
        if rows and name not in rows[0]:
            raise PublishError(f"{file} has no column {name}, but {', '.join(rows[0])}")
    kept = [row for row in rows if all(row[name] == value for name, value in wanted.items())]
    if kind == "table":
        return _table(columns, kept)
    if kind == "origin" and not columns:
        return line_of(kept)
    if kind != "value" or len(columns) != 1:
        raise PublishError(f"{asked!r} is neither a table, an origin nor the value of one column")
    if len(kept) != 1:
        raise PublishError(f"{len(kept)} rows of {file} are so; a value needs one")
    return columns[0].shown(kept[0])


def _column(word: str) -> _Column:
    head, _, form = word.partition("|")
    name, _, heading = head.partition("=")
    return _Column(name, heading or name, form)


def _condition(word: str) -> tuple[str, str]:
    name, equals, value = word.partition("=")
    if not equals:
        raise PublishError(f"{word!r} behind `where` is no COLUMN=VALUE")
    return name, value


def _table(columns: Sequence[_Column], rows: Sequence[Row]) -> str:
    lines = [[column.heading for column in columns], ["---"] * len(columns)]
    lines += [[column.shown(row) for column in columns] for row in rows]
    origin = line_of(rows)
    table = "\n".join("| " + " | ".join(line) + " |" for line in lines)
    return f"\n\n{table}\n\n" + (f"{origin}\n\n" if origin else "")
