"""Two ends and two relays between them on the radio, which carry the kernel's IP with routes that babeld finds."""

import json

from ip_hosts import PORT, IpHosts, address
from namespaces import wait_until

NAMES = ["robot_0", "robot_1", "robot_2", "robot_3"]
LINKS = [("robot_0", "robot_1"), ("robot_0", "robot_2"), ("robot_1", "robot_3"), ("robot_2", "robot_3")]
ENDS, RELAYS = (0, 3), (1, 2)


class BabelDiamond(IpHosts):
    """Use as a context manager. babeld runs as it comes, on an interface of type wireless."""

    def __init__(self, **options):
        super().__init__(NAMES, links=LINKS, **options)
        self._running = {}  # by host: what carries its frames, and babeld

    def _start_robots(self):
        for index, host in enumerate(self.hosts):
            self.run_lines(host, ["ip link set lo up"])
            self.set_up(host, "net/ipv6/conf/default/accept_dad=0")
            self._revive(index)

    def _revive(self, index):
        host, carrier = self.hosts[index], self.start_carrier(index)
        process, state = (self.folder / f"{host.name}.{kind}" for kind in ("pid", "state"))
        process.unlink(missing_ok=True)  # of one that was killed, as which it would not begin
        babeld = ["babeld", "-I", str(process), "-S", str(state), "-C", "interface tap0 type wireless"]
        self._running[index] = [carrier, host.start(babeld)]

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
        """Seconds without a datagram after the relay in use has died silently, `limit` if none comes by then."""
        relay = next(index for index in RELAYS if address(index) == self._via(*ENDS))
        receiver = self.start_peer(ENDS[1], "udp-longest-gap", PORT, limit)
        assert self.answer_of(receiver)["ready"]
        sender = self.start_peer(ENDS[0], "udp-tick", address(ENDS[1]), PORT, limit + 5.0)
        assert "first" in self.answer_of(receiver)
        for process in self._running[relay]:
            self.kill(process)
        gap = self.answer_of(receiver)["gap"]
        for process in (sender, receiver):
            self.kill(process)
        self._revive(relay)
        self.wait_for_routes()
        return gap
