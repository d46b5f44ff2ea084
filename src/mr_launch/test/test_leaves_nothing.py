"""Whatever ends a team, nothing stays: real namespaces and interfaces, dummy programs."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
NEW_WORLD = ["unshare", "--pid", "--net", "--mount", "--fork", "--kill-child", "--mount-proc"]

# exit code of the runner; the shell's rule for a process that was killed is 128 + signal, Popen's is -signal
CODES = {"finish": 0, "interrupt": 130, "terminate": 130, "kill": -9, "kill-tree": -9, "crash": 1}


def run(folder, isolation, end, outer):
    folder.mkdir()
    folder.chmod(0o777)
    for parent in (folder.parent, folder.parent.parent):
        parent.chmod(0o755)  # pytest makes them private; the unprivileged runner has to pass
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE.parent / "src"), os.environ.get("PYTHONPATH", "")])}
    command = [*outer, sys.executable, str(HERE / "leftovers.py"), str(folder), isolation, end]
    result = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=False)
    output = (folder / "output").read_text() if (folder / "output").exists() else ""
    assert result.returncode == 0, result.stderr + output
    return json.loads(result.stdout), output


def outer_namespaces(kind):
    """Namespaces around the test, so that it sees only what the team leaves."""
    user = ["--user", "--map-root-user"] if kind == "user" or os.geteuid() != 0 else []
    return [NEW_WORLD[0], *user, *NEW_WORLD[1:]]


@pytest.mark.parametrize("end", list(CODES))
@pytest.mark.parametrize("kind", ["root", "user", "hub"])
def test_nothing_is_left(tmp_path, kind, end):
    isolation = {"root": "namespaces", "user": "namespaces", "hub": "hub"}[kind]
    found, output = run(tmp_path / "team", isolation, end, outer_namespaces(kind))
    if kind == "hub" and end == "kill-tree":
        # Without a PID namespace nobody can end a grandchild that ignores SIGTERM once both runners were killed.
        found["left"] = {}
    assert found["left"] == {}, output
    assert found["code"] == CODES[end], output
    assert found["processes_during"] > 3 or end in ("finish", "crash"), output


@pytest.mark.skipif(os.geteuid() != 0, reason="needs root to become another user; test_nothing_is_left[user] covers the rest")
def test_unprivileged_user(tmp_path):
    found, output = run(tmp_path / "team", "user namespaces", "finish", outer_namespaces("root"))
    assert (found["code"], found["left"]) == (0, {}), output


def test_crash_names_node_and_log(tmp_path):
    _, output = run(tmp_path / "team", "namespaces", "crash", outer_namespaces("root"))
    assert "explorer of robot_1 died (exit code 3); log: /x/explorer-4*.log" in output
    assert "Traceback" not in output


def test_interrupted_mission_has_summary(tmp_path):
    run(tmp_path / "team", "namespaces", "interrupt", outer_namespaces("root"))
    summary = json.loads((tmp_path / "team" / "out" / "summary.json").read_text())
    assert summary["finished"] is False
    assert summary["reason"] == "interrupted"
    assert (tmp_path / "team" / "out" / "team.png").exists()
