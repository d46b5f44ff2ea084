"""team.json: how ``rosrun mr_launch enter`` reaches each robot of a team that runs now, live or played back."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, Mapping

from mr_launch.errors import UserError

_FIRST_PROCESS = re.compile(rb"mr_launch\.(recordings\.)?inside")


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
        raise UserError(f"no running team in {folder} (is it over, or did it write to another --out folder?)") from None
    if not _FIRST_PROCESS.search(command_line):
        raise UserError(f"the team of {folder} is over")
    return state


def _file(out: Path) -> Path:
    return out / "team.json"
