"""Command line of `rosrun mr_experiments report`."""

from __future__ import annotations

import argparse
import os
import sys
from dataclasses import replace
from itertools import compress, groupby
from pathlib import Path
from typing import Sequence

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table as RichTable

from mr_experiments.common.command_line import BAD_CALL, INTERRUPTED, CallError, Parser
from mr_experiments.report.comparison import ACROSS, Comparison, comparison_table, explanation
from mr_experiments.report.paper_tables import distance_table, exploration_time_table, map_error_table
from mr_experiments.report.report import FIGURES, TABLES, Report, make_report
from mr_experiments.report.scope import scopes
from mr_experiments.report.table import Table, shown
from mr_experiments.report.tables import outcome_table, trouble_table
from mr_measures.record.files import RecordError

NARROWEST = 110  # characters of a line when the output goes to a file
VERDICT_STYLES = {"better": "green", "worse": "yellow"}


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="report",
        description="Tables and figures from the records of trials: the paper's Tables I and II and Figs. 3 to 5 "
        "beside its own numbers, and more. Writes report.html (one file that needs no network), figures/*.png and "
        "tables/*.csv.",
        epilog="Exit code: 0 done, 2 bad options or records, 130 interrupted. "
        "Example: rosrun mr_experiments report out/now --against out/before",
    )
    add = parser.add_argument
    add("records", metavar="RECORDS", help="folder of records (*.json) that `rosrun mr_experiments run` wrote")
    add(
        "--against",
        metavar="OTHER",
        help="compare with this folder of records; trials of equal world, scenario, strategy, team size and seed make "
        "a pair",
    )
    add(
        "--across",
        nargs="+",
        choices=ACROSS,
        default=[],
        metavar="KEY",
        help=f"with --against: pair trials that differ in this ({', '.join(ACROSS)}); to compare strategies, say",
    )
    add("--out", metavar="DIR", help="folder to write to (default: RECORDS/report)")
    add("--no-bound", dest="bound", action="store_false", help="leave out the lower bound computed from the world")
    return parser


def main(arguments: Sequence[str]) -> int:
    """Make a report; returns the exit code."""
    console = Console(highlight=False, emoji=False, width=None if sys.stdout.isatty() else NARROWEST)
    try:
        options = make_parser().parse_args(arguments)
        if options.across and not options.against:
            raise CallError("--across needs --against")
        out = Path(options.out) if options.out else Path(options.records) / "report"
        with console.status("") as status:
            report = make_report(
                options.records,
                out,
                options.against,
                options.across,
                options.bound,
                lambda step: status.update(f"{escape(step)} ..."),
            )
    except (CallError, RecordError) as error:
        print(f"report: {error}", file=sys.stderr)
        return BAD_CALL
    except OSError as error:
        print(f"report: cannot write {error.filename or out}: {error.strerror}", file=sys.stderr)
        return BAD_CALL
    except KeyboardInterrupt:
        print("report: interrupted, the report is not complete", file=sys.stderr)
        return INTERRUPTED
    try:
        print_summary(report, console)
    except BrokenPipeError:  # as when piped into `head`; what follows at exit must not complain again
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 0


def print_summary(report: Report, console: Console) -> None:
    """The most important tables and where the files are."""
    print_table(console, outcome_table(report.records))
    trouble = trouble_table(report.records)
    if trouble.rows:
        print_table(console, trouble)
    for scope in scopes(report.records):
        console.rule(escape(scope.chapter.title))
        for make in (map_error_table, distance_table, exploration_time_table):
            print_table(console, without(make(scope), ("_low", "_high", "_without_error")))
    if report.comparison is not None:
        print_comparison(console, report.comparison)
    for note in report.notes:
        console.print(f"Note: {escape(note)}")
    folder = report.page.parent
    for place in (report.page, folder / FIGURES, folder / TABLES):
        console.print(escape(str(place)), soft_wrap=True)


def print_comparison(console: Console, comparison: Comparison) -> None:
    """One small table per group."""
    console.rule("Comparison")
    console.print(escape(explanation(comparison)))
    for group, rows in groupby(comparison.rows, key=lambda row: row.group):
        named = [f"{key} {value}" for key, value in zip(comparison.keys, group)]
        table = comparison_table(replace(comparison, rows=tuple(rows)))
        print_table(console, replace(without(table, comparison.keys), title=", ".join(named)))


def without(table: Table, endings: Sequence[str]) -> Table:
    """A table without the columns whose names end in one of these."""
    kept = [not column.name.endswith(tuple(endings)) for column in table.columns]
    rows = tuple(tuple(compress(row, kept)) for row in table.rows)
    return replace(table, columns=tuple(compress(table.columns, kept)), rows=rows)


def print_table(console: Console, table: Table) -> None:
    drawn = RichTable(title=escape(table.title), title_justify="left", title_style="bold", padding=(0, 1, 0, 0))
    drawn.box = box.SIMPLE_HEAD
    groups = [column.group for column in table.columns]
    for column, before in zip(table.columns, ["", *groups]):
        head = f"{column.group if column.group != before else ''}\n{column.label}" if any(groups) else column.label
        drawn.add_column(escape(head), justify="left" if column.text else "right")
    for row in table.rows:
        drawn.add_row(*(_cell(shown(value, column)) for value, column in zip(row, table.columns)))
    console.print(drawn)


def _cell(text: str) -> str:
    style = VERDICT_STYLES.get(text)
    return f"[{style}]{text}[/{style}]" if style else escape(text)
