"""The commands of the pages: blocks of shell of the README and of the tutorials, tables of all pages."""

from typing import Dict, Iterator, List, Tuple

from pages import REPOSITORY, pages, shell_lines, table_lines
from running import Line
from table import is_cheap, reason_not_to_run, shortened

WITH_BLOCKS = {"README.md", *(f"docs/tutorials/{path.name}" for path in (REPOSITORY / "docs/tutorials").glob("*.md"))}


def lines_of(page: str) -> Iterator[Line]:
    for number, text in shell_lines(REPOSITORY / page):
        text = text.split("  # ")[0].split("   #")[0].strip()
        if text:
            yield Line(page, number, text, shortened(text))


def all_lines() -> List[Line]:
    """A command of a table once, and not again where a block has it."""
    names = [str(page.relative_to(REPOSITORY)) for page in pages()]
    found = [line for page in names if page in WITH_BLOCKS for line in lines_of(page)]
    in_blocks = {line.text for line in found}
    in_tables: Dict[str, Tuple[str, int]] = {}
    for page in names:
        for number, text in table_lines(REPOSITORY / page):
            if text not in in_blocks:
                in_tables.setdefault(text, (page, number))
    return found + [Line(*place, text, shortened(text)) for text, place in in_tables.items()]


ALL = all_lines()
RUN = [line for line in ALL if reason_not_to_run(line.text) is None]
CHEAP = list({line.words: line for line in RUN if is_cheap(line.words)}.values())
LONG = [line for line in RUN if not is_cheap(line.words)]
