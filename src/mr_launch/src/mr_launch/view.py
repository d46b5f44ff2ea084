"""What people see while a team runs: a live table on a terminal, plain lines elsewhere."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass

from rich.console import Console, Group
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

PLAIN_PERIOD = 5.0  # s between two plain reports
COLOURS = ("bright_red", "bright_blue", "bright_green", "bright_yellow", "bright_magenta", "bright_cyan")


@dataclass(frozen=True)
class RobotRow:
    """One robot's line. ``coverage`` is a share or None while unknown, ``explored`` in m^2, ``distance`` in m."""

    name: str
    state: str
    coverage: float | None
    explored: float
    distance: float
    goal: tuple[float, float] | None
    neighbors: list[str]
    merged: list[str]
    text: str


@dataclass(frozen=True)
class Picture:
    """The state of the whole team. ``elapsed`` and ``limit`` in s of simulation time."""

    phase: str
    elapsed: float
    limit: float
    real_time_factor: float | None
    robots: list[RobotRow]

    @property
    def coverage(self) -> float | None:
        return max((row.coverage for row in self.robots if row.coverage is not None), default=None)

    @property
    def lacks_reference(self) -> bool:
        """There are maps, and not yet what they are compared with."""
        return any(row.coverage is None and row.explored > 0.0 for row in self.robots)


def explored(row: RobotRow) -> str:
    """The share if it is known, else the area."""
    if row.coverage is not None:
        return percent(row.coverage)
    return f"{row.explored:.0f} m^2" if row.explored > 0.0 else "nothing yet"


def percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.1f} %"


def listed(names: list[str]) -> str:
    return ", ".join(names) or "nobody"


def short(names: list[str]) -> str:
    return ", ".join(name.replace("robot_", "") for name in names) or "-"


def header(picture: Picture) -> str:
    factor = "" if picture.real_time_factor is None else f", real-time factor {picture.real_time_factor:.2f}"
    lack = ", no shares yet: the reference of the world is still being computed" if picture.lacks_reference else ""
    return f"{picture.phase}, {max(0, round(picture.elapsed))} s of {picture.limit:.0f} s{factor}{lack}"


def place(goal: tuple[float, float]) -> str:
    x, y = (round(value, 1) + 0.0 for value in goal)  # no "-0.0"
    return f"({x}, {y})"


def plain_lines(picture: Picture) -> list[str]:
    lines = [header(picture)]
    for row in picture.robots:
        goal = "no goal" if row.goal is None else f"goal {place(row.goal)}"
        lines.append(
            f"  {row.name}: {row.state}, explored {explored(row)}, {row.distance:.1f} m, {goal}, "
            f"neighbours {listed(row.neighbors)}, merged with {listed(row.merged)}"
        )
    return lines


def live_table(picture: Picture) -> Group:
    table = Table(expand=False, pad_edge=False, box=None, header_style="bold")
    for title in ("robot", "state", "explored", "distance", "goal", "neighbours", "merged"):
        table.add_column(title, justify="right" if title in ("explored", "distance") else "left")
    for index, row in enumerate(picture.robots):
        goal = "-" if row.goal is None else place(row.goal)
        table.add_row(
            Text(row.name, style=COLOURS[index % len(COLOURS)]),
            Text(row.state, style="green" if row.state == "finished" else ""),
            explored(row),
            f"{row.distance:.1f} m",
            goal,
            short(row.neighbors),
            short(row.merged),
        )
    bar = Table.grid(padding=(0, 1))
    if picture.coverage is not None:
        bar.add_row("explored", ProgressBar(total=1.0, completed=picture.coverage, width=50), percent(picture.coverage))
    notes = [Text(f"{row.name}: {row.text}", style="dim") for row in picture.robots if row.text]
    return Group(Text(header(picture), style="bold"), table, bar, *notes)


class View:
    """Shows pictures as they come. Use as a context; ``notice`` prints one line that stays."""

    def __init__(self, quiet: bool) -> None:
        self._console = Console(soft_wrap=True, emoji=False)
        self._quiet = quiet
        self._next_plain = 0.0
        self._phase = ""
        live = sys.stdout.isatty() and not quiet
        self._live = Live(console=self._console, refresh_per_second=4, transient=True) if live else None

    def __enter__(self) -> View:
        if self._live:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.pause()

    def pause(self) -> None:
        """End the live part; later notices are plain lines."""
        if self._live:
            self._live.stop()
            self._live = None

    def notice(self, text: str) -> None:
        self._console.print(text, markup=False, highlight=False)

    def show(self, picture: Picture) -> None:
        if self._live:
            self._live.update(live_table(picture))
        elif not self._quiet and (time.monotonic() >= self._next_plain or picture.phase != self._phase):
            self._phase = picture.phase
            self._next_plain = time.monotonic() + PLAIN_PERIOD
            for line in plain_lines(picture):
                self.notice(line)
