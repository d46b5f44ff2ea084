"""What is tuned in navigation is told in one table, so that it stays little."""

import ast
import re
from pathlib import Path
from typing import Dict

from usual_robot import navigation_with

from mr_robot.navigation.options import CREEPING

ROOT = Path(__file__).parents[1]
# Of tables, searches and numerics: whatever they are, the robot drives alike.
BOUNDS = {
    "FEEDBACK_PERIOD", "MOST_ROTATION", "REMEMBERED_LIMIT", "kHeadings", "kStep", "kMostNodes", "kNodesPerCell",
    "kPerCost", "kTurns", "SQUARES_KEPT",
}  # fmt: skip


def test_the_table_of_constants_is_that_of_the_code() -> None:
    code = {**_of_python(), **_of_cpp()}
    assert BOUNDS.issubset(code)
    assert {name: value for name, value in code.items() if name not in BOUNDS} == _told()


def test_the_numbers_with_a_name_are_as_many_as_the_text_says() -> None:
    told = re.search(r"(\d+) now, counted the same way;\n(\d+) without .*, (\d+) without the bounds", _text())
    assert told
    modules = [ast.parse(path.read_text()) for path in sorted((ROOT / "src/mr_robot/navigation").glob("*.py"))]
    values = [node.value for module in modules for node in module.body if isinstance(node, (ast.Assign, ast.AnnAssign))]
    named = sum(any(_is_constant(part) for part in ast.walk(value)) for value in values if value)
    compiled = re.findall(r"constexpr \S+ k\w+ = ([^;]*);", _cpp())
    plain = [value for value in compiled if re.fullmatch(r"\d[\d.e-]*F?", value)]
    assert int(told[1]) == named + sum(bool(re.search(r"\d", value)) for value in compiled)
    assert int(told[2]) == len(_of_python()) + len(plain)
    assert int(told[3]) == len(_told())


def test_what_follows_from_the_robot_is_as_the_text_says() -> None:
    options = navigation_with()
    table = _text().partition("**What follows from the robot.**")[2].partition("**Constants.**")[0]
    told = [float(number) for number in re.findall(r"^\| that .* \| ([\d.]+) .* \| .* \|$", table, re.MULTILINE)]
    manoeuvres = options.reach - options.circumscribed_radius - _of_cpp()["kStep"]
    assert told == [round(value, 2) for value in (options.horizon, options.reach, manoeuvres, 1.0 / CREEPING)]


def _of_python() -> Dict[str, float]:
    found = {}
    for path in sorted((ROOT / "src/mr_robot/navigation").glob("*.py")):
        for node in ast.parse(path.read_text()).body:
            if not isinstance(node, ast.Assign):
                continue
            parts = list(ast.walk(node.value))
            numbers = [part.value for part in parts if isinstance(part, ast.Constant) and _is_number(part.value)]
            follows = any(isinstance(part, ast.Name) for part in parts)
            if numbers and not follows:
                assert isinstance(node.value, ast.Constant), f"{ast.unparse(node)}: one name for each number"
                found[ast.unparse(node.targets[0])] = float(numbers[0])
    return found


def _is_constant(part: ast.AST) -> bool:
    return isinstance(part, ast.Constant) and _is_number(part.value)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _of_cpp() -> Dict[str, float]:
    found = re.findall(r"constexpr \S+ (k\w+) = (\d[\d.e-]*)F?;", _cpp())
    assert not re.findall(r"constexpr \S+ k\w+\[", _cpp()), "one name for each number"
    return {name: float(value) for name, value in found}


def _cpp() -> str:
    return "\n".join(path.read_text() for path in sorted((ROOT / "src/cpp/navigation").glob("*.[ch]pp")))


def _text() -> str:
    return (ROOT / "docs/slam_and_navigation.md").read_text()


def _told() -> Dict[str, float]:
    rows = re.findall(r"^\| `(\w+)` \| ([\d.]+) \| ", _text(), re.MULTILINE)
    return {name: float(value) for name, value in rows}
