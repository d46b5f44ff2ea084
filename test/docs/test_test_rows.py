"""What `make test` writes down of itself."""

import json
import os
import subprocess
from pathlib import Path

import pytest
from pages import REPOSITORY

PROGRAM = REPOSITORY / "tools" / "test_rows"
RESULTS = {
    "a/gtest-x.xml": """<testsuites><testsuite>
        <testcase name="A" status="run" result="completed" classname="X"/>
        <testcase name="B" status="run" result="skipped" classname="X"><skipped message="no"/></testcase>
        </testsuite></testsuites>""",
    "b/rosunit-y.xml": """<testsuite><testcase name="t" classname="M.K">
        <failure type="AssertionError"><![CDATA[[1] != [2]]]></failure></testcase></testsuite>""",
    "b/pytest-z.xml": """<testsuites><testsuite><testcase name="t" classname="z"><skipped message="x"/></testcase>
        <testcase name="u" classname="z"><error message=""/></testcase></testsuite></testsuites>""",
    "c/broken.xml": "<testsuite>",
}


def rows_of(folder: Path, seconds: int) -> dict:
    """By what they say. On one core of this computer."""
    file = folder.parent / "out" / "tests.json"
    one = str(min(os.sched_getaffinity(0)))
    subprocess.run(["taskset", "-c", one, PROGRAM, folder, str(seconds), file], check=True)
    return {row["what"]: row for row in json.loads(file.read_text())}


@pytest.fixture
def results(tmp_path: Path) -> Path:
    for name, text in RESULTS.items():
        (tmp_path / "results" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "results" / name).write_text(text)
    return tmp_path / "results"


def test_skipped_and_failed_tests_miss_their_bars(results):
    rows = rows_of(results, 100)
    assert [(row["value"], row["holds"]) for row in rows.values()] == [(100, True), (2, False), (3, False)]
    assert rows["make test: time"]["detail"].startswith("6 tests")


def test_twelve_minutes_are_the_bar_of_the_time(results):
    row = rows_of(results, 721)["make test: time"]
    assert (row["bar"], row["holds"]) == ("<= 720", False)


def test_without_results_one_line_says_how_it_is_called(tmp_path):
    done = subprocess.run([PROGRAM, tmp_path / "none", "1", "x"], capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr == "usage: test_rows RESULTS SECONDS FILE\n"
