"""Whatever ends a team, nothing stays: real namespaces and interfaces, dummy programs."""

import functools
import itertools
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import pytest

from mr_launch.begun import NO_END
from mr_measures.record.files import read_record

HERE = Path(__file__).resolve().parent
NEW_WORLD = ["unshare", "--pid", "--net", "--mount", "--fork", "--kill-child", "--mount-proc"]

# exit code of the runner; the shell's rule for a process that was killed is 128 + signal, Popen's is -signal
CODES = {"finish": 0, "interrupt": 130, "terminate": 130, "kill": -9, "kill-tree": -9, "crash": 1}


class Ended(NamedTuple):
    """A team that was ended; `found` as `leftovers.py` prints it."""

    found: dict
    output: str
    folder: Path


@pytest.fixture(scope="module")
def team():
    """Gives the team of `run` for these arguments, one for all tests. In folders that are open to the unprivileged user
    of some tests, which pytest's own are not."""
    with tempfile.TemporaryDirectory(prefix="leaves_nothing-") as name:
        os.chmod(name, 0o777)
        numbers = itertools.count()

        @functools.lru_cache(maxsize=None)
        def ended(isolation, end, outer):
            folder = Path(name, str(next(numbers)))
            folder.mkdir()
            folder.chmod(0o777)
            return Ended(*run(folder, isolation, end, outer_namespaces(outer)), folder)

        yield ended


def run(folder, isolation, end, outer):
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(HERE.parent / "src"), os.environ.get("PYTHONPATH", "")]),
    }
    command = [*outer, sys.executable, str(HERE / "leftovers.py"), str(folder), isolation, end]
    result = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300, check=False)
    output = (folder / "output").read_text() if (folder / "output").exists() else ""
    assert result.returncode == 0, result.stderr + output
    return json.loads(result.stdout), output


def outer_namespaces(kind):
    """Namespaces around the test, so that it sees only what the team leaves."""
    user = ["--user", "--map-root-user"] if kind == "user" or os.geteuid() != 0 else []
    return [NEW_WORLD[0], *user, *NEW_WORLD[1:]]


# Without a PID namespace nobody is left to end a stubborn grandchild once both runners were killed in one blow.
CASES = [(kind, end) for kind in ("root", "user", "hub") for end in CODES if (kind, end) != ("hub", "kill-tree")]


@pytest.mark.parametrize(("kind", "end"), CASES)
def test_nothing_is_left(team, kind, end):
    isolation = {"root": "namespaces", "user": "namespaces", "hub": "hub"}[kind]
    found, output, _ = team(isolation, end, kind)
    assert found["left"] == {}, output
    assert found["code"] == CODES[end], output
    assert found["processes_during"] > 3 or end in ("finish", "crash"), output


@pytest.mark.skipif(
    os.geteuid() != 0, reason="needs root to become another user; test_nothing_is_left[user] covers the rest"
)
def test_unprivileged_user(team):
    found, output, _ = team("user namespaces", "finish", "root")
    assert (found["code"], found["left"]) == (0, {}), output


def test_crash_names_node_and_log(team):
    output = team("namespaces", "crash", "root").output
    assert "explorer of robot_1 died (exit code 3); log: /x/explorer-4*.log" in output
    assert "Traceback" not in output


ENDS = [
    ("finish", "finished", ""),
    ("interrupt", "unfinished", "interrupted"),
    ("crash", "failed", "explorer of robot_1 died (exit code 3)"),
    ("kill-tree", "failed", NO_END),
]


@pytest.mark.parametrize(("end", "status", "reason"), ENDS)
def test_every_mission_has_a_record(team, end, status, reason):
    folder = team("namespaces", end, "root").folder
    record = read_record(folder / "out" / "record.json")
    assert record.outcome.status == status and record.outcome.reason.startswith(reason)
    assert record.code and record.asked.settings["isolation"] == "namespaces"
    if status != "failed":
        assert list(record.robots) == ["robot_0", "robot_1"] and (folder / "out" / "team.png").exists()
