"""A person who drives goes before navigation."""

import re
from pathlib import Path

import pytest

from mr_robot.override.engine import HOLD, STANDSTILL, Override, Velocity

AHEAD, LEFT = Velocity(0.5), Velocity(angular=1.0)


def test_navigation_drives_while_nobody_else_does():
    override = Override()
    assert override.on_navigation(AHEAD, 0.0) == AHEAD and override.tick(0.1) is None


def test_a_person_holds_navigation_off_and_is_obeyed_at_once():
    override = Override()
    override.on_navigation(AHEAD, 0.0)
    assert override.on_person(LEFT, 0.1) == LEFT and override.taken
    assert override.on_navigation(AHEAD, 0.2) is None
    assert override.on_person(STANDSTILL, 0.3) == STANDSTILL, "a person who stops the robot holds it"
    assert override.on_navigation(AHEAD, 0.4) is None


def test_the_robot_stops_when_a_person_lets_go_and_then_navigation_drives():
    override = Override()
    override.on_person(LEFT, 10.0)
    assert override.tick(10.0 + HOLD - 0.01) is None
    assert override.on_navigation(AHEAD, 10.0 + HOLD - 0.01) is None
    assert override.tick(10.0 + HOLD) == STANDSTILL and not override.taken
    assert override.tick(10.1 + HOLD) is None
    assert override.on_navigation(AHEAD, 10.1 + HOLD) == AHEAD


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_what_is_no_velocity_is_passed_over(value):
    override = Override()
    assert override.on_person(Velocity(value), 0.0) is None and not override.taken
    assert override.on_navigation(Velocity(0.0, 0.0, value), 0.0) is None


def test_a_clock_that_jumps_back_does_not_leave_the_robot_with_the_person_for_ever():
    override = Override()
    override.on_person(LEFT, 100.0)
    assert override.tick(5.0) == STANDSTILL


def test_the_readme_names_what_the_node_reads_and_writes():
    package = Path(__file__).resolve().parents[1]
    node = (package / "src/mr_robot/override/node.py").read_text(encoding="utf-8")
    row = re.search(r"^\| `velocity_override` .*$", (package / "README.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert row is not None
    told = set(re.findall(r"`([~\w/]+)`", row[0])) - {"velocity_override", "src/mr_robot/override"}
    topics = re.findall(r'"(\w+/cmd_vel)"', node)
    topic = re.search(r'topic_parameters\(\{"(\w+)": "(\w+)"\}\)', node)
    assert topic is not None
    assert told == {"~hold", f"~{topic[1]}", topic[2], *topics} and f"`~hold` ({HOLD})" in row[0]
