"""Two ends and two relays between them on the radio, which carry the kernel's IP with routes that babeld finds."""

import json
import subprocess
import time

from engine_hosts import Hosts
from ip_chain import PORT, address
from namespaces import TEST_FOLDER, program, wait_until

NAMES = ["robot_0", "robot_1", "robot_2", "robot_3"]
LINKS = [("robot_0", "robot_1"), ("robot_0", "robot_2"), ("robot_1", "robot_3"), ("robot_2", "robot_3")]
ENDS, RELAYS = (0, 3), (1, 2)
SETTINGS = [
    "net/ipv4/ip_forward=1", "net/ipv4/conf/all/send_redirects=0", "net/ipv4/conf/all/rp_filter=0",
    "net/ipv4/conf/default/send_redirects=0", "net/ipv4/conf/default/rp_filter=0",
    "net/ipv6/conf/default/accept_dad=0",
]  # fmt: skip


class BabelDiamond(Hosts):
    """Use as a context manager. babeld runs as it comes, on an interface of type wireless."""

    def __init__(self, **options):
        super().__init__(NAMES, links=LINKS, **options)
        self._running = {}  # by host: what carries its frames, and babeld

    def _start_robots(self):
        for index, host in enumerate(self.hosts):
            lines = [f"echo {value} > /proc/sys/{name}" for name, value in (each.split("=") for each in SETTINGS)]
            done = host.run(["sh", "-ec", "\n".join(["ip link set lo up", *lines])])
            assert done.returncode == 0, done.stderr
            self.revive(index)

    def revive(self, index):
        host = self.hosts[index]
        carrier = host.start([program("tap_over_link"), "tap0", "radio0"], stdout=subprocess.PIPE, text=True)
        assert carrier.stdout.readline() == "ready\n"
        done = host.run(["sh", "-ec", f"ip address add {address(index)}/32 dev tap0; ip link set tap0 mtu 1498 up"])
        assert done.returncode == 0, done.stderr
        process, state = (self.folder / f"{host.name}.{kind}" for kind in ("pid", "state"))
        process.unlink(missing_ok=True)  # of one that was killed, as which it would not begin
        babeld = ["babeld", "-I", str(process), "-S", str(state), "-C", "interface tap0 type wireless"]
        self._running[index] = [carrier, host.start(babeld)]

    def kill(self, index):
        """From one moment to the next nothing comes from it any more."""
        for process in self._running[index]:
            process.kill()
            process.wait()
        self._running[index][0].stdout.close()

    def wait_for_routes(self, timeout=120.0):
        """Until all robots know ways to all others, and relays direct ones to the ends."""

        def known():
            return all(self._via(a, b) is not None for a in range(4) for b in range(4) if a != b) and all(
                self._via(relay, end) == address(end) for relay in RELAYS for end in ENDS
            )

        wait_until(known, timeout, "routes by babeld")

    def _via(self, index, other):
        """The next hop from a robot to another one, None without a route."""
        routes = json.loads(self.hosts[index].run(["ip", "-json", "route", "show", address(other)]).stdout or "[]")
        return routes[0].get("gateway", address(other)) if routes else None

    def measure_one_repair(self, limit=60.0):
        """Seconds without a datagram after the relay in use has died."""
        relay = next(index for index in RELAYS if address(index) == self._via(ENDS[0], ENDS[1]))
        peer = ["/usr/bin/python3", str(TEST_FOLDER / "ip_peer.py")]
        receiver = self.hosts[ENDS[1]].start(
            [*peer, "udp-longest-gap", str(PORT), str(limit)], stdout=subprocess.PIPE, text=True
        )
        assert json.loads(receiver.stdout.readline())["ready"]
        sender = self.hosts[ENDS[0]].start([*peer, "udp-tick", address(ENDS[1]), str(PORT), str(limit + 5.0)])
        json.loads(receiver.stdout.readline())  # the first datagram
        time.sleep(1.0)
        self.kill(relay)
        gap = json.loads(receiver.stdout.readline())["gap"]
        for process in (sender, receiver):
            process.terminate()
            process.wait()
        receiver.stdout.close()
        self.revive(relay)
        self.wait_for_routes()
        return gap
