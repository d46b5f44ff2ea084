"""The doctor on a real master with a real radio node: silent while all is well, and then it names what was broken."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from mr_launch.programs import find_executable, free_ports

HERE = Path(__file__).resolve().parent
DOCTOR = [sys.executable, str(HERE.parent / "nodes" / "doctor"), "--seconds", "2.5"]


class Live:
    """A master, the drivers and SLAM of `fake_robot.py`, and adhoc_communication at the hub of a radio daemon."""

    def __init__(self, folder):
        self._folder, self.processes = folder, {}
        (port,) = free_ports(1)
        self.environment = {
            **os.environ, "ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOSTNAME": "localhost",
            "ROS_LOG_DIR": str(folder), "ROS_HOME": str(folder),
        }  # fmt: skip
        self.key = folder / "team.key"
        self.key.write_text("ab" * 32)
        self.key.chmod(0o600)
        hub = folder / "hub"
        self.start("radio", find_executable("adhoc_communication", "radio"), "--hub", hub)
        self.start("core", "roscore", "-p", str(port))
        self.wait_for(hub.exists)
        self.wait_for(lambda: self.run("rosparam", "get", "/run_id").returncode == 0)
        for name, value in {
            "/adhoc_communication/interface": f"hub:{hub}", "/adhoc_communication/key_file": self.key,
            "/adhoc_communication/robot_name": "anna", "/slam/scan_topic": "scan", "/slam/base_frame": "base_footprint",
            "/use_sim_time": "true",
        }.items():  # fmt: skip
            self.run("rosparam", "set", name, str(value))
        self.start("slam", sys.executable, HERE / "fake_robot.py")
        self.start("adhoc_communication", find_executable("adhoc_communication", "adhoc_communication"))
        self.wait_for(lambda: "/adhoc_communication" in self.run("rosnode", "list").stdout)
        self.wait_for(lambda: "/slam" in self.run("rosnode", "list").stdout)

    def start(self, name, *command):
        with (self._folder / f"{name}.output").open("wb") as output:
            self.processes[name] = subprocess.Popen(
                [str(word) for word in command], env=self.environment, cwd=self._folder, stdout=output, stderr=output
            )

    def run(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=60, check=False)

    def wait_for(self, done):
        end = time.monotonic() + 30.0
        while not done():
            assert time.monotonic() < end, "not ready"
            time.sleep(0.1)

    def close(self):
        for process in reversed(list(self.processes.values())):
            process.send_signal(signal.SIGINT)
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()


@pytest.fixture
def live(tmp_path):
    found = Live(tmp_path)
    yield found
    found.close()


def test_a_live_robot(live):
    healthy = live.run(*DOCTOR)
    assert (healthy.returncode, healthy.stdout) == (0, ""), healthy.stdout + healthy.stderr

    live.key.chmod(0o644)
    live.run("rosparam", "set", "/slam/faults", "[stamps, double]")
    live.run("rosparam", "set", "/explorer", "{seed: -1}")
    broken = live.run(*DOCTOR, "--peers", "bob")
    assert broken.returncode == 1, broken.stderr
    for words in (
        "can be read by others: chmod 600",
        "messages of /scan are 5.", "the transform to laser is published more than once",
        "explorer: parameter ~seed is -1", "bob cannot be reached (nobody is heard)",
    ):  # fmt: skip
        assert words in broken.stdout, broken.stdout
    assert len(broken.stdout.splitlines()) == 6, broken.stdout  # the odometry is old, too

    live.key.chmod(0o600)
    live.run("rosparam", "delete", "/explorer")
    live.run("rosparam", "set", "/slam/faults", "[scan]")
    for name in ("adhoc_communication", "radio"):
        live.processes[name].kill()
        live.processes[name].wait()
    broken = live.run(*DOCTOR)
    assert broken.returncode == 1, broken.stderr
    assert [line.split(":")[0].split(" (")[0] for line in broken.stdout.splitlines()] == [
        "no radio answers at hub socket " + str(live.key.parent / "hub"), "/scan is silent, though /slam offers it",
    ], broken.stdout  # fmt: skip

    live.processes["core"].send_signal(signal.SIGINT)
    live.processes["core"].wait(30)
    alone = live.run(*DOCTOR)
    assert alone.returncode == 1 and alone.stdout.startswith("no ROS master answers at http://localhost:"), alone.stdout
    assert len(alone.stdout.splitlines()) == 1, alone.stdout
