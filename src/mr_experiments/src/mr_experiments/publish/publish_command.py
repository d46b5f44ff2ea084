"""Command line of `rosrun mr_experiments publish`."""

from __future__ import annotations

import argparse
import csv
import json
import sys
from pathlib import Path
from typing import Any, Mapping, Sequence

from mr_experiments.bench.explore_missions import read_rows
from mr_experiments.common.command_line import BAD_CALL, CallError, Parser
from mr_experiments.publish.mission_table import mission_rows, world_rows
from mr_experiments.publish.origin import with_origin
from mr_experiments.publish.published import PublishError, render
from mr_experiments.report.record_set import is_record, load_record, load_records, refuse_doubles
from mr_experiments.report.stack_missions import is_of_stack
from mr_measures.record.files import RecordError
from mr_measures.record.mission_record import MissionRecord

Row = Mapping[str, Any]


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="publish",
        description="Results for the documentation: tables as CSV from records or from the rows of a benchmark, and "
        "pages whose marked figures are written anew from such tables. A table keeps when it was measured, by the "
        "files that it is made from, and the commit that was there then.",
        epilog="Exit code: 0 done, 1 with --check: a page is out of date, 2 bad options or files. "
        "Example: rosrun mr_experiments publish missions out/paper docs/results/data/paper.csv",
    )
    commands = parser.add_subparsers(dest="command", required=True, parser_class=Parser, metavar="COMMAND")
    for name, about, source in (
        ("missions", "one row for each kind of mission in folders of records", "DIR"),
        ("worlds", "one row for each kind of world in the missions of bench explore", "FILE.jsonl"),
        ("bench", "the rows of a benchmark, or of the latest comparison of agreement", "FILE.json"),
    ):
        add = commands.add_parser(name, help=about, description=f"Writes {about}.").add_argument
        add("sources", nargs="+", metavar=source)
        add("table", metavar="TABLE.csv", help="file to write")
        if name == "bench":
            add("--update", action="store_true", help="leave the other rows of the table as they are")
    pages = commands.add_parser("pages", help="write the marked figures of pages anew")
    pages.add_argument("pages", nargs="+", metavar="PAGE.md")
    pages.add_argument("--check", action="store_true", help="write nothing; name the pages that are out of date")
    return parser


def main(arguments: Sequence[str]) -> int:
    """Publish; returns the exit code."""
    try:
        options = make_parser().parse_args(arguments)
        if options.command == "pages":
            return publish_pages([Path(page) for page in options.pages], options.check)
        makers = {"missions": _of_missions, "worlds": _of_worlds, "bench": _of_bench}
        rows: Sequence[Row] = makers[options.command](options.sources)
        if options.command == "bench" and options.update:
            rows = updated(read_table(Path(options.table)), rows)
        write_table(Path(options.table), rows)
    except (CallError, PublishError) as error:
        print(f"publish: {error}", file=sys.stderr)
        return BAD_CALL
    except OSError as error:
        print(f"publish: {error.filename or options.table}: {error.strerror}", file=sys.stderr)
        return BAD_CALL
    return 0


def publish_pages(pages: Sequence[Path], check: bool) -> int:
    stale = []
    for page in pages:
        before = page.read_text(encoding="utf-8")
        try:
            after = render(before, lambda name, page=page: read_table(page.parent / name))  # type: ignore[misc]
        except PublishError as error:
            raise PublishError(f"{page}, {error}") from None
        if after != before:
            stale.append(page)
            if not check:
                page.write_text(after, encoding="utf-8")
    if check:
        for page in stale:
            print(f"{page} is out of date: rosrun mr_experiments publish pages {page}")
    return 1 if check and stale else 0


def read_table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def updated(before: Sequence[Row], rows: Sequence[Row]) -> list[Row]:
    """The rows of before; of those measured anew, by `what`, what was measured; what is new behind them."""
    new = {str(row["what"]): row for row in rows}
    kept = [new.pop(str(row["what"]), row) for row in before]
    return kept + list(new.values())


def write_table(path: Path, rows: Sequence[Row]) -> None:
    """Numbers with six figures; nothing for None."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows({name: _cell(value) for name, value in row.items()} for row in rows)


def _cell(value: Any) -> Any:
    return f"{value:.6g}" if isinstance(value, float) else "" if value is None else value


def _of_missions(folders: Sequence[str]) -> list[dict[str, Any]]:
    try:
        found = [pair for folder in map(Path, folders) for pair in _records(folder)]
        paths = [path for path, _ in found]
        if len(set(paths)) < len(paths):
            raise RecordError(f"{next(path for path in paths if paths.count(path) > 1)} is given twice")
        refuse_doubles(dict(found))
        records = [record for _, record in found]
    except RecordError as error:
        raise CallError(str(error)) from None
    if not records:
        raise CallError(f"no records of missions in {', '.join(folders)}")
    return with_origin(mission_rows(records), [path for folder in folders for path in Path(folder).rglob("*.json")])


def _records(folder: Path) -> list[tuple[Path, MissionRecord]]:
    """Of missions of the ROS stack below the folder, all that were begun, each under a path of its own; else of its own
    files those that are records. Raises RecordError."""
    if is_of_stack(folder):
        found = load_records(folder)
        if found.lost:
            raise RecordError(f"nothing is known of {', '.join(found.lost)}: no row can count them; remove them")
        return [(folder.resolve() / str(number), record) for number, record in enumerate(found.records)]
    documents = {path: _json(path) for path in sorted(folder.glob("*.json"))}
    others = [path for path, each in documents.items() if not is_record(each)]
    if others:
        print(f"publish: no records of missions, passed over: {', '.join(map(str, others))}", file=sys.stderr)
    return [(path.resolve(), load_record(path)) for path in documents if path not in others]


def _of_worlds(files: Sequence[str]) -> list[dict[str, Any]]:
    rows = [row for file in files for row in read_rows(Path(file))]
    if not rows:
        raise CallError(f"no missions in {', '.join(files)}")
    return with_origin(world_rows(rows), map(Path, files))


def _of_bench(files: Sequence[str]) -> list[dict[str, Any]]:
    rows = [row for file in files for row in _bench_rows(Path(file))]
    if not rows or any("what" not in row for row in rows):
        raise CallError(f"{', '.join(files)}: no rows of a benchmark")
    return rows


def _bench_rows(path: Path) -> list[dict[str, Any]]:
    """Of agreement's comparisons, the latest, which names its commits."""
    found = _json(path)
    if isinstance(found, dict) and found.get("comparisons"):
        latest = found["comparisons"][-1]
        return with_origin(latest["rows"], [path], " ".join(latest.get("commits", ())))
    return with_origin(found, [path])


def _json(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise CallError(f"{path} is no JSON: {error}") from None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
