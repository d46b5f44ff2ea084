"""A chain of namespaces on the radio that carries either the kernel's IP with static routes, or engine hosts."""

import json

from ip_hosts import PORT, IpHosts, address


class IpChain(IpHosts):
    """Starts with IP; start_hosts() ends that and starts the engine hosts. Use as a context manager."""

    def __init__(self, hops, **options):
        names = [f"robot_{index}" for index in range(hops + 1)]
        super().__init__(names, links=list(zip(names, names[1:])), **options)
        self._carriers = []

    def _start_robots(self):
        for index, host in enumerate(self.hosts):
            self.set_up(host, "net/ipv6/conf/all/disable_ipv6=1", "net/ipv6/conf/default/disable_ipv6=1")
            self._carriers.append(self.start_carrier(index))
        links = [json.loads(host.run(["ip", "-json", "link", "show", "tap0"]).stdout)[0] for host in self.hosts]
        for index, host in enumerate(self.hosts):
            self._set_up_routes(index, host, [link["address"] for link in links])

    def _set_up_routes(self, index, host, addresses):
        lines = []
        for neighbor in (index - 1, index + 1):
            if 0 <= neighbor < len(addresses):
                lines.append(f"ip neighbor replace {address(neighbor)} lladdr {addresses[neighbor]} dev tap0")
                lines.append(f"ip route add {address(neighbor)} dev tap0")
        for other in range(len(addresses)):
            if abs(other - index) > 1:
                towards = index + (1 if other > index else -1)
                lines.append(f"ip route add {address(other)} via {address(towards)} dev tap0 onlink")
        self.run_lines(host, lines)

    def send_by_tcp(self, octets, limit):
        """Seconds from the connection request to the last octet at the other end, None if not intact by the limit."""
        with self.start_peer(-1, "tcp-receive", PORT, limit) as receiver:
            self.answer_of(receiver)
            with self.start_peer(0, "tcp-send", address(len(self.hosts) - 1), PORT, octets, limit) as sender:
                received = self.answer_of(receiver)
                if received["octets"] < octets:
                    sender.terminate()
                    return None
                sent = self.answer_of(sender)
        return received["time"] - sent["begin"] if received["digest"] == sent["digest"] else None

    def send_by_udp(self, octets, rate, limit=20):
        """Share of the datagrams that arrive."""
        with self.start_peer(-1, "udp-receive", PORT, limit) as receiver:
            self.answer_of(receiver)
            with self.start_peer(0, "udp-send", address(len(self.hosts) - 1), PORT, octets, rate) as sender:
                sent = self.answer_of(sender)
                received = self.answer_of(receiver)
        return received["datagrams"] / sent["datagrams"]

    def start_hosts(self):
        for carrier in self._carriers:
            self.kill(carrier)
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
