"""Trials that run, on a terminal or in a log."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import Callable, Generator, Sequence, cast

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from mr_experiments.sweep.sweep import Done, Runner
from mr_experiments.trial.trial import Trial


def line_of(entry: Done) -> str:
    """How long the mission took, or why not."""
    time, factor = entry.exploration_time, entry.real_time_factor
    told = f"{time:.1f} s" if time is not None else f"{entry.status}: {entry.reason}"
    return f"{entry.trial.key}: {told}" + (f"  ({factor:.1f} x real time)" if factor else "")


def follow(
    runner: Runner, left: Sequence[Trial], folder: Path, console: Console, line: Callable[[Done], str] = line_of
) -> list[Done]:
    """Runs the trials, writes their records into the folder and tells on the console how it goes; `line`: of one that
    is done."""
    done = []
    columns = (BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn(),
               TextColumn("{task.description}"))  # fmt: skip
    # Without a refreshing thread: processes are forked meanwhile.
    with Progress(*columns, console=console, auto_refresh=False, disable=not console.is_terminal) as progress:
        task = progress.add_task("", total=len(left))
        last_trouble = ""

        def tell(running: int, trouble: str) -> None:
            nonlocal last_trouble
            if trouble and trouble != last_trouble:
                progress.console.print(trouble, highlight=False, markup=False)
            last_trouble = trouble
            progress.update(task, description="" if trouble else f"({running} running)", refresh=True)

        # Closed here, so that trials end before anything is said about an interruption.
        with closing(cast("Generator[Done, None, None]", runner.run(left, folder, tell))) as results:
            for entry in results:
                done.append(entry)
                progress.update(task, advance=1, refresh=True)
                progress.console.print(line(entry), highlight=False, markup=False)
    return done
