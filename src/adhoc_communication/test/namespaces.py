"""Robots on one computer for tests and benchmarks: a network namespace, a ROS master and a radio cable each.

Works as root and in an unprivileged user namespace. Nothing has a name in the file system: a namespace lives as long
as the process that holds it, so that nothing is left behind when the processes end.
"""

import ctypes
import json
import os
import queue
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

TEST_FOLDER = Path(__file__).resolve().parent
PR_SET_PDEATHSIG = 1
LIBC = ctypes.CDLL(None)


class Unavailable(RuntimeError):
    """This machine grants no network namespaces."""


def die_with_parent():
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def enter_own_network():
    """Run the calling program again inside a fresh network namespace, as root of a user namespace if need be."""
    if os.environ.get("ADHOC_TEST_NETWORK") == "own":
        return
    options = ["--net"] if os.geteuid() == 0 else ["--net", "--user", "--map-root-user"]
    command = ["unshare", *options, "--"]
    if subprocess.run([*command, "ip", "link", "add", "a0", "type", "veth", "peer", "name", "b0"]).returncode != 0:
        raise Unavailable("network namespaces with veth are not granted here")
    environment = {**os.environ, "ADHOC_TEST_NETWORK": "own"}
    os.execvpe("unshare", [*command, sys.executable, *sys.argv], environment)


def wait_until(condition, timeout, what):
    """Poll until `condition()` is true and return its value; AssertionError naming `what` after `timeout` seconds."""
    deadline = time.monotonic() + timeout
    while time.monotonic() < deadline:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError(f"not within {timeout} s: {what}")


def program(name):
    """Path of an executable of this package, in the devel or install space that is sourced."""
    folders = os.environ.get("CMAKE_PREFIX_PATH", "").split(":")
    for folder in folders:
        path = Path(folder) / "lib" / "adhoc_communication" / name
        if path.exists():
            return str(path)
    raise FileNotFoundError(f"{name} is in none of {folders}: source setup.sh first")


class Agent:
    """A rospy process beside a robot's master: calls services and listens to topics for the test."""

    def __init__(self, start, log):
        self._process = start(
            ["/usr/bin/python3", str(TEST_FOLDER / "robot_agent.py")],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, text=True,
        )  # fmt: skip
        self._answers = {}
        self._count = 0
        self.messages = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        for line in self._process.stdout:
            report = json.loads(line)
            if "message" in report:
                self.messages.put(report["message"])
            else:
                self._answers[report["id"]].put(report)

    def begin(self, **request):
        """Send a request and return the queue on which its answer will arrive."""
        self._count += 1
        answer = self._answers[self._count] = queue.Queue()
        self._process.stdin.write(json.dumps({"id": self._count, **request}) + "\n")
        self._process.stdin.flush()
        return answer

    def ask(self, timeout=60.0, **request):
        return self.begin(**request).get(timeout=timeout)

    def call(self, service, timeout=60.0, **fields):
        """{"response": {...}, "seconds": s} or {"error": text, "seconds": s}."""
        return self.ask(timeout=timeout, do="call", service=service, fields=fields)

    def listen(self, topic):
        assert self.ask(do="listen", topic=topic)["listening"]

    def close(self):
        """After the end of the process."""
        self._process.stdin.close()
        self._reader.join()
        self._process.stdout.close()

    def next_message(self, timeout=60.0):
        return self.messages.get(timeout=timeout)


class Robot:
    """A namespace with a ROS master, the adhoc_communication node and an agent."""

    def __init__(self, name, folder):
        self.name = name
        self._log = (Path(folder) / f"{name}.log").open("w")  # written to until stop()
        self._holder = subprocess.Popen(
            ["unshare", "--net", "--", "sleep", "infinity"], preexec_fn=die_with_parent, stdout=subprocess.DEVNULL
        )
        self.processes = []
        own = os.readlink("/proc/self/ns/net")
        wait_until(lambda: os.readlink(f"/proc/{self._holder.pid}/ns/net") != own, 5, f"namespace of {name}")
        self.holder_pid = self._holder.pid
        self.environment = {
            **os.environ, "ROS_MASTER_URI": "http://localhost:11311", "ROS_HOSTNAME": "localhost",
            "ROS_LOG_DIR": str(folder), "PYTHONUNBUFFERED": "1",
        }  # fmt: skip
        self.environment.pop("ROS_IP", None)
        self.node = None
        self.agent = None

    def start(self, command, **options):
        """Start a program in this robot's namespace; it ends with the test."""
        options.setdefault("stdout", self._log)
        options.setdefault("stderr", self._log)
        command = ["nsenter", "--target", str(self.holder_pid), "--net", "--", *command]
        process = subprocess.Popen(command, env=self.environment, preexec_fn=die_with_parent, **options)
        self.processes.append(process)
        return process

    def run(self, command, timeout=30):
        command = ["nsenter", "--target", str(self.holder_pid), "--net", "--", *command]
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=timeout)

    def start_master(self):
        self.run(["sh", "-c", "ip link set lo up; echo 1 > /proc/sys/net/ipv6/conf/all/disable_ipv6"])
        self.start(["/usr/bin/python3", "/usr/bin/rosmaster", "--core", "-p", "11311"])

    def wait_for_master(self):
        probe = "import rosgraph, sys; sys.exit(0 if rosgraph.is_master_online() else 1)"
        wait_until(lambda: self.run(["/usr/bin/python3", "-c", probe]).returncode == 0, 20, f"master of {self.name}")

    def start_node(self, **parameters):
        arguments = [f"_{name}:={value}" for name, value in {"robot_name": self.name, **parameters}.items()]
        self.node = self.start([program("adhoc_communication"), *arguments])
        return self.node

    def start_agent(self):
        self.agent = Agent(self.start, self._log)
        return self.agent

    def stop(self):
        for process in reversed(self.processes):
            if process.poll() is None:
                process.terminate()
        for process in self.processes:
            try:
                process.wait(timeout=5)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        if self.agent is not None:
            self.agent.close()
        self._holder.kill()
        self._holder.wait()
        self._log.close()


