"""docs/aodv.md names the tests that decide its items: they exist, and no test is left out of the list."""

import re
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1]
ROW = re.compile(r"^\| ((?:[AB]\d+\.\d+(?:, )?)+) \| (.+?) \| (.*?) ?\|$", re.MULTILINE)
NAME = re.compile(r"^TEST(?:_[FP])?\(\w+, (\w+)\)", re.MULTILINE)
ID = re.compile(r"(?:^|_)([AB]\d+)_(\d+)(?=_)")


def listed():
    """What the list says of each item, and the files whose tests decide it."""
    items = {}
    for ids, rule, files in ROW.findall((PACKAGE / "docs" / "aodv.md").read_text()):
        for item in ids.split(", "):
            assert item not in items, f"{item} is listed twice"
            items[item] = (rule, {file for file in files.split(", ") if file})
    return items


def tested():
    """The files with tests that bear the id of an item in their name."""
    items = {}
    for path in sorted((PACKAGE / "test" / "engine").glob("test_*.cpp")):
        for name in NAME.findall(path.read_text()):
            for chapter, number in ID.findall(name):
                items.setdefault(f"{chapter}.{number}", set()).add(path.stem)
    return items


LISTED = listed()


def test_the_list_is_not_empty():
    assert len(LISTED) > 100


@pytest.mark.parametrize("item", LISTED)
def test_item(item):
    rule, files = LISTED[item]
    assert files == tested().get(item, set())
    assert files or rule.startswith(("left out: ", "differs: ")), "neither a test nor a reason"


def test_no_test_decides_what_is_not_listed():
    assert set(tested()) <= set(LISTED)
