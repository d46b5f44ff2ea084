"""Namespaces on the radio that carry the kernel's IP, by a TAP device each."""

import json
import subprocess

from engine_hosts import Hosts
from namespaces import TEST_FOLDER, program

PORT = 5000
SETTINGS = [
    "net/ipv4/ip_forward=1", "net/ipv4/conf/all/send_redirects=0", "net/ipv4/conf/all/rp_filter=0",
    "net/ipv4/conf/default/send_redirects=0", "net/ipv4/conf/default/rp_filter=0",
]  # fmt: skip


def address(index):
    return f"10.9.0.{index + 1}"


class IpHosts(Hosts):
    """Routes are up to the subclass."""

    @staticmethod
    def run_lines(host, lines):
        done = host.run(["sh", "-ec", "\n".join(lines)])
        assert done.returncode == 0, done.stderr

    def set_up(self, host, *settings):
        """Before its carrier is started. `settings`: further ones of the kernel."""
        pairs = (setting.split("=") for setting in (*SETTINGS, *settings))
        self.run_lines(host, [f"echo {value} > /proc/sys/{name}" for name, value in pairs])

    def start_carrier(self, index):
        """The process without which the robot is silent."""
        host = self.hosts[index]
        carrier = host.start([program("tap_over_link"), "tap0", "radio0"], stdout=subprocess.PIPE, text=True)
        assert carrier.stdout.readline() == "ready\n"
        self.run_lines(host, [f"ip address add {address(index)}/32 dev tap0", "ip link set tap0 mtu 1498 up"])
        return carrier

    @staticmethod
    def kill(process):
        process.kill()
        process.wait()
        if process.stdout is not None:
            process.stdout.close()

    def start_peer(self, index, *words):
        command = ["/usr/bin/python3", str(TEST_FOLDER / "ip_peer.py"), *map(str, words)]
        return self.hosts[index].start(command, stdout=subprocess.PIPE, text=True)

    @staticmethod
    def answer_of(peer):
        return json.loads(peer.stdout.readline())
