"""Strategies outside of this package: registered by their place, and the example of the documentation explores."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from tiny_world import TinyWorld

from explorer import options
from explorer.errors import ParameterError
from explorer.strategies import strategy_of
from explorer.strategies.strategy import REGISTRY

EXAMPLE = Path(__file__).resolve().parents[3] / "docs" / "examples" / "spread_strategy.py"
PLACE = f"{EXAMPLE}:Spread"

TWO_ROOMS = """
    #################
    #01.....#.......#
    #.......#.......#
    #...............#
    #.......#.......#
    #################"""


@pytest.fixture(autouse=True)
def the_registry_stays_as_it_is():
    before = dict(REGISTRY)
    yield
    REGISTRY.clear()
    REGISTRY.update(before)


def in_another_process(program: str, places: str) -> subprocess.CompletedProcess:
    environment = {**os.environ, "EXPLORER_STRATEGIES": places}
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env=environment, timeout=60)


def test_a_place_gives_the_class_and_makes_its_number_known() -> None:
    spread = strategy_of(PLACE)
    assert strategy_of(PLACE) is spread is strategy_of("spread") is strategy_of(100)
    loaded = options.load({"strategy": PLACE}, host_name="joy")
    assert loaded.frontier_selection == 100
    assert "strategy 100: near clusters that are far from the other robots;" in options.summary(loaded)


@pytest.mark.parametrize("robots", [1, 2])
def test_the_example_explores_to_the_end(robots: int) -> None:
    strategy_of(PLACE)
    world = TinyWorld([row.strip() for row in TWO_ROOMS.strip().splitlines()], robots, 100)
    assert world.finish(limit=200.0) < 200.0
    assert world.unseen() == 0.0


@pytest.mark.parametrize(
    "text, name, culprit",
    [
        ("", "Mine", "mine.py has no Mine"),
        ("Mine = 3", "Mine", "that is no class of a Strategy"),
        ("import nothing_like_it", "Mine", "ModuleNotFoundError: No module named 'nothing_like_it'"),
        ("class Mine(", "Mine", "SyntaxError"),
        (
            "from explorer.strategies.strategy import Strategy\nclass Mine(Strategy): number = 9",
            "Mine",
            "no name, title",
        ),
        (
            "from explorer.strategies.strategy import FrontierStrategy\n"
            "class Mine(FrontierStrategy): number, name, title = 3, 'mine', ''",
            "Mine",
            "strategy 3 .mine. is registered twice",
        ),
    ],
)
def test_what_is_wrong_at_a_place_is_told(text: str, name: str, culprit: str, tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    file.write_text(text)
    with pytest.raises(ParameterError, match=culprit):
        options.load({"strategy": f"{file}:{name}"}, host_name="joy")
    with pytest.raises(ParameterError, match="FileNotFoundError"):
        options.load({"strategy": f"{tmp_path}/other.py:Mine"}, host_name="joy")


def test_strategies_of_the_environment_are_known_by_number_everywhere() -> None:
    program = (
        "from explorer.options import STRATEGIES, load; print(load({'frontier_selection': 100}).frontier_selection)"
    )
    found = in_another_process(program, PLACE)
    assert (found.stdout, found.returncode) == ("100\n", 0), found.stderr


def test_an_environment_that_cannot_be_used_ends_the_program_with_one_line() -> None:
    """With exit code 1 the team runner said by it that robots had not finished."""
    remedy = "; correct or unset this variable of the environment\n"
    found = in_another_process("import explorer.options", "spread")
    assert (found.returncode, found.stderr) == (
        2, f"EXPLORER_STRATEGIES: 'spread' is not of the form module:Class or path/file.py:Class{remedy}",
    )  # fmt: skip
    found = in_another_process("import explorer.options", "no_such_module:Mine")
    reason = "strategy 'no_such_module:Mine': ModuleNotFoundError: No module named 'no_such_module'"
    assert (found.returncode, found.stderr) == (2, f"EXPLORER_STRATEGIES: {reason}{remedy}")
