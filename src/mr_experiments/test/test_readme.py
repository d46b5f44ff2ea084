"""The README against the code."""

import dataclasses
import re
from pathlib import Path

from mr_experiments.trial.scenario import Scenario, known_scenarios

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")
SECTION = README[README.index("## Scenarios") : README.index("## Does virtual time")]


def first_cells(section):
    """Names in code style in the first column of the tables."""
    return {
        name
        for line in section.splitlines()
        if line.startswith("|")
        for name in re.findall(r"`(\w+)`", line.split("|")[1])
    }


def test_every_scenario_and_every_key_is_in_the_tables_and_nothing_else():
    keys = {field.name for field in dataclasses.fields(Scenario)} - {"name"}
    assert first_cells(SECTION) == set(known_scenarios()) | keys


def test_every_program_is_named():
    scripts = {path.name for path in (Path(__file__).parent.parent / "scripts").iterdir() if path.suffix == ""}
    assert {name for name in scripts if f"mr_experiments {name}" in README} == scripts
