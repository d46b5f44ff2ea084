"""Parts of a self-contained HTML page."""

from __future__ import annotations

import html
from itertools import groupby
from typing import Sequence

from mr_experiments.report.table import Cell, Column, Table, shown

CSS = """
:root { color-scheme: light dark; --ink: #1b1f23; --soft: #5b636e; --line: #d5d9de; --page: #fff; --band: #f5f6f8;
  --good: #00694d; --bad: #a34700; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e7eb; --soft: #9aa3ad; --line: #3a414a; --page: #15181c;
  --band: #1e2227; --good: #4fc79d; --bad: #f0995a; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2.5rem 1.25rem 5rem; max-width: 62rem; background: var(--page); color: var(--ink);
  font: 1rem/1.55 system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .4rem; }
h2 { font-size: 1.4rem; margin: 3.2rem 0 .6rem; padding-top: 1rem; border-top: 2px solid var(--ink); }
h3 { font-size: 1.08rem; margin: 2.2rem 0 .3rem; }
p { margin: .3rem 0 .8rem; max-width: 46rem; }
p.soft, nav, figcaption, footer { color: var(--soft); }
nav ul { margin: .3rem 0 0; padding-left: 1.2rem; }
a { color: inherit; text-underline-offset: .15em; }
ul.notes { padding-left: 1.2rem; max-width: 46rem; }
.scroll { overflow-x: auto; margin: .6rem 0 1rem; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { padding: .28rem .7rem; text-align: right; white-space: nowrap; }
th.text, td.text { text-align: left; }
td.text { white-space: normal; }
thead th { font-weight: 600; vertical-align: bottom; }
thead tr.groups th { text-align: center; border-bottom: 1px solid var(--line); color: var(--soft); font-weight: 500; }
thead tr:last-child th { border-bottom: 1.5px solid var(--ink); }
tbody tr:nth-child(even) { background: var(--band); }
tbody tr:last-child td { border-bottom: 1px solid var(--line); }
.edge { padding-left: 1.6rem; }
.better { color: var(--good); font-weight: 600; } .worse { color: var(--bad); font-weight: 600; }
figure { margin: .6rem 0 1.4rem; } figure svg { width: 100%; height: auto; max-width: 60rem; }
figure svg image { image-rendering: pixelated; }
figure svg text { font-family: system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif !important; }
@media print { body { max-width: none; } figure, table { break-inside: avoid; } }
"""


def page(title: str, body: str) -> str:
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{html.escape(title)}</title>\n<style>{CSS}</style>\n</head>\n<body>\n{body}\n</body>\n</html>\n"
    )


def heading(level: int, text: str, anchor: str = "") -> str:
    place = f' id="{html.escape(anchor)}"' if anchor else ""
    return f"<h{level}{place}>{html.escape(text)}</h{level}>"


def paragraph(text: str) -> str:
    return f"<p>{html.escape(text)}</p>"


def notes(sentences: Sequence[str]) -> str:
    items = "".join(f"<li>{html.escape(sentence)}</li>" for sentence in sentences)
    return f'<ul class="notes">{items}</ul>' if items else ""


def contents(entries: Sequence[tuple[str, str]]) -> str:
    """Links to (anchor, text)."""
    items = "".join(f'<li><a href="#{html.escape(anchor)}">{html.escape(text)}</a></li>' for anchor, text in entries)
    return f"<nav>Contents<ul>{items}</ul></nav>"


def figure(svg: str, title: str, explanation: str) -> str:
    return heading(3, title) + paragraph(explanation) + f"<figure>{svg}</figure>"


def table(data: Table) -> str:
    title = heading(3, data.title) + paragraph(data.explanation)
    rows = "".join(f"<tr>{_cells(data.columns, row)}</tr>" for row in data.rows)
    return f'{title}<div class="scroll"><table><thead>{_head(data.columns)}</thead><tbody>{rows}</tbody></table></div>'


def _head(columns: Sequence[Column]) -> str:
    labels = "".join(
        f'<th scope="col" class="{_kind(columns, index)}">{html.escape(column.label)}</th>'
        for index, column in enumerate(columns)
    )
    if not any(column.group for column in columns):
        return f"<tr>{labels}</tr>"
    groups = "".join(_group_head(name, len(list(g))) for name, g in groupby(columns, key=lambda column: column.group))
    return f'<tr class="groups">{groups}</tr><tr>{labels}</tr>'


def _group_head(name: str, count: int) -> str:
    return f'<th colspan="{count}" class="edge">{html.escape(name)}</th>' if name else "<td></td>" * count


def _cells(columns: Sequence[Column], row: Sequence[Cell]) -> str:
    return "".join(_cell(columns, index, value) for index, value in enumerate(row))


def _cell(columns: Sequence[Column], index: int, value: Cell) -> str:
    text = shown(value, columns[index])
    verdict = text if text in ("better", "worse") else ""
    return f'<td class="{_kind(columns, index)} {verdict}">{html.escape(text)}</td>'


def _kind(columns: Sequence[Column], index: int) -> str:
    """Text is set to the left; the first column of each group stands apart."""
    column = columns[index]
    first = index > 0 and column.group != columns[index - 1].group
    return " ".join(["text"] * column.text + ["edge"] * first)
