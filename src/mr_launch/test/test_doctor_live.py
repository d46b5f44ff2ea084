"""The doctor on a real computer and a real master with real radio nodes: silent while all is well, and then it names
what was broken. Several things are broken at once, because each run has to listen for a while."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from live_master import LiveMaster

from mr_launch.programs import find_executable

HERE = Path(__file__).resolve().parent
DOCTOR = [sys.executable, str(HERE.parent / "nodes" / "doctor"), "--seconds", "1.5"]
NOWHERE = {"ROS_MASTER_URI": "http://localhost:1"}
RADIO_NODE = find_executable("adhoc_communication", "adhoc_communication")


class LiveRobot(LiveMaster):
    """The drivers and SLAM of `fake_robot.py`, and adhoc_communication at the hub of a radio daemon."""

    def __init__(self, folder):
        super().__init__(folder)
        self.hub, self._strangers, self._healthy = folder / "hub", [], ()
        self.key = self.new_key("team.key", "ab" * 32)
        self.start("slam", sys.executable, HERE / "fake_robot.py")
        self.mend()
        self.wait_for_node("/slam")

    def mend(self):
        """Parameters and processes as they were in the beginning. After strangers another radio node, too, because the
        old one complains of them for a while."""
        self.key.chmod(0o600)
        self.forget("explorer", "map_merger")
        self.set(use_sim_time=True, slam={"scan_topic": "scan", "base_frame": "base_footprint"})
        self.set(adhoc_communication={"interface": f"hub:{self.hub}", "key_file": str(self.key), "robot_name": "anna"})
        self.wait_for(lambda: "/clock" in self.published())
        same = self.processes.get("adhoc_communication") in self._healthy
        if same and not self._strangers and all(process.poll() is None for process in self._healthy):
            return
        self.kill(*(name for name in ("adhoc_communication", "radio") if name in self.processes), *self._strangers)
        self._strangers.clear()
        self.hub.unlink(missing_ok=True)
        self.start("radio", find_executable("adhoc_communication", "radio"), "--hub", self.hub)
        self.wait_for(self.hub.exists)
        self.start_radio_node()
        self._healthy = self.processes["radio"], self.processes["adhoc_communication"]

    def start_radio_node(self):
        """The master remembers the one before."""
        service = "/adhoc_communication/get_neighbors"
        before = self._ask("lookupService", service)
        self.start("adhoc_communication", RADIO_NODE)
        self.wait_for(lambda: self._ask("lookupService", service) not in (None, before))

    def new_key(self, name, text):
        path = self.folder / name
        path.write_text(text)
        path.chmod(0o600)
        return path

    def start_stranger(self, namespace, *parameters):
        """The radio of another robot."""
        words = (f"_{parameter}" for parameter in parameters)
        self._strangers.append(namespace)
        self.start(namespace, RADIO_NODE, f"__ns:=/{namespace}", "/diagnostics:=diagnostics", *words)
        self.wait_for_node(f"/{namespace}/adhoc_communication")


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    found = LiveRobot(tmp_path_factory.mktemp("live"))
    yield found
    found.close()


@pytest.fixture
def live(robot):
    """Each test leaves it as it found it."""
    yield robot
    robot.mend()


def assert_findings(doctor, *beginnings):
    """Each line begins so, and there is no other one but that the computer is busy."""
    lines = [line for line in doctor.stdout.splitlines() if not line.startswith("all processor cores are busy")]
    assert doctor.returncode == (1 if beginnings else 0), doctor.stdout + doctor.stderr
    assert len(lines) == len(beginnings), doctor.stdout
    for line, beginning in zip(lines, beginnings):
        assert line.startswith(beginning), doctor.stdout


def test_a_robot_whose_drivers_parameters_and_key_are_broken(live):
    assert_findings(live.run(*DOCTOR))
    live.key.chmod(0o644)
    live.set(slam__faults=["stamps", "double"], explorer={"seed": -1})
    assert_findings(
        live.run(*DOCTOR, "--peers", "bob"),
        f"key file {live.key} can be read by others: chmod 600",
        "explorer: parameter ~seed is -1",
        "messages of /scan are 5.", "messages of /odom are 5.",
        "the transform to laser is published more than once",
        "bob cannot be reached (nobody is heard)",
    )  # fmt: skip


def test_a_laser_without_a_place_a_node_that_has_ended_and_another_teams_key(live):
    other_key = live.new_key("other.key", "cd" * 32)
    live.start_stranger("other", f"interface:=hub:{live.hub}", f"key_file:={other_key}", "robot_name:=carl")
    live.set(slam__faults=["unmounted"], map_merger={"robot_name": "pc7"})
    assert_findings(
        live.run(*DOCTOR),
        "the robot has several names: anna in adhoc_communication, pc7 in map_merger",
        "the node map_merger does not run",
        "there is no transform from base_footprint to laser",
        "frames are refused: forged: the same key on all robots",
    )


def test_no_radio_no_scans_and_slow_odometry(live):
    live.kill("adhoc_communication", "radio")
    live.set(slam__faults=["scan", "slow"])
    assert_findings(
        live.run(*DOCTOR),
        f"no radio answers at hub socket {live.hub} (",
        "/scan is silent, though /slam offers it",
        "/odom comes at ",
    )


def test_simulated_time_that_nobody_uses_and_two_robots_of_one_name(live):
    live.set(use_sim_time=False)
    live.forget("adhoc_communication")
    found = ["/slam publishes /clock, and the nodes do not use it: rosparam set /use_sim_time"]
    if os.geteuid() == 0:  # raw frames, because a hub takes only one robot of a name
        live.set(adhoc_communication={"interface": "lo", "key_file": str(live.key), "robot_name": "anna"})
        live.kill("adhoc_communication")
        live.start_radio_node()
        on_lo = ("interface:=lo", "mac:=02-00-00-00-00-07", f"key_file:={live.key}", "robot_name:=anna")
        live.start_stranger("copy", *on_lo)
        found.append("two robots are called anna: give one of them another robot_name:=")
    assert_findings(live.run(*DOCTOR), *found)


def test_a_node_that_began_before_time_was_simulated(live):
    """Once nothing was said of it: what it published had stamps that nobody else had, and what it waited for lasted."""
    live.set(use_sim_time=False)
    live.kill("adhoc_communication")
    live.start_radio_node()
    live.set(use_sim_time=True)
    told = "the computer's clock, not /clock, tells the time to /adhoc_communication: start again what began before"
    assert_findings(live.run(*DOCTOR), told)


def test_a_node_that_began_when_time_was_simulated(live):
    """Once nothing was said of it, and it hung for ever."""
    live.set(use_sim_time=False, slam__faults=["clock"])
    live.wait_for(lambda: "/clock" not in live.published())
    told = "nobody publishes /clock, for which /adhoc_communication waits: start again what began before /use_sim_time"
    assert_findings(live.run(*DOCTOR), told)


def test_a_master_that_has_ended(tmp_path):
    master = LiveMaster(tmp_path)
    master.close()
    assert_findings(master.run(*DOCTOR), "no ROS master answers at http://localhost:")


def run_doctor(prefix, *words, **environment):
    command = [*prefix, *DOCTOR, *map(str, words)]
    environment = {**os.environ, **NOWHERE, **environment}
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60, check=False)


def test_an_interface_a_key_and_a_disk_that_cannot_be_used(tmp_path):
    """In namespaces of its own, where lo is down."""
    prefix = ["unshare", "--net", "--mount", *(["--map-root-user"] if os.geteuid() else [])]
    made = subprocess.run([*prefix, "true"], capture_output=True, text=True, check=False)
    if made.returncode:
        required = os.environ.get("CI") or os.environ.get("REQUIRE_RAW_SOCKETS")
        (pytest.fail if required else pytest.skip)(f"needs root or user namespaces: {made.stderr.strip()}")
    disk, key = tmp_path / "disk", tmp_path / "team.key"
    disk.mkdir()
    key.write_text("ab" * 31)
    mount = f'mount -t sysfs own /sys && mount -t tmpfs -o size=1m full "{disk}"'
    prepare = f'{mount} && ip link set lo mtu 1000 && exec "$@"'
    words = ("--interface", "lo", "--key-file", key)
    assert_findings(
        run_doctor([*prefix, "sh", "-c", prepare, "sh"], *words, ROS_HOME=str(disk / ".ros")),
        "interface lo is down: sudo ip link set lo up",
        "frames of 1500 octets do not fit interface lo: sudo ip link set lo mtu 1486",
        f"key file {key} is broken: line 1 is not a key of 64 hexadecimal digits",
        f"the disk of {disk}/.ros is nearly full: 1 MB are left",
        "no ROS master answers at http://localhost:1 (",
    )


def test_a_wrong_address_no_such_interface_no_rights_and_the_key_of_another_user(tmp_path):
    """Root without the powers that make it root."""
    prefix = [] if os.geteuid() else ["setpriv", "--bounding-set=-net_raw,-dac_override,-dac_read_search"]
    key = tmp_path / "team.key"
    key.touch(mode=0o000)
    allowed = "security.capability" in os.listxattr(RADIO_NODE)  # as on a robot that was set up
    rights = "adhoc_communication may not send raw frames: it lacks the capability cap_net_raw: sudo setcap cap_net_raw"
    assert_findings(
        run_doctor(prefix, "--interface", "wlan77", "--key-file", key, ROS_IP="203.0.113.7", ROS_HOSTNAME=""),
        "ROS_IP 203.0.113.7 is not an address of this computer, so nodes cannot reach one another: unset ROS_IP",
        "interface wlan77 does not exist (existing: ",
        *([] if allowed else [rights]),
        f"key file {key} cannot be read: Permission denied: run the doctor as the robot's user",
        "no ROS master answers at http://localhost:1 (Connection refused)",
    )
