"""The tables of the README name what the code has."""

import re
from pathlib import Path

from mr_page.commands import SERVICES

PACKAGE = Path(__file__).resolve().parents[1]
README = (PACKAGE / "README.md").read_text(encoding="utf-8")
SOURCES = PACKAGE / "src" / "mr_page"


def test_parameters():
    found = set(re.findall(r'_checked\("(\w+)"', (SOURCES / "ros_page.py").read_text())) | {"robot_name"}
    table = README.split("| Parameter |")[1].split("\n\n")[0]
    assert found == set(re.findall(r"^\| `(\w+)`", table, re.MULTILINE))


def test_topics_and_services():
    topics = set(re.findall(r'_subscribe\("([\w/]+)"', (SOURCES / "ros_feed.py").read_text()))
    assert len(topics) > 8
    assert [name for name in (*topics, *SERVICES.values()) if f"`{name}`" not in README] == []


def test_modules():
    table = README.split("| Module | Job |")[1].split("\n\n")[0]
    modules = {path.stem for path in SOURCES.glob("*.py")} - {"__init__", "commands"}
    assert [name for name in modules if f"`{name}`" not in table] == []


def test_arguments_of_the_launch_file_are_parameters():
    arguments = re.findall(r'<arg name="(\w+)"', (PACKAGE / "launch" / "page.launch").read_text())
    assert [name for name in arguments if f"| `{name}` |" not in README] == []
