"""Measures delivery, repair and idle load between ROS masters in network namespaces; each row is written as it comes.

    bench_namespaces [--out FILE] [--only maps|repair|idle|babel] [--maps N] [--kills N]

Each row: {what, bar, value, unit, holds, detail}. Maps are 1 MB OccupancyGrids of random octets, which do not compress.
Repair beside babeld is measured only where it is asked for: each death takes about a minute.
"""

import argparse
import shutil
import statistics
import sys
import time
from pathlib import Path

from babel_diamond import LINKS, NAMES, BabelDiamond
from benchmark_rows import Rows
from namespaces import Team, Unavailable, cpu_seconds, enter_own_network

CELLS = 1000


def chain(hops):
    names = [f"robot_{index}" for index in range(hops + 1)]
    return names, list(zip(names, names[1:]))


def row(what, bar, value, unit, holds, detail):
    return {"what": what, "bar": bar, "value": value, "unit": unit, "holds": holds, "detail": detail}


def measure_maps(hops, loss, count):
    names, links = chain(hops)
    intact, times, errors = 0, [], []
    with Team(names, loss=loss, links=links, seed=hops) as team:
        team.wait_for_robots()
        sender, receiver = team[names[0]].agent, team[names[-1]].agent
        receiver.listen("map_from_afar")
        for number in range(count):
            sent = sender.ask(
                timeout=120, do="send_map", dst_robot=names[-1], topic="map_from_afar", seed=number, cells=CELLS
            )
            if sent["error"]:
                errors.append(sent["error"])
                continue
            received = receiver.next_message()
            intact += received["md5"] == sent["md5"]
            times.append(received["time"] - sent["begin"])
    detail = f"{hops} hop, loss {loss:.0%}; call to topic: " + (
        f"median {statistics.median(times):.2f} s, max {max(times):.2f} s" if times else "none"
    )
    return row(
        f"1 MB map, {hops} hop, loss {loss:.0%}", f"{count} of {count}", intact, "maps", intact == count,
        detail + (f"; errors: {errors[:3]}" if errors else ""),
    )  # fmt: skip


def relay_in_use(team):
    """The relay that transmits more while traffic flows."""
    before = team.radio_control.statistics()["robots"]
    time.sleep(0.5)
    after = team.radio_control.statistics()["robots"]
    return max(("robot_1", "robot_2"), key=lambda name: after[name]["frames"] - before[name]["frames"])


def measure_one_repair(team):
    """Seconds from the kill of the relay in use to the next message at the destination."""
    streaming = team["robot_0"].agent.begin(do="stream", dst_robot="robot_3", topic="count", seconds=4.0)
    destination = team["robot_3"].agent
    destination.next_message()
    relay = team[relay_in_use(team)]
    relay.node.kill()
    killed = time.monotonic()
    counts = streaming.get(timeout=30)
    arrivals = [killed]
    while not destination.messages.empty():
        arrivals.append(max(killed, destination.next_message()["time"]))
    arrivals.sort()
    longest = max(later - earlier for earlier, later in zip(arrivals, arrivals[1:])) if len(arrivals) > 1 else 1e9
    relay.start_node(interface="radio0")
    relay.agent.ask(do="ready")
    return longest, counts["failed"]


def repairs(count):
    """The gap of each death, s, and how many sends failed in all."""
    gaps, failed = [], 0
    with Team(NAMES, links=LINKS) as team:
        team.wait_for_robots()
        team["robot_3"].agent.listen("count")
        for _ in range(count):
            gap, failures = measure_one_repair(team)
            gaps.append(gap)
            failed += failures
            team.wait_for_robots()
            for end in ("robot_0", "robot_3"):
                team.wait_for_neighbors(end, {"robot_1", "robot_2"})
    return gaps, failed


def measure_repairs(count):
    gaps, failed = repairs(count)
    worst = max(gaps)
    detail = f"{count} kills, median {statistics.median(gaps):.3f} s, failed sends {failed}"
    return row("relay killed, other path exists", "<= 1 s", round(worst, 3), "s, worst", worst <= 1.0, detail)


def measure_repairs_beside_babel(count):
    """The same diamond with IP and babeld, and with us."""
    with BabelDiamond() as diamond:
        diamond.wait_for_routes()
        babel = [diamond.measure_one_repair() for _ in range(count)]
    ours, _ = repairs(count)
    own, peer = statistics.median(ours), statistics.median(babel)
    most = min(0.3, peer / 5.0)
    return row(
        "relay killed, other path exists, beside babeld: median", f"<= {most:.3g} s", round(own, 3), "s", own <= most,
        f"babeld median {peer:.1f} s, {min(babel):.1f} to {max(babel):.1f} s; {count} kills each",
    )  # fmt: skip


def measure_idle(seconds=20.0):
    names = ["robot_0", "robot_1", "robot_2"]
    with Team(names) as team:
        team.wait_for_robots()
        pid = team["robot_1"].node.pid
        begin, before = time.monotonic(), cpu_seconds(pid)
        time.sleep(seconds)
        share = 100.0 * (cpu_seconds(pid) - before) / (time.monotonic() - begin)
    return row(
        "idle adhoc_communication, two neighbours", "<= 1 %", round(share, 2), "% of a core", share <= 1.0,
        f"processor time over {seconds:.0f} s",
    )  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, help="file for the rows as JSON")
    parser.add_argument("--only", choices=["maps", "repair", "idle", "babel"])
    parser.add_argument("--maps", type=int, default=20, help="maps per case (default: %(default)s)")
    parser.add_argument("--kills", type=int, default=10, help="relays killed (default: %(default)s)")
    arguments = parser.parse_args()
    if arguments.only == "babel" and shutil.which("babeld") is None:
        sys.exit("bench_namespaces: babeld is not installed; tools/install_dependencies babel installs it")
    try:
        enter_own_network()
    except Unavailable as reason:
        sys.exit(f"bench_namespaces: {reason}")
    rows = Rows(arguments.out)
    if arguments.only in (None, "idle"):
        rows.add(measure_idle())
    if arguments.only in (None, "repair"):
        rows.add(measure_repairs(arguments.kills))
    if arguments.only == "babel":
        rows.add(measure_repairs_beside_babel(arguments.kills))
    if arguments.only in (None, "maps"):
        for hops in (1, 3):
            for loss in (0.0, 0.1, 0.3):
                rows.add(measure_maps(hops, loss, arguments.maps))
    return rows.status()
