"""Measures engine hosts without ROS between network namespaces, on plain veth and on the radio, and beside TCP and UDP.

    bench_hosts [--out FILE] [--only relay|chain|clean|peers] [--seconds S] [--pairs N] [--packets N] [--clean N]
                [--trials N]

Each row, {what, bar, value, unit, holds, detail}, is written as it comes. Works as root and in an unprivileged user
namespace; everything ends with the program.
"""

import argparse
import statistics
import sys
import time
from pathlib import Path

from benchmark_rows import Rows
from engine_hosts import Hosts, HostsOnCables
from ip_chain import IpChain
from namespaces import Unavailable, enter_own_network

KEY = "5b" * 32
PAYLOAD = 1400  # octets in each data frame of an engine host
PACKET = 1_000_000
TCP_LIMIT = 60.0  # s
UDP_RATE = 30e6  # bit/s, below what the radio carries


def row(what, bar, value, unit, holds, detail):
    return {"what": what, "bar": bar, "value": value, "unit": unit, "holds": holds, "detail": detail}


def measure_relay(pairs, seconds):
    """One node relays sealed streams of full frames over veth; its rate over the wall and over its own processor."""
    with HostsOnCables([f"robot_{index}" for index in range(2 * pairs + 1)], key=KEY) as team:
        team.wait_for_robots()
        relay, senders, destinations = team.hosts[0], team.hosts[1::2], team.hosts[2::2]
        heard = relay.look()["neighbors"]
        assert len(heard) == 2 * pairs and all(host.look()["neighbors"] == [relay.name] for host in senders)
        for sender, destination in zip(senders, destinations):
            sender.tell(f"stream {destination.name} {PACKET} {seconds}")
        time.sleep(0.2 * seconds)
        begin, before = sum(host.look()["octets"] for host in destinations), relay.look()
        time.sleep(0.6 * seconds)
        end, after = sum(host.look()["octets"] for host in destinations), relay.look()
        failed = sum(sender.answer("streamed", seconds + 60)["failed"] for sender in senders)
    frames = (end - begin) / PAYLOAD
    wall, user, system = (after[name] - before[name] for name in ("time", "user", "system"))
    cpu = user + system
    rate = frames / cpu
    all_frames = sum(after[name] - before[name] for name in ("frames_sent", "frames_received"))
    return row(
        "one node relays, sealed, 1400 B, veth, per second of its processor time", ">= 50000", round(rate), "frames/s",
        rate >= 50000,
        f"{pairs} pairs: {frames / wall:.0f} frames/s by the wall, relay busy {cpu / wall:.0%} of a core, "
        f"{user / cpu:.0%} of that outside the kernel, "
        f"{all_frames / frames:.2f} frames in and out for each relayed, failed packets {failed}",
    )  # fmt: skip


def measure_chain(hops, loss, count):
    """Packets one after another over a chain on the radio, each bit for bit and once."""
    names = [f"robot_{index}" for index in range(hops + 1)]
    intact, times, errors = 0, [], []
    with Hosts(names, key=KEY, loss=loss, links=list(zip(names, names[1:])), seed=hops) as team:
        team.wait_for_robots()
        sender, destination = team.hosts[0], team.hosts[-1]
        destination.tell("echo on")
        for number in range(count):
            sent = sender.ask(f"map {destination.name} {PACKET} {number}", "sent", 120)
            if sent["reason"]:
                errors.append(sent["reason"])
                continue
            packet = destination.next_packet()
            intact += packet["digest"] == sent["digest"]
            times.append(packet["time"] - sent["begin"])
        time.sleep(1.0)
        again = destination.look()["received"] - count + len(errors)
    return row(
        f"1 MB, engine hosts, {hops} hops on the radio, loss {loss:.0%}", f"{count} of {count}", intact, "packets",
        intact == count and again == 0,
        (f"median {statistics.median(times):.2f} s, max {max(times):.2f} s" if times else "none")
        + f"; twice: {again}" + (f"; errors: {errors[:3]}" if errors else ""),
    )  # fmt: skip


def median(times):
    """Of seconds, where None is never."""
    return statistics.median(float("inf") if each is None else each for each in times)


