"""``enter`` reaches a robot of a running team, whoever runs it and with whatever isolation."""

import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
UNPRIVILEGED = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]
CASES = ["namespaces", "user namespaces", "hub"]
ENTER = [sys.executable, str(HERE.parent / "nodes" / "enter")]


def environment():
    path = os.pathsep.join([str(HERE.parent / "src"), os.environ.get("PYTHONPATH", "")])
    return {**os.environ, "PYTHONPATH": path, "DUMMY_ENDLESS": "1"}


@pytest.fixture(params=CASES)
def team(request):
    """Folder of a running team of dummies, the prefix for its user, and its isolation."""
    if request.param == "namespaces" and os.geteuid() != 0:
        pytest.skip("needs root; the case of user namespaces covers this user")
    user = UNPRIVILEGED if request.param == "user namespaces" and os.geteuid() == 0 else []
    with tempfile.TemporaryDirectory(prefix="enter-") as name:
        folder = Path(name)
        folder.chmod(0o777)
        command = [*user, sys.executable, str(HERE / "dummy_team.py"), str(folder / "out"), request.param]
        with (folder / "output").open("wb") as output:
            process = subprocess.Popen(command, env=environment(), stdout=output, stderr=output)
        try:
            while not (folder / "out" / "team.json").exists():
                assert process.poll() is None, (folder / "output").read_text()
                time.sleep(0.02)
            yield folder, user, request.param
        finally:
            process.send_signal(signal.SIGINT)
            assert process.wait(60) == 130


def enter(folder, user, *words):
    command = [*user, *ENTER, "--team", str(folder / "out"), *words]
    return subprocess.run(
        command, cwd=folder, env=environment(), capture_output=True, text=True, timeout=30, check=False
    )


def test_command_runs_in_the_robots_place(team):
    folder, user, isolation = team
    one, two = (enter(folder, user, name, "printenv", "ROS_MASTER_URI") for name in ("robot_0", "robot_1"))
    assert one.returncode == two.returncode == 0, one.stderr + two.stderr
    assert one.stdout.startswith("http://localhost:")
    assert one.stdout != two.stdout, "the dummies of both robots have ports of their own"
    assert enter(folder, user, "robot_0", "pwd").stdout.strip() == str(folder)
    assert enter(folder, user, "robot_0", "sh", "-c", "exit 7").returncode == 7
    link = enter(folder, user, "robot_1", "ip", "-o", "link", "show", "radio0")
    assert (link.returncode == 0) == (isolation != "hub"), link.stdout + link.stderr
    elsewhere = subprocess.run(
        [*user, *ENTER, "robot_0", "ls"], cwd="/", env=environment(), capture_output=True, text=True, check=False
    )
    assert elsewhere.returncode == 2 and elsewhere.stderr.count("\n") == 1
    assert "no running team in out/latest" in elsewhere.stderr and f"--team FOLDER: {folder}/out" in elsewhere.stderr
    wrong = enter(folder, user, "robot_9", "ls")
    assert wrong.returncode == 2 and "there are robot_0, robot_1" in wrong.stderr