class Team:
    """Robots with a radio between their namespaces. Use as a context manager.

    :param links: pairs of names that hear each other; None for everybody.
    :param radio_options: further words of the radio's command line.
    :param positions: name -> (x, y) in metres, known to the radio before the nodes start.
    """

    robot_class = Robot

    def __init__(
        self, names, loss=0.0, links=None, seed=1, interface="radio0", node_parameters=None, radio_options=(),
        positions=None,
    ):  # fmt: skip
        self._folder = tempfile.TemporaryDirectory(prefix="adhoc-test-")
        self.folder = Path(self._folder.name)
        self.robots = {name: self.robot_class(name, self.folder) for name in names}
        self._loss, self._links, self._seed = loss, links, seed
        self._radio_options, self._positions = list(radio_options), positions or {}
        self._interface = interface
        self._parameters = {"num_e2e_retrans": 10, **(node_parameters or {})}
        self._radio = None
        self.radio_control = None

    def __enter__(self):
        try:
            self._lay_cables()
            self._start_radio()
            self._start_robots()
        except BaseException:
            self.__exit__()
            raise
        return self

    def _start_robots(self):
        for robot in self.robots.values():
            robot.start_master()
        for robot in self.robots.values():
            robot.wait_for_master()
            robot.start_node(interface=self._interface, **self._parameters)
            robot.start_agent()
        for robot in self.robots.values():
            robot.agent.ask(do="ready")

    def __exit__(self, *_):
        for robot in self.robots.values():
            robot.stop()
        if self._radio is not None:
            self._radio.terminate()
            self._radio.wait(timeout=5)
            self._radio.stdout.close()
        if self.radio_control is not None:
            self.radio_control.close()
        # The kernel would remove them too, but some time after the namespaces have ended.
        for index in range(len(self.robots)):
            subprocess.run(["ip", "link", "del", f"air{index}"], check=False, stderr=subprocess.DEVNULL)
        self._folder.cleanup()

    def __getitem__(self, name):
        return self.robots[name]

    def _lay_cables(self):
        for index, robot in enumerate(self.robots.values()):
            far_end = ["peer", "name", "radio0", "netns", str(robot.holder_pid)]
            subprocess.run(["ip", "link", "add", f"air{index}", "type", "veth", *far_end], check=True)
            subprocess.run(["ip", "link", "set", f"air{index}", "up"], check=True)
            assert robot.run(["ip", "link", "set", "radio0", "up"]).returncode == 0

    def _start_radio(self):
        control = self.folder / "control"
        command = [program("radio"), "--loss", str(self._loss), "--seed", str(self._seed), "--control", str(control)]
        command += self._radio_options
        for index, name in enumerate(self.robots):
            command += ["--interface", f"{name}=air{index}"]
        self._radio = subprocess.Popen(command, stdout=subprocess.PIPE, preexec_fn=die_with_parent, text=True)
        assert self._radio.stdout.readline().startswith("radio ready")
        self.radio_control = RadioControl(control)
        for name, (x, y) in self._positions.items():
            self.radio_control.send(f"position {name} {x} {y}")
        names = list(self.robots)
        for i, a in enumerate(names):
            for b in names[i + 1 :]:
                if self._links is not None and (a, b) not in self._links and (b, a) not in self._links:
                    self.radio_control.send(f"link {a} {b} 1")

    def wait_for_robots(self, timeout=20.0):
        """Until every robot knows every other one, over however many hops."""
        for robot in self.robots.values():
            self._wait_for_set(robot, set(self.robots) - {robot.name}, timeout)

    @staticmethod
    def _wait_for_set(robot, others, timeout):
        def knows_all():
            return set(robot.agent.ask(do="status").get("robots", [])) >= others

        wait_until(knows_all, timeout, f"{robot.name} knows {others}")

    def wait_for_neighbors(self, name, neighbors, timeout=20.0):
        """Until a robot hears exactly these robots."""
        agent = self.robots[name].agent

        def hears_them():
            return set(agent.call("get_neighbors").get("response", {}).get("neigbors", [])) == neighbors

        wait_until(hears_them, timeout, f"{name} hears {neighbors}")


class RadioControl:
    """The control socket of the radio daemon."""

    def __init__(self, path):
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._socket.settimeout(5)
        self._socket.connect(str(path))

    def send(self, command):
        self._socket.send(command.encode())

    def close(self):
        self._socket.close()

    def statistics(self):
        self._socket.send(b"statistics")
        return json.loads(self._socket.recv(1 << 20))


def cpu_seconds(pid):
    """Processor time of a process so far, all threads."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
