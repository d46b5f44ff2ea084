"""Runs a team of dummies: ``dummy_team.py OUT ISOLATION [ROBOTS]``; the exit code is the runner's."""

import json
import os
import stat
import sys
from pathlib import Path

from mr_launch.arguments import parse_arguments
from mr_launch.commands import make_output_folder, note_begin, page_listener
from mr_launch.outside import run_team
from mr_launch.plan import Plan, RobotPlan

HERE = Path(__file__).resolve().parent


def program(folder, name):
    """An executable that calls one of the dummies."""
    path = folder / f"dummy_{name}"
    path.write_text(f'#!/bin/sh\nexec {sys.executable} {HERE / "dummies.py"} {name} "$@"\n')
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def main():
    out, isolation = Path(sys.argv[1]), sys.argv[2]
    names = [f"robot_{index}" for index in range(int(sys.argv[3]) if len(sys.argv) > 3 else 2)]
    tools = out.parent / "programs"
    tools.mkdir(exist_ok=True)
    os.environ["DUMMY_ROBOTS"] = json.dumps(names)
    arguments = ["--out", str(out), "--duration", "86400", "--page", os.environ.get("DUMMY_PAGE", "0")]
    if "DUMMY_ENDS" in os.environ:
        arguments.append("--respawn")
    plan = Plan(
        options=parse_arguments(arguments),
        world=str(HERE.parents[2] / "worlds" / "small8x8.world"),
        robots=[RobotPlan(name, index, 11461 + index, (1.0, 1.0 + index, 0.0)) for index, name in enumerate(names)],
        out=str(out),
        isolation=isolation,
        programs={name: program(tools, name) for name in ("radio", "team_key", "world", "roslaunch")},
    )
    make_output_folder(plan)
    note_begin(plan)
    return run_team(plan, page_listener(plan.options.page))


if __name__ == "__main__":
    sys.exit(main())
