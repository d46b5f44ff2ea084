"""The report on a record set: one HTML page that needs nothing else, the figures as PNG and the tables as CSV."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable, Iterable, Sequence

from matplotlib.figure import Figure

from mr_experiments.report import page
from mr_experiments.report.comparison import Comparison, compare_sets, comparison_table
from mr_experiments.report.coverage_figure import coverage_figure
from mr_experiments.report.figure_style import plt, to_svg, write_png
from mr_experiments.report.figures import finishing_figure, progress_figure
from mr_experiments.report.map_figure import map_figure
from mr_experiments.report.record_set import Chapter, RecordSet, load_records
from mr_experiments.report.scope import Scope, scopes
from mr_experiments.report.table import Table, to_csv
from mr_experiments.report.tables import chapter_tables, outcome_table, trials_table, trouble_table
from mr_experiments.trial.bound import bound_of
from mr_measures.lower_bound import LowerBound
from mr_sim.world import World
from mr_sim.world_model import load_world
from mr_sim.worlds import find_world

PAGE, TABLES, FIGURES = "report.html", "tables", "figures"


@dataclass(frozen=True)
class FigureText:
    name: str  # of its file, after the chapter
    title: str
    explanation: str
    of_paper: bool = False  # whether the figure has marks of the paper


PAPER_MARKS = " Dotted lines and circles are the paper's numbers, from its Table II b and its text."

MAP_TEXT = FigureText(
    "fig3-map",
    "Fig. 3: merged map with the local maps laid over it",
    "Final global map of one robot, its walls dark, in the world frame by the robot's true start pose. Each local map, "
    "placed by its own robot's true start pose, tints what it knows. Of the finished missions of a team size it shows "
    "the one whose largest map error is the median; where there is no reference to tell errors by, the middle one.",
)
PROGRESS_TEXT = FigureText(
    "fig4-progress",
    "Fig. 4: progress by area",
    "Free area known to the team, mean over the missions, over its reference value: the median at the end of the "
    "missions of one robot, or of all if there are none of one robot. A mission that is over keeps its last value. "
    "Vertical lines: mean T.",
    of_paper=True,
)
FINISHING_TEXT = FigureText(
    "fig5-finishing",
    "Fig. 5: when the robots finish",
    "Share of the robots that have declared their exploration finished by a time. Robots that never do keep the curve "
    "below 1. Vertical lines: mean T.",
    of_paper=True,
)
COVERAGE_TEXT = FigureText(
    "coverage",
    "Coverage against what no team could beat",
    "Share of the reference cells that the team knows. The grey area is out of reach for any strategy: the dashed line "
    "counts the cells that a robot at full speed could have had a look at if it had gone straight for them. Before the "
    "dotted line no team can have been everywhere it has to be to see all. Both come from the world alone.",
)

Progress = Callable[[str], None]  # told what is being made


def _silent(_: str) -> None:
    pass


@dataclass(frozen=True)
class Report:
    """What was made and where."""

    records: RecordSet
    page: Path
    figures: tuple[Path, ...]
    tables: tuple[Path, ...]
    comparison: Comparison | None
    notes: tuple[str, ...]  # what a reader must know to judge the numbers


@dataclass
class _Making:
    """A report while it is made."""

    out: Path
    progress: Progress
    figures: list[Path] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    tables: dict[str, list[tuple[Chapter | None, Table]]] = field(default_factory=dict)
    bounds: dict[str, LowerBound | None] = field(default_factory=dict)

    def add_table(self, table: Table, chapter: Chapter | None = None) -> str:
        """HTML of a table, which also goes to its CSV file."""
        self.tables.setdefault(table.name, []).append((chapter, table))
        return page.table(table)

    def keep_table(self, table: Table) -> None:
        """To its CSV file alone."""
        self.tables.setdefault(table.name, []).append((None, table))

    def add_figure(self, scope: Scope, text: FigureText, figure: Figure | None) -> str:
        """HTML of a figure, which is also written as PNG; empty if there is none."""
        if figure is None:
            return ""
        name = f"{scope.chapter.slug}-{text.name}"
        path = self.out / FIGURES / f"{name}.png"
        write_png(figure, path)
        self.figures.append(path)
        svg = to_svg(figure, name, f"{text.title}, {scope.chapter.title}")
        plt.close(figure)
        beside_paper = scope.beside_paper and text.of_paper
        return page.figure(svg, text.title, text.explanation + (PAPER_MARKS if beside_paper else ""))

    def bound(self, world: str) -> LowerBound | None:
        """Of a world, computed once; None with a note when it cannot be."""
        if world not in self.bounds:
            self.progress(f"lower bound for {world}")
            try:
                self.bounds[world] = bound_of(World(load_world(find_world(world))))
            except (OSError, ValueError) as error:
                self.notes.append(f"No lower bound on the time for {world}: {error}")
                self.bounds[world] = None
        return self.bounds[world]

    def write_tables(self) -> list[Path]:
        folder = self.out / TABLES
        folder.mkdir(parents=True, exist_ok=True)
        paths = []
        for name, tables in self.tables.items():
            paths.append(folder / f"{name}.csv")
            paths[-1].write_text(to_csv(tables), encoding="utf-8")
        return paths


def make_report(
    folder: str | Path,
    out: str | Path,
    against: str | Path | None = None,
    across: Sequence[str] = (),
    with_bound: bool = True,
    progress: Progress = _silent,
) -> Report:
    """Write `report.html`, `figures/*.png` and `tables/*.csv` into `out`.

    Args:
        folder: of the records, as the runner wrote them.
        out: created if needed.
        against: folder of other records to compare with.
        across: keys in which the two sets may differ (`comparison.ACROSS`).
        with_bound: whether to compute the lower bound from the world, which takes seconds.
        progress: called with each step.

    Raises RecordError for records that cannot be used.
    """
    progress("reading records")
    records = load_records(folder)
    comparison = compare_sets(records, load_records(against), across) if against is not None else None
    making = _Making(Path(out), progress)
    making.notes += [*_lost(records), *records.mixed_settings()]
    if comparison:
        other = [*_lost(comparison.baseline), *comparison.baseline.mixed_settings()]
        making.notes += [*(f"Other set, {note}" for note in other), *comparison.notes]
    parts = scopes(records)
    chapters = [_chapter_section(scope, making, with_bound) for scope in parts]
    body = [
        page.heading(1, "Missions"),
        page.paragraph(_introduction(records)),
        page.contents(_contents(parts, comparison)),
        _outcome_section(records, making),
        *chapters,
        comparison_section(comparison, making) if comparison else "",
        _origin_section(records, making.notes),
    ]
    making.out.mkdir(parents=True, exist_ok=True)
    path = making.out / PAGE
    path.write_text(page.page(f"Report on {records.folder.resolve().name}", "\n".join(body)), encoding="utf-8")
    tables = making.write_tables()
    return Report(records, path, tuple(making.figures), tuple(tables), comparison, tuple(making.notes))


def _lost(records: RecordSet) -> list[str]:
    if not records.lost:
        return []
    lost = len(records.lost)
    were = "was begun, and nothing is known of it" if lost == 1 else "were begun, and nothing is known of them"
    return [f"{counted(lost, 'more mission')} {were}: {', '.join(records.lost)}"]


def comparison_section(comparison: Comparison, making: _Making) -> str:
    names = f"{comparison.candidate.folder.name} against {comparison.baseline.folder.name}"
    table = making.add_table(comparison_table(comparison))
    return page.heading(2, f"Comparison: {names}", "comparison") + table


def counted(number: int, what: str) -> str:
    return f"{number} {what}{'s' * (number != 1)}"


def _introduction(records: RecordSet) -> str:
    counts = records.counts
    total = len(records.records)
    lost = f", and {len(records.lost)} more of which nothing is known" if records.lost else ""
    return (
        f"{counted(total, 'mission')}: {counts['finished']} finished, {counts['unfinished']} unfinished, "
        f"{counts['failed']} failed{lost}. Failed missions enter the counts only; unfinished ones enter everything but "
        "the exploration time, which they do not have. Numbers headed by 0.05 and 0.95 are quantiles. R is the number "
        "of robots."
    )


def _contents(parts: Iterable[Scope], comparison: Comparison | None) -> list[tuple[str, str]]:
    entries = [("outcomes", "Outcomes"), *((scope.chapter.slug, scope.chapter.title) for scope in parts)]
    return [*entries, *([("comparison", "Comparison")] if comparison else []), ("origin", "Origin of the numbers")]


def _outcome_section(records: RecordSet, making: _Making) -> str:
    making.keep_table(trials_table(records))
    trouble = trouble_table(records)
    tables = [outcome_table(records), *([trouble] if trouble.rows else [])]
    return '<section id="outcomes">' + "".join(making.add_table(table) for table in tables) + "</section>"


def _chapter_section(scope: Scope, making: _Making, with_bound: bool) -> str:
    making.progress(scope.chapter.title)
    error, distance, time, *others = [making.add_table(table, scope.chapter) for table in chapter_tables(scope)]
    figures = [
        making.add_figure(scope, MAP_TEXT, map_figure(scope)),
        making.add_figure(scope, PROGRESS_TEXT, progress_figure(scope)),
        making.add_figure(scope, FINISHING_TEXT, finishing_figure(scope)),
        making.add_figure(scope, COVERAGE_TEXT, _coverage(scope, making, with_bound)),
    ]
    title = page.heading(2, scope.chapter.title, scope.chapter.slug)
    return "\n".join([title, error, distance, time, *figures, *others])


def _coverage(scope: Scope, making: _Making, with_bound: bool) -> Figure | None:
    bound = making.bound(scope.chapter.world) if with_bound else None
    try:
        return coverage_figure(scope, bound)
    except ValueError as error:
        making.notes.append(f"No lower bound on the time for {scope.chapter.title}: {error}")
        return coverage_figure(scope, None)


def _origin_section(records: RecordSet, notes: Sequence[str]) -> str:
    versions = sorted({f"{name} {value}" for record in records.records for name, value in record.versions.items()})
    hosts = sorted({record.measured.host for record in records.records} - {""})
    sentences = [*notes, f"Versions: {', '.join(versions) or 'not recorded'}."]
    if hosts:
        sentences.append(f"Computed on: {', '.join(hosts)}.")
    sentences.append(
        "Paper: Andre, Neuhold and Bettstetter, Coordinated Multi-Robot Exploration: Out of the Box Packages for "
        "ROS, 2014; 40 missions for each team size in Stage, on a map of the same size and with error-free "
        "communication."
    )
    return page.heading(2, "Origin of the numbers", "origin") + page.notes(sentences)
