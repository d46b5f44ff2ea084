"""A chain of namespaces on the radio that carries either the kernel's IP with static routes, or engine hosts."""

import json
import subprocess

from engine_hosts import Hosts
from namespaces import TEST_FOLDER, program

PORT = 5000


def address(index):
    return f"10.9.0.{index + 1}"


class IpChain(Hosts):
    """Starts with IP; start_hosts() ends that and starts the engine hosts. Use as a context manager."""

    def __init__(self, hops, **options):
        names = [f"robot_{index}" for index in range(hops + 1)]
        super().__init__(names, links=list(zip(names, names[1:])), **options)
        self._carriers = []

    def _start_robots(self):
        addresses = []
        for host in self.hosts:
            carrier = host.start([program("tap_over_link"), "tap0", "radio0"], stdout=subprocess.PIPE, text=True)
            self._carriers.append(carrier)
            assert carrier.stdout.readline() == "ready\n"
            addresses.append(json.loads(host.run(["ip", "-json", "link", "show", "tap0"]).stdout)[0]["address"])
        for index, host in enumerate(self.hosts):
            self._set_up_ip(index, host, addresses)

    @staticmethod
    def _set_up_ip(index, host, addresses):
        settings = [
            "net/ipv4/ip_forward=1", "net/ipv4/conf/all/send_redirects=0", "net/ipv4/conf/all/rp_filter=0",
            "net/ipv4/conf/tap0/send_redirects=0", "net/ipv4/conf/tap0/rp_filter=0", "net/ipv6/conf/all/disable_ipv6=1",
        ]  # fmt: skip
        lines = [f"echo {value} > /proc/sys/{name}" for name, value in (setting.split("=") for setting in settings)]
        lines += ["ip link set tap0 mtu 1498 up", f"ip address add {address(index)}/32 dev tap0"]
        for neighbor in (index - 1, index + 1):
            if 0 <= neighbor < len(addresses):
                lines.append(f"ip neighbor replace {address(neighbor)} lladdr {addresses[neighbor]} dev tap0")
                lines.append(f"ip route add {address(neighbor)} dev tap0")
        for other in range(len(addresses)):
            if abs(other - index) > 1:
                towards = index + (1 if other > index else -1)
                lines.append(f"ip route add {address(other)} via {address(towards)} dev tap0 onlink")
        done = host.run(["sh", "-ec", "\n".join(lines)])
        assert done.returncode == 0, done.stderr

    def _peer(self, index, *words):
        command = ["/usr/bin/python3", str(TEST_FOLDER / "ip_peer.py"), *map(str, words)]
        return self.hosts[index].start(command, stdout=subprocess.PIPE, text=True)

    @staticmethod
    def _answer(peer):
        line = peer.stdout.readline()
        return json.loads(line)

    def send_by_tcp(self, octets, limit):
        """Seconds from the connection request to the last octet at the other end, None if not intact by the limit."""
        with self._peer(-1, "tcp-receive", PORT, limit) as receiver:
            self._answer(receiver)
            with self._peer(0, "tcp-send", address(len(self.hosts) - 1), PORT, octets, limit) as sender:
                received = self._answer(receiver)
                if received["octets"] < octets:
                    sender.terminate()
                    return None
                sent = self._answer(sender)
        return received["time"] - sent["begin"] if received["digest"] == sent["digest"] else None

    def send_by_udp(self, octets, rate, limit=20):
        """Share of the datagrams that arrive."""
        with self._peer(-1, "udp-receive", PORT, limit) as receiver:
            self._answer(receiver)
            with self._peer(0, "udp-send", address(len(self.hosts) - 1), PORT, octets, rate) as sender:
                sent = self._answer(sender)
                received = self._answer(receiver)
        return received["datagrams"] / sent["datagrams"]

    def start_hosts(self):
        for carrier in self._carriers:
            carrier.kill()
            carrier.wait()
            carrier.stdout.close()
        super()._start_robots()
        self.wait_for_robots()
        self.hosts[-1].tell("echo on")

    def send_by_hosts(self, octets, seed):
        """Seconds from the request to the whole packet at the other end, None if it did not arrive intact."""
        sent = self.hosts[0].ask(f"map {self.hosts[-1].name} {octets} {seed}", "sent", 120)
        if sent["reason"]:
            return None
        packet = self.hosts[-1].next_packet()
        return packet["time"] - sent["begin"] if packet["digest"] == sent["digest"] else None