def words(seconds):
    return "never" if seconds == float("inf") else f"{seconds:.2f} s, {8e-6 * PACKET / seconds:.1f} Mbit/s"


def measure_peers(hops, loss, trials):
    """1 MB by TCP, as UDP datagrams, and by us, on the same radio in the same run."""
    with IpChain(hops, key=KEY, loss=loss, seed=hops) as chain:
        tcp = [chain.send_by_tcp(PACKET, TCP_LIMIT) for _ in range(trials)]
        udp = [chain.send_by_udp(PACKET, UDP_RATE) for _ in range(trials)]
        chain.start_hosts()
        ours = [chain.send_by_hosts(PACKET, seed) for seed in range(trials)]
    what = f"1 MB, {hops} hop, loss {loss:.0%}"
    own, peer = median(ours), median(tcp)
    spread = ", ".join("never" if each is None else f"{each:.2f}" for each in tcp)
    finite = own if own < float("inf") else 1e9
    return [
        row(
            f"{what}: ours, beside TCP", "<= TCP", round(finite, 3), "s", own <= peer,
            f"ours {words(own)}; TCP {words(peer)} ({spread}; limit {TCP_LIMIT:.0f} s); median of {trials}",
        ),
        row(
            f"{what}: UDP datagrams delivered", "-", round(100 * statistics.mean(udp), 1), "%", True,
            f"ours {sum(each is not None for each in ours)} of {trials} packets whole, "
            f"TCP {sum(each is not None for each in tcp)} of {trials}",
        ),
    ]  # fmt: skip


def measure_clean_hop(trials):
    """1 MB over one hop without loss, by TCP and by us: the first time over a link, and once it is known."""
    times = {(who, link): [] for who in ("tcp", "ours") for link in ("fresh", "known")}
    for trial in range(trials):
        with IpChain(1, key=KEY, loss=0.0, seed=trial) as chain:
            for link in ("fresh", "known"):
                times["tcp", link].append(chain.send_by_tcp(PACKET, TCP_LIMIT))
            chain.start_hosts()
            for seed, link in enumerate(("fresh", "known")):
                times["ours", link].append(chain.send_by_hosts(PACKET, 2 * trial + seed))
    return [clean_hop_row(link, most, times["ours", link], times["tcp", link])
            for link, most in (("fresh", 1.1), ("known", 1.05))]  # fmt: skip


def clean_hop_row(link, most, ours, tcp):
    ratio = median(ours) / median(tcp)
    worst = max(float("inf") if each is None else each for each in ours)
    return row(
        f"1 MB over a clean hop, {link} link, over the time of TCP: median", f"<= {most}",
        round(min(ratio, 1e9), 3), "1", ratio <= most,
        f"ours {words(median(ours))}, worst {words(worst)}; TCP {words(median(tcp))}; {len(ours)} each",
    )  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, help="file for the rows as JSON")
    parser.add_argument("--only", choices=["relay", "chain", "clean", "peers"])
    parser.add_argument("--packets", type=int, default=20, help="over each chain (default: %(default)s)")
    parser.add_argument("--trials", type=int, default=3, help="of each peer (default: %(default)s)")
    parser.add_argument("--clean", type=int, default=10, help="fresh links (default: %(default)s)")
    parser.add_argument("--pairs", type=int, default=4, help="that one node relays for (default: %(default)s)")
    parser.add_argument("--seconds", type=float, default=10.0, help="of relaying (default: %(default)s)")
    arguments = parser.parse_args()
    try:
        enter_own_network()
    except Unavailable as reason:
        sys.exit(f"bench_hosts: {reason}")
    rows = Rows(arguments.out)
    if arguments.only in (None, "relay"):
        rows.add(measure_relay(arguments.pairs, arguments.seconds))
    if arguments.only in (None, "chain"):
        for loss in (0.0, 0.1, 0.3):
            rows.add(measure_chain(10, loss, arguments.packets))
    if arguments.only in (None, "clean"):
        for measured in measure_clean_hop(arguments.clean):
            rows.add(measured)
    if arguments.only in (None, "peers"):
        for hops in (1, 3):
            for loss in (0.0, 0.1, 0.3):
                for measured in measure_peers(hops, loss, arguments.trials):
                    rows.add(measured)
    return rows.status()
