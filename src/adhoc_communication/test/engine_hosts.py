"""Robots without ROS for benchmarks: an engine host in a network namespace each, on plain cables or on the radio."""

import json
import queue
import subprocess
import threading

from namespaces import Robot, Team, program, wait_until


class Host(Robot):
    """A namespace with an engine host."""

    def __init__(self, name, folder):
        super().__init__(name, folder)
        self._answers = {kind: queue.Queue() for kind in ("sent", "streamed", "look", "packet")}
        self.process = None

    def start_host(self, interface="radio0", key=None):
        self.process = self.start(
            [program("engine_host"), self.name, interface, *([key] if key else [])],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1,
        )  # fmt: skip
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        for line in self.process.stdout:
            for kind, answer in json.loads(line).items():
                self._answers[kind].put(answer)

    def tell(self, command):
        self.process.stdin.write(command + "\n")

    def ask(self, command, kind, timeout=60.0):
        """Send a command and return its answer."""
        self.tell(command)
        return self.answer(kind, timeout)

    def answer(self, kind, timeout=60.0):
        return self._answers[kind].get(timeout=timeout)

    def look(self):
        return self.ask("look", "look")

    def next_packet(self, timeout=60.0):
        """The next packet received, after the command `echo on`."""
        return self.answer("packet", timeout)

    def stop(self):
        super().stop()
        if self.process is not None:
            self._reader.join()
            self.process.stdin.close()
            self.process.stdout.close()


class Hosts(Team):
    """Engine hosts on the radio. Use as a context manager."""

    robot_class = Host

    def __init__(self, names, key=None, **options):
        super().__init__(names, **options)
        self._key = key

    @property
    def hosts(self):
        return list(self.robots.values())

    def _start_robots(self):
        for host in self.hosts:
            host.start_host(self._interface, self._key)

    def wait_for_robots(self, timeout=60.0):
        """Until each knows all others, over however many hops."""
        for host in self.hosts:
            others = {other.name for other in self.hosts} - {host.name}
            wait_until(lambda: others <= set(host.look()["robots"]), timeout, f"{host.name} knows {others}")  # noqa: B023


class HostsOnCables(Hosts):
    """The first host hears all, and the others hear only it: a bridge with isolated ports, and no radio."""

    def _lay_cables(self):
        subprocess.run(["ip", "link", "add", "cables", "type", "bridge", "mcast_snooping", "0"], check=True)
        subprocess.run(["ip", "link", "set", "cables", "up"], check=True)
        super()._lay_cables()
        for index in range(len(self.hosts)):
            subprocess.run(["ip", "link", "set", f"air{index}", "master", "cables"], check=True)
            isolated = "off" if index == 0 else "on"
            port = ["ip", "link", "set", "dev", f"air{index}", "type", "bridge_slave", "isolated", isolated]
            subprocess.run(port, check=True)

    def _start_radio(self):
        pass

    def __exit__(self, *details):
        super().__exit__(*details)
        subprocess.run(["ip", "link", "del", "cables"], check=False)
