"""What `tools/bench_fresh` reads from the output of `make demo`, and what it calls fresh. It is not run here."""

import importlib.machinery
import importlib.util
import sys

import pytest
from pages import REPOSITORY

LOADER = importlib.machinery.SourceFileLoader("bench_fresh", str(REPOSITORY / "tools" / "bench_fresh"))
SPEC = importlib.util.spec_from_loader("bench_fresh", LOADER)
bench_fresh = importlib.util.module_from_spec(SPEC)
sys.modules["bench_fresh"] = bench_fresh  # where dataclasses look for it
LOADER.exec_module(bench_fresh)

LINES = [
    (2.0, "Installing: cmake ninja-build ros-core"),
    (100.0, "Installing rosbags from PyPI into build/python_environment"),
    (110.0, "Building (log: build/build.log)"),
    (300.0, "getting ready, 0 s of 900 s"),
    (305.0, "  robot_0: waits for monitor"),
    (309.0, "getting ready, 5 s of 900 s"),
]
EMPTY = bench_fresh.Before(archives=0, wheels=0, cores=2)


def rows(lines=tuple(LINES), before=EMPTY, picture=350.0):
    stages = bench_fresh.stages_of(lines, cloned=1.5, picture=picture)
    return {row["what"].split(": ")[1]: row for row in bench_fresh.rows_of(stages, before)}


def test_each_stage_ends_where_the_next_one_begins():
    found = rows()
    values = {what: row["value"] for what, row in found.items()}
    assert values == {
        "clone": 1.5, "packages": 108.5, "building": 190.0, "mission in the small world": 50.0,
        "clone to first picture": 350.0,
    }  # fmt: skip
    assert found["clone to first picture"]["bar"] == "<= 480" and found["building"]["bar"] == "<= 240"
    assert "3 to install; nothing was there before" in found["packages"]["detail"]


def test_bars_are_missed():
    slow = [(at + 60.0 * (at > 200.0), text) for at, text in LINES]
    found = rows(slow, picture=481.0)
    assert not found["building"]["holds"] and not found["clone to first picture"]["holds"]


@pytest.mark.parametrize(
    ("lines", "before", "told"),
    [
        (LINES[2:], EMPTY, "all Debian packages were there"),
        (LINES, EMPTY.__class__(archives=7, wheels=0, cores=2), "7 packages in apt's cache"),
        (LINES, EMPTY.__class__(archives=0, wheels=9, cores=2), "pip's cache was not empty"),
        (LINES, EMPTY.__class__(archives=0, wheels=0, cores=8), "8 cores, not 2"),
    ],
)
def test_what_is_not_fresh_has_no_bar_and_says_so(lines, before, told):
    whole = rows(lines, before)["clone to first picture"]
    assert whole["bar"] == "-" and told in whole["detail"]


@pytest.mark.parametrize(
    ("lines", "missing"), [(LINES[:2], "did not come to building"), (LINES[:3], "did not come to a mission")]
)
def test_a_demo_that_did_not_get_there_is_no_figure(lines, missing):
    with pytest.raises(bench_fresh.StageError, match=missing):
        rows(lines)


def test_what_was_there_before_is_seen(tmp_path):
    (tmp_path / "archives").mkdir()
    (tmp_path / "archives" / "a.deb").touch()
    (tmp_path / ".cache" / "pip" / "http").mkdir(parents=True)
    (tmp_path / ".cache" / "pip" / "http" / "wheel").write_bytes(b"12345")
    found = bench_fresh.look_before(tmp_path, tmp_path / "archives")
    assert (found.archives, found.wheels) == (1, 5)
    assert "CMAKE_CXX_COMPILER_LAUNCHER" not in bench_fresh.without_caches({"CMAKE_CXX_COMPILER_LAUNCHER": "ccache"})


def test_the_programs_say_what_it_reads():
    """Words of the Makefile, of install_dependencies and of the team runner."""
    makefile = (REPOSITORY / "Makefile").read_text(encoding="utf-8")
    installing = (REPOSITORY / "tools" / "install_dependencies").read_text(encoding="utf-8")
    assert '@echo "Building (log:' in makefile and "demo: build\n" in makefile
    assert 'echo "Installing:$missing"' in installing and f'echo "{bench_fresh.PYTHON}' in installing
    assert '"getting ready"' in (REPOSITORY / "src/mr_launch/src/mr_launch/mission.py").read_text(encoding="utf-8")
