"""Set-ups that are really broken, one fault each, and what the doctor has to say of it: of a robot on a master of its
own with a real radio node, and of a computer without one. Shared by the tests and `bench_doctor`."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Callable, Dict, List, NamedTuple, Sequence, Tuple

from live_master import LiveMaster

from mr_launch.programs import find_executable

HERE = Path(__file__).resolve().parent
DOCTOR = [sys.executable, str(HERE.parent / "nodes" / "doctor"), "--seconds", "1.5"]
NOWHERE = {"ROS_MASTER_URI": "http://localhost:1"}
NO_MASTER = "no ROS master answers at http://localhost:1 ("
RADIO_NODE = find_executable("adhoc_communication", "adhoc_communication")
BUSY = "all processor cores are busy"  # true of many a computer that runs tests
RIGHTS = "adhoc_communication may not send raw frames: it lacks the capability cap_net_raw: sudo setcap cap_net_raw"


class LiveRobot(LiveMaster):
    """The drivers and SLAM of `fake_robot.py`, and adhoc_communication at the hub of a radio daemon."""

    def __init__(self, folder):
        super().__init__(folder)
        self.hub, self._strangers, self._healthy, self._faults = folder / "hub", [], (), []
        self.key = self.new_key("team.key", "ab" * 32)
        self.start("slam", sys.executable, HERE / "fake_robot.py")
        self.mend()
        self.wait_for_node("/slam")

    def mend(self):
        """Parameters and processes as they were in the beginning. After strangers another radio node, too, because the
        old one complains of them for a while."""
        self._faults.clear()
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

    def break_driver(self, fault):
        """As `fake_robot.py` names it."""
        self._faults.append(fault)
        self.set(slam__faults=self._faults)

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


class Fault(NamedTuple):
    """Of a LiveRobot. `told`: the beginnings of the lines that the doctor has to say, where {key} and {hub} are those
    of the robot; `words`: what it is given."""

    make: Callable[[LiveRobot], None]
    told: Tuple[str, ...]
    words: Tuple[str, ...] = ()


def driver(fault: str) -> Callable[[LiveRobot], None]:
    return lambda live: live.break_driver(fault)


def another_teams_key(live: LiveRobot) -> None:
    key = live.new_key("other.key", "cd" * 32)
    live.start_stranger("other", f"interface:=hub:{live.hub}", f"key_file:={key}", "robot_name:=carl")


def unused_simulated_time(live: LiveRobot) -> None:
    live.set(use_sim_time=False)
    live.forget("adhoc_communication")


def two_of_one_name(live: LiveRobot) -> None:
    """With raw frames, because a hub takes only one robot of a name."""
    live.set(adhoc_communication={"interface": "lo", "key_file": str(live.key), "robot_name": "anna"})
    live.kill("adhoc_communication")
    live.start_radio_node()
    on_lo = ("interface:=lo", "mac:=02-00-00-00-00-07", f"key_file:={live.key}", "robot_name:=anna")
    live.start_stranger("copy", *on_lo)


def began_before_simulated_time(live: LiveRobot) -> None:
    live.set(use_sim_time=False)
    live.kill("adhoc_communication")
    live.start_radio_node()
    live.set(use_sim_time=True)


def began_when_time_was_simulated(live: LiveRobot) -> None:
    live.set(use_sim_time=False)
    live.break_driver("clock")
    live.wait_for(lambda: "/clock" not in live.published())


ROBOTS: Dict[str, Fault] = {
    "a key that others can read": Fault(
        lambda live: live.key.chmod(0o644), ("key file {key} can be read by others: chmod 600",)
    ),
    "a parameter out of range": Fault(
        lambda live: live.set(explorer={"seed": -1}), ("explorer: parameter ~seed is -1",)
    ),
    "drivers with old stamps": Fault(driver("stamps"), ("messages of /scan are 5.", "messages of /odom are 5.")),
    "a transform that two nodes publish": Fault(
        driver("double"), ("the transform to laser is published more than once",)
    ),
    "a robot that is not there": Fault(
        lambda live: None, ("bob cannot be reached (nobody is heard)",), ("--peers", "bob")
    ),
    "two names and a node that has ended": Fault(
        lambda live: live.set(map_merger={"robot_name": "pc7"}),
        (
            "the robot has several names: anna in adhoc_communication, pc7 in map_merger",
            "the node map_merger does not run",
        ),
    ),
    "a laser without a place": Fault(driver("unmounted"), ("there is no transform from base_footprint to laser",)),
    "a robot with another team's key": Fault(
        another_teams_key, ("frames are refused: forged: the same key on all robots",)
    ),
    "no radio": Fault(
        lambda live: live.kill("adhoc_communication", "radio"), ("no radio answers at hub socket {hub} (",)
    ),
    "no scans": Fault(driver("scan"), ("/scan is silent, though /slam offers it",)),
    "slow odometry": Fault(driver("slow"), ("/odom comes at ",)),
    "simulated time that nobody uses": Fault(
        unused_simulated_time, ("/slam publishes /clock, and the nodes do not use it: rosparam set /use_sim_time",)
    ),
    "a node that began before time was simulated": Fault(
        began_before_simulated_time,
        ("the computer's clock, not /clock, tells the time to /adhoc_communication: start again what began before",),
    ),
    "a node that began when time was simulated": Fault(
        began_when_time_was_simulated,
        ("nobody publishes /clock, for which /adhoc_communication waits: start again what began before /use_sim_time",),
    ),
}
TWO_OF_ONE_NAME = Fault(two_of_one_name, ("two robots are called anna: give one of them another robot_name:=",))


def told_of(live: LiveRobot, faults: Sequence[Fault]) -> List[str]:
    return [beginning.format(key=live.key, hub=live.hub) for fault in faults for beginning in fault.told]


class Computer(NamedTuple):
    """One without a master. `prepare`: shell that breaks it in namespaces of its own, where lo is down; empty: it is
    taken as it is. `told` as in Fault, besides that there is no master, where {key} and {disk} are those of the
    set-up."""

    told: Tuple[str, ...]
    prepare: str = ""
    words: Tuple[str, ...] = ()
    key: str = "ab" * 32
    key_mode: int = 0o600
    environment: Tuple[Tuple[str, str], ...] = ()
    without_rights: bool = False
    new_build: bool = False  # the radio node was built by a user: its file has no capability


COMPUTERS: Dict[str, Computer] = {
    "an interface that is down": Computer(
        ("interface lo is down: sudo ip link set lo up",), "true", ("--interface", "lo")
    ),
    "an interface for short frames": Computer(
        ("frames of 1500 octets do not fit interface lo: sudo ip link set lo mtu 1486",),
        "ip link set lo up mtu 1000", ("--interface", "lo"),
    ),
    "a broken key": Computer(
        ("key file {key} is broken: line 1 is not a key of 64 hexadecimal digits",), "true", ("--key-file", "{key}"),
        key="ab" * 31,
    ),
    "a full disk": Computer(
        ("the disk of {disk}/.ros is nearly full: 1 MB are left",),
        'mount -t tmpfs -o size=1m full "{disk}"', environment=(("ROS_HOME", "{disk}/.ros"),),
    ),
    "an address that is another computer's": Computer(
        ("ROS_IP 203.0.113.7 is not an address of this computer, so nodes cannot reach one another: unset ROS_IP",),
        environment=(("ROS_IP", "203.0.113.7"), ("ROS_HOSTNAME", "")),
    ),
    "an interface that is not there": Computer(
        ("interface wlan77 does not exist (existing: ",), words=("--interface", "wlan77")
    ),
    "a key of another user": Computer(
        ("key file {key} cannot be read: Permission denied: run the doctor as the robot's user",),
        words=("--key-file", "{key}"), key_mode=0o000, without_rights=True,
    ),
    "a radio node without its right": Computer(
        (RIGHTS + "+ep {disk}/build/lib/adhoc_communication/adhoc_communication",), words=("--interface", "lo"),
        environment=(("CMAKE_PREFIX_PATH", f"{{disk}}/build:{os.environ.get('CMAKE_PREFIX_PATH', '')}"),),
        without_rights=True, new_build=True,
    ),
}  # fmt: skip


def own_namespaces() -> List[str]:
    return ["unshare", "--net", "--mount", *(["--map-root-user"] if os.geteuid() else [])]


def without_rights() -> List[str]:
    """Root without the powers that make it root."""
    return [] if os.geteuid() else ["setpriv", "--bounding-set=-net_raw,-dac_override,-dac_read_search"]


def build(folder: Path) -> None:
    """A catkin workspace with the radio node, whose extended attributes, and with them its rights, stay behind."""
    program = folder / "lib" / "adhoc_communication" / "adhoc_communication"
    program.parent.mkdir(parents=True)
    (folder / ".catkin").touch()
    shutil.copyfile(RADIO_NODE, program)
    program.chmod(0o755)


def examine(folder: Path, faults: Sequence[Computer]) -> Tuple["subprocess.CompletedProcess[str]", List[str]]:
    """What the doctor says of a computer with all these faults, and the beginnings of what it has to say."""
    disk, key = folder / "disk", folder / "team.key"
    disk.mkdir()
    if any(fault.new_build for fault in faults):
        build(disk / "build")
    key.write_text(next((fault.key for fault in faults if "--key-file" in fault.words), ""))
    key.chmod(min(fault.key_mode for fault in faults))

    def filled(text: str) -> str:
        return text.format(key=key, disk=disk)

    prepare = [filled(fault.prepare) for fault in faults if fault.prepare]
    prefix = without_rights() if any(fault.without_rights for fault in faults) else []
    if prepare:
        script = " && ".join(["mount -t sysfs own /sys", *prepare, 'exec "$@"'])
        prefix = [*own_namespaces(), "sh", "-c", script, "sh"]
    words = [filled(word) for fault in faults for word in fault.words]
    given = {name: filled(value) for fault in faults for name, value in fault.environment}
    done = subprocess.run(
        [*prefix, *DOCTOR, *words], env={**os.environ, **NOWHERE, **given}, capture_output=True, text=True, timeout=60,
        check=False,
    )  # fmt: skip
    return done, [*(filled(beginning) for fault in faults for beginning in fault.told), NO_MASTER]


def lines_of(doctor: "subprocess.CompletedProcess[str]") -> List[str]:
    """What it said, but that the computer is busy."""
    return [line for line in doctor.stdout.splitlines() if not line.startswith(BUSY)]
