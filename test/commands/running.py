"""Runs the commands of pages in a folder that looks like the repository, and writes nothing into it."""

import os
import re
import subprocess
import tempfile
from pathlib import Path
from typing import Dict, Iterable, NamedTuple

from pages import REPOSITORY

PATIENCE_S = 300  # of one command on a busy computer
PROGRAMS = ("rosrun", "roslaunch", "python3", "getcap")  # that end after it, however
MARK = "==== line"
READ_ONLY = ("docs", "src", "test", "tools", "worlds", "build", "Makefile")


class Line(NamedTuple):
    page: str
    number: int
    text: str  # as the page has it
    words: str  # as it is run

    @property
    def name(self) -> str:
        return f"{self.page}:{self.number}: {self.text}"


class Ran(NamedTuple):
    code: int
    output: str


def sandbox(folder: Path) -> Path:
    """With `out`, a home and a map of the user's own."""
    for name in READ_ONLY:
        (folder / name).symlink_to(REPOSITORY / name)
    (folder / "out").mkdir()
    (folder / "home").mkdir()
    rooms = bytes(0 if 0 in (x, y) or 79 in (x, y) else 254 for y in range(80) for x in range(80))
    (folder / "my_map.pgm").write_bytes(b"P5 80 80 255\n" + rooms)
    (folder / "my_map.yaml").write_text(
        "image: my_map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    (folder / "agreement.json").symlink_to(REPOSITORY / "docs" / "results" / "agreement.json")
    (folder / "records").symlink_to("out/latest")
    return folder


def environment(folder: Path) -> Dict[str, str]:
    return {**os.environ, "HOME": str(folder / "home"), "ROS_LOG_DIR": str(folder / "home" / "log")}


def in_a_shell(lines: Iterable[Line], folder: Path) -> Dict[Line, Ran]:
    """All in one shell, one after the other: what one exports the next one has."""
    lines = list(lines)
    script = ["source tools/environment.sh"]
    for index, line in enumerate(lines):
        guard = f"timeout --kill-after 10 {PATIENCE_S} " if line.words.startswith(PROGRAMS) else ""
        script += [f"echo '{MARK} {index}'", guard + line.words, f"echo; echo '{MARK} {index} ended' $?"]
    with tempfile.NamedTemporaryFile("w", suffix=".sh") as file:
        file.write("\n".join(script) + "\n")
        file.flush()
        told = subprocess.run(
            ["bash", file.name],
            cwd=folder, env=environment(folder), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, check=False,
        )  # fmt: skip
    output = told.stdout.decode(errors="replace")
    return {line: _ran(output, index) for index, line in enumerate(lines)}


def _ran(output: str, index: int) -> Ran:
    found = re.search(rf"{MARK} {index}\n(.*?){MARK} {index} ended (\d+)\n", output, re.DOTALL)
    if found is None:
        return Ran(-1, f"it did not end; all so far:\n{output[-3000:]}")
    return Ran(int(found[2]), found[1])


def fault(line: Line, ran: Ran) -> str:
    """Why it has not done what it should, with the end of what it told; empty: it has."""
    signs = [sign for sign in ("Traceback", "success: False") if sign in ran.output]
    if ran.code == 0 and not signs:
        return ""
    return f"{line.words}\nexit code {ran.code} {' '.join(signs)}\n{ran.output[-3000:]}"
