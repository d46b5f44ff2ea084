"""The command ``enter``. It imports little: people and tests call it again and again."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Sequence

from mr_launch import isolation
from mr_launch.errors import UserError
from mr_launch.exit_codes import BAD_CALL
from mr_launch.running_state import running_team

USAGE = "usage: rosrun mr_launch enter [--team FOLDER] ROBOT [COMMAND...]"
HELP = f"""{USAGE}

Runs a command where a robot of a running team or replay lives: with its ROS master, in its network.
Without a command: a shell.

  --team FOLDER  its output folder (default: out/latest)
  ROBOT          a robot's name, or base

Example: rosrun mr_launch enter robot_1 rostopic echo -n1 /explorer/state
Exit code: that of the command, 2 bad call."""


def enter(arguments: Sequence[str]) -> int:
    """``rosrun mr_launch enter [--team FOLDER] ROBOT COMMAND...``; replaces this process by the command."""
    if list(arguments[:1]) in (["--help"], ["-h"]):
        print(HELP)
        return 0
    try:
        command = enter_command(list(arguments))
    except UserError as error:
        print(f"enter: {error}", file=sys.stderr)
        return BAD_CALL
    os.execvp(command[0], command)


def enter_command(words: list[str]) -> list[str]:
    folder = Path("out/latest")
    if words[:1] == ["--team"] and len(words) > 1:
        folder, words = Path(words[1]), words[2:]
    if not words or words[0].startswith("-"):
        raise UserError(USAGE)
    robot, command = words[0], words[1:] or [os.environ.get("SHELL", "/bin/sh")]
    state = running_team(folder)
    if robot not in state["robots"]:
        raise UserError(f"no robot {robot} in this team; there are {', '.join(state['robots'])}")
    entry = state["robots"][robot]
    environment = {**entry["environment"], "PATH": isolation.search_path(os.environ.get("PATH", ""))}
    return isolation.command_inside(
        state["isolation"], state["init"], entry["holder"], environment, os.getcwd(), command
    )
