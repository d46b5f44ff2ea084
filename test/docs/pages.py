"""The pages of the documentation, their links and commands. Knows no ROS."""

import re
import shlex
from functools import lru_cache
from pathlib import Path
from typing import Callable, Dict, Iterator, List, NamedTuple, Tuple

REPOSITORY = Path(__file__).resolve().parents[2]
# With what a command in a table or in the text begins; a name alone is talked about, not run.
INLINE_COMMAND = re.compile(
    r"((sudo|[A-Z_]+=\S+) )*"
    r"(ros[a-z]+|python3|make|tools/\S+|iw|ip|git|source|getcap|setcap|apt|systemctl|journalctl|nmcli) \S"
)
OTHER_FOLDERS = {"build", "devel", "install", "out", ".git", ".pytest_cache"}


class Link(NamedTuple):
    """`target`: as the page has it, with what stands behind #."""

    page: Path
    line: int
    target: str


class Command(NamedTuple):
    page: Path
    line: int
    words: Tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.page.relative_to(REPOSITORY)}:{self.line}: {' '.join(self.words)}"


def pages() -> List[Path]:
    """All Markdown files of the repository."""
    found = (path for path in REPOSITORY.rglob("*.md") if not OTHER_FOLDERS & set(path.relative_to(REPOSITORY).parts))
    return sorted(found)


def links(page: Path) -> Iterator[Link]:
    """Links and pictures that stand outside of code and lead to files."""
    for number, line in _text_lines(page):
        for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", line)):
            if not re.match(r"[a-z]+:", target):
                yield Link(page, number, target)


@lru_cache(maxsize=None)
def anchors(page: Path) -> Tuple[str, ...]:
    """What a link to this page may have behind #: its headings as GitHub names them."""
    found: Dict[str, int] = {}
    names = []
    for _, line in _text_lines(page):
        heading = re.fullmatch(r"#{1,6}\s+(.*)", line)
        if heading:
            name = re.sub(r"[^\w\- ]", "", heading.group(1).lower()).replace(" ", "-")
            names.append(f"{name}-{found[name]}" if name in found else name)
            found[name] = found.get(name, 0) + 1
    return tuple(names)


def commands(page: Path) -> Iterator[Command]:
    """Those in fenced blocks of shell, in indented ones, in tables and in the text: one for each line, and for each
    part of a pipe or list."""
    for number, line in (*shell_lines(page), *table_lines(page), *prose_lines(page)):
        for part in re.split(r"\s(?:&&|\|\||\|)\s|;\s", line):
            try:
                words = shlex.split(part, comments=True)
            except ValueError:  # no line of shell
                continue
            while words and re.fullmatch(r"[A-Z_]+=\S*|export|sudo|nice", words[0]):
                words = words[1:]
            yield from _nested(page, number, words)


def _nested(page: Path, number: int, words: List[str]) -> Iterator[Command]:
    """The command, and the one that `enter` runs in a robot's namespace."""
    if words:
        yield Command(page, number, tuple(words))
    if words[:3] == ["rosrun", "mr_launch", "enter"]:
        rest = words[3:]
        yield from _nested(page, number, rest[3:] if rest[:1] == ["--team"] else rest[1:])


def table_lines(page: Path) -> Iterator[Tuple[int, str]]:
    """Commands in the cells of tables."""
    yield from _inline(page, lambda line: line.lstrip().startswith("|"))


def prose_lines(page: Path) -> Iterator[Tuple[int, str]]:
    """Commands in the text."""
    yield from _inline(page, lambda line: not line.lstrip().startswith("|"))


def _inline(page: Path, wanted: Callable[[str], bool]) -> Iterator[Tuple[int, str]]:
    """Whole ones: none with `...` in it."""
    for number, line in _text_lines(page):
        for code in re.findall(r"`([^`]+)`", line) if wanted(line) else []:
            if INLINE_COMMAND.match(code) and "..." not in code:
                yield number, code


def _text_lines(page: Path) -> Iterator[Tuple[int, str]]:
    fenced = False
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), start=1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced and not line.startswith("    "):
            yield number, line


def shell_lines(page: Path) -> Iterator[Tuple[int, str]]:
    """Lines that end with a backslash are joined."""
    language, joined = "", ""
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), start=1):
        fence = re.fullmatch(r"\s*```(\w*)", line)
        if fence:
            language = "" if language else fence.group(1) or "text"
        elif language == "sh" or (not language and line.startswith("    ")):
            joined += line.strip()
            if joined.endswith("\\"):
                joined = joined[:-1]
                continue
            yield number, joined
            joined = ""
