"""The tables of options of README.md against the parsers of the programs, both ways."""

import argparse
import math
import re
from pathlib import Path

import pytest

from mr_launch import arguments
from mr_launch.doctor import command as doctor
from mr_launch.recordings import export_command, replay_command
from mr_launch.soak import command as soak

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
PARSERS = {
    "### The doctor": doctor.make_parser,
    "## A team": arguments.make_parser,
    "### In Foxglove, Lichtblick or Rerun": export_command.make_parser,
    "### Played back": replay_command.make_parser,
    "## Soak": soak.make_parser,
}


def told(heading):
    """{option: default} of the table of options in that section."""
    section = re.split(r"\n#{2,3} ", README.split(f"\n{heading}\n")[1])[0]
    rows = section.split("| Option | Default | Meaning |\n")[1].split("\n\n")[0].splitlines()[1:]
    found = {}
    for row in rows:
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", row.strip("|"))]
        names = re.findall(r"`(--[\w-]+)`", cells[0])
        defaults = cells[1].split(", ") if len(names) > 1 and ", " in cells[1] else [cells[1]] * len(names)
        assert len(names) == len(defaults), row
        found.update(zip(names, defaults))
    return found


def known(parser: argparse.ArgumentParser):
    actions = [action for action in parser._actions if action.option_strings and action.dest != "help"]
    return {action.option_strings[-1]: action for action in actions}


@pytest.mark.parametrize("heading", PARSERS)
def test_options_and_defaults_are_those_of_the_program(heading):
    table, options = told(heading), known(PARSERS[heading]())
    assert set(table) == set(options)
    wrong = {}
    for name, action in options.items():
        default = action.default
        if not (default or table[name]) or isinstance(default, bool) or default in (None, "", [], math.inf):
            continue  # said in words, or not at all
        shown = {str(default), default if isinstance(default, str) else f"{default:g}"}
        if table[name].strip("`") not in shown:
            wrong[name] = (table[name], default)
    assert not wrong
