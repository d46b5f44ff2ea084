"""The tables of the README say what the code does."""

import ast
import re
from pathlib import Path

from mr_sim import world_model, world_process

PACKAGE = Path(__file__).parents[2]
README = (PACKAGE / "README.md").read_text(encoding="utf-8")


def first_columns(header: str) -> list[str]:
    """First column of the table with this header."""
    lines = README[README.index(header) :].splitlines()[2:]
    return [line.split("|")[1].strip().strip("`") for line in lines[: next(i for i, x in enumerate(lines) if not x)]]


def constant(name: str) -> object:
    """Value of a constant of the robot node, read without importing ROS."""
    tree = ast.parse((PACKAGE / "src/mr_sim/robot_node.py").read_text(encoding="utf-8"))
    (value,) = (n.value for n in tree.body if isinstance(n, ast.Assign) and getattr(n.targets[0], "id", "") == name)
    return ast.literal_eval(value)


def test_options_of_the_world_process():
    options = [o for action in world_process.argument_parser()._actions for o in action.option_strings]
    assert first_columns("| Option | Default | Meaning |") == [o for o in options if o not in ("-h", "--help")]


def test_parameters_of_the_robot_node():
    assert first_columns("| Parameter | Default | Meaning |") == [f"~{name}" for name in constant("PARAMETERS")]


def test_topics_of_the_robot_node():
    assert set(constant("TOPICS")) <= set(first_columns("| Topic | Type | Direction | Rate | |"))


def test_words_of_the_world_language():
    table = README[README.index("| Block | Words with an effect |") : README.index("Words and blocks that only")]
    named = set(re.findall(r"`([a-z_]+)(?: \"[a-z]+\")?`", table))
    words = world_model.WORLD_WORDS | world_model.POSITION_WORDS | world_model.RANGER_WORDS | world_model.SENSOR_WORDS
    assert words - named == set()
