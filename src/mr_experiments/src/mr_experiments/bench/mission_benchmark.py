"""How the commands of benchmarks of missions begin and end. Options and rows are theirs."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Callable, Iterable, Sequence

from rich.console import Console

from mr_experiments.bench.rows import Row, exit_code, text_of, write_rows
from mr_experiments.common.command_line import BAD_CALL, INTERRUPTED, CallError
from mr_experiments.sweep.sweep import default_jobs
from mr_experiments.trial.trial import TrialError

EXIT_CODES = "Exit code: 0 every bar holds, 1 some do not, 2 bad call, 130 interrupted."


def add_seed_and_jobs(parser: argparse.ArgumentParser, first_seed: int) -> None:
    parser.add_argument("--first-seed", type=int, default=first_seed, metavar="S", help="(default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=default_jobs(), metavar="N", help="missions at a time (default: "
                        "the cores, %(default)s)")  # fmt: skip


def run_benchmark(
    parser: argparse.ArgumentParser, run: Callable[[argparse.Namespace, Console], int], arguments: Sequence[str]
) -> int:
    """The exit code: that of `run`, or why it did not come to its end."""
    try:
        console = Console(soft_wrap=True, emoji=False, width=None if sys.stdout.isatty() else 120)
        return run(parser.parse_args(arguments), console)
    except (CallError, TrialError, OSError) as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return BAD_CALL
    except KeyboardInterrupt:
        print(f"{parser.prog}: interrupted; the same command goes on from here", file=sys.stderr)
        return INTERRUPTED


def check_least(options: argparse.Namespace, **least: int) -> None:
    """CallError for an option that is below its least value."""
    for name, value in least.items():
        if getattr(options, name) < value:
            raise CallError(f"--{name.replace('_', '-')} {getattr(options, name)} must be at least {value}")


def tell(rows: Iterable[Row], console: Console) -> None:
    """A line for each."""
    for row in rows:
        console.print(text_of(row), highlight=False, markup=False)


def conclude(rows: Sequence[Row], path: Path) -> int:
    """Writes the rows; the exit code."""
    write_rows(rows, path)
    return exit_code(rows)
