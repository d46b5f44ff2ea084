"""The texts that the troubleshooting page quotes are those of the code."""

import re
from pathlib import Path

from pages import REPOSITORY

PAGE = REPOSITORY / "docs" / "troubleshooting.md"
BUILDING = re.compile(r"^## Building\n.*?^## ", re.MULTILINE | re.DOTALL)  # texts of shells, apt, compilers
EXAMPLES = (
    r"(~\w+|=|out/latest|\b(?:bob|carl|anna|wlan\d|eth0|lo|pc7|turtle|robot_\d|my_robot|team|tmp|hub|split_size|seed|best"
    r"|scan|odom|map|many|is not an integer|pioneer|gmapping|scan_topic|move_base|waits for|MB|base_footprint|in a wall"
    r"|pose in the)\b)"
)
LEAST = 10  # letters of a piece that is looked for


def sources() -> str:
    """All of src, with texts that go over several lines joined."""
    files = [path for ending in ("py", "cpp", "hpp") for path in REPOSITORY.glob(f"src/*/src/**/*.{ending}")]
    files += [path for path in REPOSITORY.glob("src/*/nodes/*") if path.is_file()]
    text = "\n".join(Path(path).read_text(encoding="utf-8", errors="ignore") for path in files)
    return re.sub(r"\"\s*\n\s*f?\"", "", text).replace('\\"', '"')


def pieces(quoted: str):
    """What of a quoted text does not depend on numbers and names."""
    for piece in re.split(rf"\.\.\.|[\d.']+|[(),:;%<>\"$]|{EXAMPLES}", quoted):
        if piece and len(piece.strip()) >= LEAST:
            yield piece.strip()


def quotes():
    commands = (
        r"(ros\w+|sudo|make|source|iw|python3|team_key|chmod|out|top|use_sim_time|OMP\w*|--\S+|/\S+|~\S+|\S+:=\S*) "
    )
    for line in BUILDING.sub("", PAGE.read_text(encoding="utf-8")).splitlines():
        for quoted in re.findall(r"`([^`]+)`", line) if line.startswith("| ") else []:
            if " " in quoted and not re.match(commands, quoted + " "):
                yield quoted


def test_quoted_texts_are_those_of_the_code():
    text, found = sources(), list(quotes())
    assert len(found) > 60
    missing = [f"{quoted!r}: {piece!r}" for quoted in found for piece in pieces(quoted) if piece not in text]
    assert not missing, "\n".join(missing)


def test_what_building_says_of_this_project_is_said_there():
    (section,) = BUILDING.findall(PAGE.read_text(encoding="utf-8"))
    script = (REPOSITORY / "tools" / "install_dependencies").read_text(encoding="utf-8")
    text = "these Debian packages are missing, and there is neither root nor sudo to install them:"
    assert text in section and text in script
