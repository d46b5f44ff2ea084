"""Ctrl-C while the team runner, or a node, is still being read."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

TEAM = Path(__file__).resolve().parents[1] / "nodes" / "team"


@pytest.fixture
def slow(tmp_path):
    """Environment in which the import of the command takes its time, and says so."""
    package = tmp_path / "mr_launch"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "commands.py").write_text("import time\nprint('importing', flush=True)\ntime.sleep(60.0)\n")
    return {**os.environ, "PYTHONPATH": f"{tmp_path}:{os.environ.get('PYTHONPATH', '')}"}


def test_an_interrupt_during_the_imports_ends_it_without_a_traceback(slow):
    command = [sys.executable, str(TEAM)]
    with subprocess.Popen(command, env=slow, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as team:
        assert team.stdout.readline() == "importing\n"
        team.send_signal(signal.SIGINT)
        _, errors = team.communicate(timeout=20.0)
    assert (team.returncode, errors) == (-signal.SIGINT, "")


@pytest.mark.parametrize(
    "node",
    ["explorer/nodes/explorer", "map_merger/nodes/map_merger", "mr_launch/nodes/monitor", "mr_robot/nodes/move_base"],
)
def test_an_interrupt_during_the_imports_ends_a_node(node, tmp_path):
    """The import of cv2 lost it, as this one does: the team runner then waited for the node for half a minute."""
    (tmp_path / "cv2.py").write_text(
        "import time\nprint('importing', flush=True)\ntry:\n    time.sleep(30.0)\nexcept BaseException:\n    pass\n"
    )
    path = f"{tmp_path}:{os.environ.get('PYTHONPATH', '')}"
    command = [sys.executable, str(TEAM.parents[2] / node)]
    with subprocess.Popen(
        command, env={**os.environ, "PYTHONPATH": path}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == "importing\n"
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=20.0)
    assert (process.returncode, errors) == (-signal.SIGINT, "")
