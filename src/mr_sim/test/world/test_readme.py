"""The tables of the README say what the code does."""

import ast
import re
from pathlib import Path

from mr_sim import stageros_options, world_process, world_words

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


def test_parameters_and_services_of_stageros():
    parameters = first_columns("| Parameter of `stageros` | Default | Meaning |")
    assert parameters == [f"~{name}" for name in stageros_options.PARAMETERS]
    services = re.findall(r'rospy\.Service\("(\w+)"', (PACKAGE / "src/mr_sim/stageros.py").read_text(encoding="utf-8"))
    assert first_columns("| Service | Type | |") == services == ["reset_positions"]
    assert all(f"`~{name}`" in README for name in stageros_options.WITHOUT_EFFECT)


def test_topics_of_the_robot_node():
    assert set(constant("TOPICS")) <= set(first_columns("| Topic | Type | Direction | Rate | |"))


def rows_of(header: str) -> str:
    """All of the table with this header."""
    table = README[README.index(header) :]
    return table[: table.index("\n\n")]


def test_words_of_the_world_language():
    effective, passed_over = rows_of("| Block | Words with an effect |"), rows_of("| Block | Words without an effect |")
    named = set(re.findall(r"`([a-z_]+)(?:\[i\])?(?: \"[a-z]+\")?`", effective))
    words = frozenset().union(*(world_words.words_of(kind) for kind in world_words.BLOCK_KINDS))
    assert words - named <= set().union(*world_words.PASSED_OVER_WORDS.values())
    assert words - named - set(re.findall(r"`([a-z_]+)`", passed_over)) == set()


def test_every_passed_over_word_stands_in_the_row_of_its_block():
    passed_over = rows_of("| Block | Words without an effect |")
    for kind, words in world_words.PASSED_OVER_WORDS.items():
        label = {"world": "world", "model": "all models"}.get(kind, f"`{kind}`")
        (row,) = (line for line in passed_over.splitlines() if label in line.split("|")[1])
        assert words - set(re.findall(r"`([a-z_]+)`", row)) == set()


def test_every_passed_over_model_is_named():
    assert all(f"`{kind}`" in README for kind in world_words.PASSED_OVER_MODELS)
