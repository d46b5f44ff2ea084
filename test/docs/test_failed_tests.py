"""What `make test` prints of the tests that failed."""

import subprocess
from pathlib import Path

from pages import REPOSITORY

PROGRAM = REPOSITORY / "tools" / "failed_tests"
RESULTS = {
    "a/gtest-x.xml": """<testsuites><testsuite>
        <testcase name="B" classname="A"><failure message="2 is not 3&#x0A;at"/></testcase>
        <testcase name="C" classname="A"/></testsuite></testsuites>""",
    "b/rosunit-y.xml": """<testsuite><testcase name="t" classname="M.K">
        <failure type="AssertionError"><![CDATA[\n[1] != [2]\nmore]]></failure></testcase></testsuite>""",
    "b/pytest-z.xml": """<testsuites><testsuite>
        <testcase name="t" classname="z"><error message=""/></testcase></testsuite></testsuites>""",
    "c/broken.xml": "<testsuite>",
}


def printed(folder: Path) -> list[str]:
    return subprocess.run([PROGRAM, folder], capture_output=True, text=True, check=True).stdout.splitlines()


def test_each_failed_test_has_one_line_with_its_reason(tmp_path):
    for name, text in RESULTS.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    lines = printed(tmp_path)
    assert lines[:3] == [
        "FAILED a/gtest-x: A.B: 2 is not 3",
        "FAILED b/pytest-z: z.t: no reason given",
        "FAILED b/rosunit-y: M.K.t: [1] != [2]",
    ]
    assert lines[3].startswith(f"FAILED {tmp_path}/c/broken.xml: cannot be read") and len(lines) == 4


def test_nothing_is_printed_when_all_passed_and_not_more_than_one_can_read(tmp_path):
    assert printed(tmp_path) == []
    failed = "".join(f'<testcase name="{n}" classname="c"><failure message="x"/></testcase>' for n in range(30))
    (tmp_path / "many.xml").write_text(f"<testsuite>{failed}</testsuite>")
    lines = printed(tmp_path)
    assert len(lines) == 21 and lines[-1] == "and 10 more"
