"""The commands of the pages: blocks and tables of all pages, and what the text of README and tutorials names."""

from typing import Dict, Iterator, List, Tuple

from pages import INLINE_COMMAND, REPOSITORY, pages, prose_lines, shell_lines, table_lines
from running import Line
from table import is_cheap, reason_not_to_run, shortened

# Indented lines of the other pages may be something else than shell.
FOLLOWED = {"README.md", *(f"docs/tutorials/{path.name}" for path in (REPOSITORY / "docs/tutorials").glob("*.md"))}
OF_A_SHELL = ("cp ", "export ", "rviz ", "wireshark ", "cmake ")


def lines_of(page: str) -> Iterator[Line]:
    for number, text in shell_lines(REPOSITORY / page):
        text = text.split("  # ")[0].split("   #")[0].strip()
        if text and (page in FOLLOWED or INLINE_COMMAND.match(text) or text.startswith(OF_A_SHELL)):
            yield Line(page, number, text, shortened(text))


def all_lines() -> List[Line]:
    """Blocks of the README and the tutorials whole, all else once, and not again where such a block has it."""
    names = sorted((str(page.relative_to(REPOSITORY)) for page in pages()), key=lambda name: name not in FOLLOWED)
    found = [line for page in names if page in FOLLOWED for line in lines_of(page)]
    followed = {line.text for line in found}
    found += [line for page in names if page not in FOLLOWED for line in lines_of(page) if line.text not in followed]
    in_blocks = {line.text for line in found}
    others: Dict[str, Tuple[str, int]] = {}
    for page in names:
        named = (*table_lines(REPOSITORY / page), *(prose_lines(REPOSITORY / page) if page in FOLLOWED else ()))
        for number, text in named:
            if text not in in_blocks:
                others.setdefault(text, (page, number))
    return found + [Line(*place, text, shortened(text)) for text, place in others.items()]


ALL = all_lines()
RUN = [line for line in ALL if reason_not_to_run(line.text) is None]
CHEAP = list({line.words: line for line in RUN if is_cheap(line.words)}.values())
LONG = [line for line in RUN if not is_cheap(line.words)]
