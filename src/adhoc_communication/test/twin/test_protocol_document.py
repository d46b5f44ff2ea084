"""The examples in docs/protocol.md are those of docs/protocol_vectors.json. With --write, they are put there."""

import ast
import json
import re
import sys
from pathlib import Path
from textwrap import wrap
from typing import Dict, List

DOCUMENTS = Path(__file__).resolve().parents[2] / "docs"
DOCUMENT = DOCUMENTS / "protocol.md"
SOURCES = DOCUMENTS.parent / "src"
VECTORS = json.loads((DOCUMENTS / "protocol_vectors.json").read_text(encoding="utf-8"))
HEADER, CHECKSUM, TAG = 2 * 43, 2 * 4, 2 * 16  # hexadecimal digits


def lines_of_frame(octets: str, trailer: int) -> List[str]:
    """Header, body and trailer apart."""
    return [octets[:HEADER], *wrap(octets[HEADER:-trailer], 80), octets[-trailer:]]


def blocks() -> Dict[str, List[str]]:
    """What stands in the hexadecimal blocks, by their first lines."""
    found = {"session key": [VECTORS["session_key"]]}
    for frame in VECTORS["frames"]:
        opened, sealed = lines_of_frame(frame["open"], CHECKSUM), lines_of_frame(frame["sealed"], TAG)
        found[frame["name"]] = [*opened, "# the same, sealed", *sealed]
    found.update({f"image, {image['name']}": wrap(image["octets"], 80) for image in VECTORS["images"]})
    found.update({f"parity {p['symbol']}": wrap(p["octets"], 80) for p in VECTORS["erasure_code"]["parity"]})
    return found


def tables() -> Dict[str, List[str]]:
    """The rows below these headings of tables."""
    digests = [f"| {':'.join(wrap(d['address'], 2))} | {d['digest']} |" for d in VECTORS["digests"]]
    cuts = [f"| {b['total']} | {b['segment_size']} | {', '.join(map(str, b['frames']))} |" for b in VECTORS["blocks"]]
    return {
        "| Address | Digest |\n| --- | --- |": digests,
        "| `total` | `segment_size` | Frames of the blocks |\n| --- | --- | --- |": cuts,
    }


def with_examples(text: str) -> str:
    """The document with the examples of the file in place of what it has."""
    filled = blocks()
    text = re.sub(r"```hex\n# (.*)\n[^`]*```", lambda m: "\n".join([f"```hex\n# {m[1]}", *filled[m[1]], "```"]), text)
    for heading, rows in tables().items():
        before, found, after = text.partition(heading)
        assert found, heading
        text = "\n".join([before + heading, *rows]) + re.sub(r"^(\n\|.*)*", "", after)
    return text


def test_every_example_of_the_document_is_that_of_the_file() -> None:
    text = DOCUMENT.read_text(encoding="utf-8")
    assert text == with_examples(text), f"run {__file__} --write"


def test_the_document_shows_every_example() -> None:
    shown = re.findall(r"```hex\n# (.*)\n", DOCUMENT.read_text(encoding="utf-8"))
    assert sorted(shown) == sorted(blocks())


def durations_in_the_code() -> Dict[str, str]:
    """Constants of the engine by file and name."""
    units = {"microseconds": "us", "milliseconds": "ms", "seconds": "s"}
    layers = ("engine", "api", "presence", "routing", "transport", "multicast", "air")
    files = [path for layer in layers for path in (SOURCES / layer).glob("*.[ch]pp")]
    found = {}
    for path in files:
        constants = re.findall(
            r"constexpr Time (k\w+) = std::chrono::(\w+)\((\d+)\);", path.read_text(encoding="utf-8")
        )
        for name, unit, value in constants:
            found[f"`{path.relative_to(SOURCES)}` `{name}`"] = f"{value} {units[unit]}"
    return found


def test_timers_of_the_document_are_those_of_the_code() -> None:
    text = (DOCUMENTS / "states.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| .* \| (\d+ [mu]?s) \| (`\S+` `k\w+`) \|$", text, flags=re.M)
    assert {place: value for value, place in rows} == durations_in_the_code()


def lines_of_code(path: Path) -> int:
    """Without docstrings, comments and blank lines."""
    text = path.read_text(encoding="utf-8")
    described = (ast.Module, ast.ClassDef, ast.FunctionDef)
    nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, described) and ast.get_docstring(node)]
    docstrings = {line for node in nodes for line in range(node.body[0].lineno, node.body[0].end_lineno + 1)}
    rest = [line.strip() for number, line in enumerate(text.splitlines(), start=1) if number not in docstrings]
    return sum(bool(line) and not line.startswith("#") for line in rest)


def test_a_robot_that_knows_no_groups_is_a_small_program():
    said = re.search(r"`frames.py` and `robot.py`, less than (\d+) lines", DOCUMENT.read_text(encoding="utf-8"))
    twin = Path(__file__).parent
    assert said and sum(lines_of_code(twin / name) for name in ("frames.py", "robot.py")) < int(said.group(1))


if __name__ == "__main__" and sys.argv[1:] == ["--write"]:
    DOCUMENT.write_text(with_examples(DOCUMENT.read_text(encoding="utf-8")), encoding="utf-8")
