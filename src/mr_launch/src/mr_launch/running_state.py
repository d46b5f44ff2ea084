"""team.json: how ``rosrun mr_launch enter`` reaches each robot of a team that runs now, live or played back."""

from __future__ import annotations

import contextlib
import json
import re
from pathlib import Path
from typing import Any, Mapping

from mr_launch.errors import UserError

_FIRST_PROCESS = re.compile(rb"mr_launch\.(recordings\.)?inside")
_ORDER = re.compile(rb"\x00(\{[^\x00]*\})\x00")


def write_state(
    out: Path, isolation: str, init: int | None, holders: Mapping[str, int], environments: Mapping[str, dict[str, str]]
) -> None:
    """`init`: process id of the first process as seen from outside; `holders`: of those that hold the namespaces of the
    robots, as seen inside; `environments`: ROS variables of each robot."""
    robots = {name: {"holder": holders.get(name), "environment": own} for name, own in environments.items()}
    state = {"isolation": isolation, "init": init, "robots": robots}
    _file(out).write_text(json.dumps(state, indent=2) + "\n")


def remove_state(out: Path) -> None:
    _file(out).unlink(missing_ok=True)


def running_team(folder: Path) -> dict[str, Any]:
    """The state of the team that runs now with this output folder. Raises UserError if none does."""
    try:
        state: dict[str, Any] = json.loads(_file(folder).read_text())
        command_line = Path(f"/proc/{state['init']}/cmdline").read_bytes()
    except (OSError, ValueError):
        raise UserError(f"no running team in {folder} (is it over?){_others()}") from None
    if not _FIRST_PROCESS.search(command_line):
        raise UserError(f"the team of {folder} is over{_others()}")
    return state


def running_folders() -> list[Path]:
    """Output folders of all teams that run now on this computer, by the orders of their first processes."""
    found = set()
    for file in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError, ValueError, KeyError, TypeError, IndexError):
            command_line = file.read_bytes()
            if _FIRST_PROCESS.search(command_line):
                found.add(Path(json.loads(_ORDER.findall(command_line)[0])["out"]))
    return sorted(folder for folder in found if _file(folder).exists())


def _others() -> str:
    folders = running_folders()
    if not folders:
        return "; no other team runs here"
    return f"; there run, for --team FOLDER: {', '.join(map(str, folders))}"


def _file(out: Path) -> Path:
    return out / "team.json"
