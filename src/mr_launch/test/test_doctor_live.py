"""The doctor on a real master with a real radio node: silent while all is well, and then it names what was broken."""

import signal
import sys
from pathlib import Path

import pytest
from live_master import LiveMaster

from mr_launch.programs import find_executable

HERE = Path(__file__).resolve().parent
DOCTOR = [sys.executable, str(HERE.parent / "nodes" / "doctor"), "--seconds", "1.5"]


class LiveRobot(LiveMaster):
    """The drivers and SLAM of `fake_robot.py`, and adhoc_communication at the hub of a radio daemon."""

    def __init__(self, folder):
        super().__init__(folder)
        self.key = folder / "team.key"
        self.key.write_text("ab" * 32)
        self.key.chmod(0o600)
        hub = folder / "hub"
        self.start("radio", find_executable("adhoc_communication", "radio"), "--hub", hub)
        self.wait_for(hub.exists)
        self.set(use_sim_time="true", slam__scan_topic="scan", slam__base_frame="base_footprint")
        self.set(adhoc_communication__interface=f"hub:{hub}", adhoc_communication__key_file=self.key)
        self.set(adhoc_communication__robot_name="anna")
        self.start("slam", sys.executable, HERE / "fake_robot.py")
        self.start("adhoc_communication", find_executable("adhoc_communication", "adhoc_communication"))
        self.wait_for_node("/adhoc_communication")
        self.wait_for_node("/slam")


@pytest.fixture
def live(tmp_path):
    found = LiveRobot(tmp_path)
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
