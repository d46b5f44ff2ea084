"""Ctrl-C while the team runner, or a node, is still being read."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from mr_launch.team import NODES_PATIENCE
from mr_measures.record.files import read_record

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


@pytest.mark.parametrize("isolation", ["namespaces", "hub"])
def test_an_interrupt_before_the_mission_begins_waits_for_no_roslaunch_that_is_starting(tmp_path, isolation):
    """Which hears nothing, or waits 20 s for itself; the team waited 25 s for it."""
    if isolation == "namespaces" and os.geteuid() != 0:
        pytest.skip("needs root; the hub covers the rest")
    command = [sys.executable, str(Path(__file__).with_name("dummy_team.py")), str(tmp_path / "out"), isolation]
    path = os.pathsep.join([str(TEAM.parents[1] / "src"), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "PYTHONPATH": path, "DUMMY_DEAF": "robot_1"}
    log = tmp_path / "out" / "logs" / "robot_1.log"
    with subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as team:
        while team.poll() is None and not (log.exists() and "deaf" in log.read_text()):
            time.sleep(0.02)
        asked = time.monotonic()
        team.send_signal(signal.SIGINT)
        assert team.wait(timeout=60.0) == 130
    assert time.monotonic() - asked < NODES_PATIENCE / 2.0
    assert read_record(tmp_path / "out" / "record.json").outcome.reason == "interrupted"


@pytest.mark.parametrize(
    "node",
    [
        "explorer/nodes/explorer",
        "map_merger/nodes/map_merger",
        "mr_launch/nodes/monitor",
        "mr_robot/nodes/move_base",
        "mr_robot/nodes/slam",
        "mr_robot/nodes/velocity_override",
    ],
)
def test_an_interrupt_during_the_imports_ends_a_node(node, tmp_path):
    """An import lost it, as this one does: the team runner then waited for the node for half a minute."""
    (tmp_path / "rospy.py").write_text(
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
