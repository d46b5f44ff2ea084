"""A live view of the radio: neighbours, routes, groups, relays and traffic, from adhoc_communication/network_state."""

import argparse
import contextlib
import sys
import time
from typing import Any, Dict, Iterable, List, Optional, Sequence, Tuple

import rosgraph
import rospy

from adhoc_communication.msg import NetworkState

try:
    from rich.console import Console, Group
    from rich.live import Live
    from rich.markup import escape
    from rich.table import Table

    RICH = True
except ImportError:  # the plain lines need nothing
    RICH = False

TYPE = "adhoc_communication/NetworkState"
LATE = 3.0  # s without a message
# As docs/protocol.md numbers them.
FRAME_TYPES = (
    "", "beacon", "route request", "route reply", "route error", "hop acknowledgment", "data",
    "transport acknowledgment", "broadcast data", "flood", "activation", "refusal", "group data", "group report",
    "route reply acknowledgment", "group receipts",
)  # fmt: skip

Told = Tuple[float, NetworkState, Optional[NetworkState]]  # when it came, and the one before
Cells = Sequence[object]
Rows = Tuple[str, Cells, Sequence[Cells]]  # a table: title, columns, rows
Section = Tuple[str, List[str], List[Rows]]  # of a robot: title, lines of facts, tables


class View:
    """The last states of every robot shown."""

    def __init__(self, topics: Sequence[str]) -> None:
        self._last: Dict[str, Told] = {}
        self._subscribers = [rospy.Subscriber(topic, NetworkState, self._store, topic) for topic in topics]

    def _store(self, state: NetworkState, topic: str) -> None:
        previous = self._last.get(topic)
        self._last[topic] = (time.monotonic(), state, previous[1] if previous else None)

    def complete(self) -> bool:
        return len(self._last) == len(self._subscribers)

    def sections(self) -> List[Section]:
        """Of each robot."""
        return [section(*self._last[topic]) for topic in sorted(self._last)]


def octets(count: float) -> str:
    for unit in ("B", "kB", "MB", "GB"):
        if count < 1000 or unit == "GB":
            break
        count /= 1000
    return f"{count:.0f} {unit}" if unit == "B" else f"{count:.1f} {unit}"


def rate(state: NetworkState, previous: Optional[NetworkState], name: str) -> str:
    """Octets per second between two states; nothing for the first state and after a restart."""
    if previous is None or getattr(state, name) < getattr(previous, name):
        return "-"
    seconds = (state.stamp - previous.stamp).to_sec()
    return octets((getattr(state, name) - getattr(previous, name)) / seconds) + "/s" if seconds > 0 else "-"


def dropped(state: NetworkState) -> str:
    names = ("malformed", "unsealed", "without_key", "forged", "replayed", "reflected", "unproven")
    counts = {name: getattr(state, f"frames_{name}") for name in names}
    return ", ".join(f"{count} {name.replace('_', ' ')}" for name, count in counts.items() if count) or "none"


def facts(received: float, state: NetworkState, previous: Optional[NetworkState]) -> List[str]:
    age = time.monotonic() - received
    lines = [
        f"sent {octets(state.bytes_sent)} ({rate(state, previous, 'bytes_sent')}), "
        f"received {octets(state.bytes_received)} ({rate(state, previous, 'bytes_received')}); "
        f"packets {state.packets_sent} sent, {state.packets_failed} failed, "
        f"{sum(state.packets_received_by_hops)} received",
        f"waiting: {state.packets_waiting} packets ({octets(state.octets_waiting)}) to send, "
        f"{state.packets_to_publish} to publish; frames dropped: {dropped(state)}",
    ]
    losses = {
        "packets not published": state.packets_not_published,
        "log rows lost": state.log_rows_lost,
        "frames not captured": state.frames_not_captured,
        "frames not taken by the interface": state.frames_not_sent,
        "frames missed while the interface's queue was full": state.frames_missed,
    }
    lines += [f"{count} {what}" for what, count in losses.items() if count]
    if age > LATE:
        lines.append(f"no message for {age:.0f} s: has the node ended?")
    return lines


def section(received: float, state: NetworkState, previous: Optional[NetworkState]) -> Section:
    interface = f"{state.interface} {'up' if state.interface_up else 'DOWN'}"
    title = f"{state.robot_name} on {interface}, {state.address}, {'sealed' if state.sealed else 'OPEN'}"
    tables = [neighbors(state), routes(state), groups(state)]
    if state.relays:
        tables.append(relays(state))
    tables.append(frames(state, previous))
    return title, facts(received, state, previous), tables


def neighbors(state: NetworkState) -> Rows:
    columns = ("neighbour", "address", "both ways", "loss", "waiting", "in flight", "given up", "silent")
    rows = [
        (link.robot or "?", link.address, "yes" if link.two_way else "NO", f"{100 * link.loss:.0f} %", link.waiting,
         link.in_flight, link.given_up, f"{link.silent_for:.1f} s")
        for link in state.links
    ]  # fmt: skip
    return "neighbours", columns, rows


def routes(state: NetworkState) -> Rows:
    columns = ("destination", "next hop", "hops", "cost", "state", "number", "used by")
    rows = [
        (route.destination, route.next_hop, route.hops, f"{route.cost:.1f}",
         f"{route.expires_in:.1f} s" if route.valid else "broken", route.sequence_number, route.precursors)
        for route in state.routes
    ]  # fmt: skip
    return "routes", columns, rows


def groups(state: NetworkState) -> Rows:
    def standing(group: Any) -> str:
        if group.root:
            return "root"
        if group.joining:
            return "joining"
        return "member" if group.member else "-"

    columns = ("group", "as", "connected", "uplink", "downlinks")
    rows = [
        (group.group, standing(group), "yes" if group.connected else "no", group.uplink, " ".join(group.downlinks))
        for group in state.groups
    ]
    return "groups", columns, rows


def relays(state: NetworkState) -> Rows:
    columns = ("relayed topic", "to", "type", "priority", "waiting", "delivered", "dropped", "failed")
    rows = [
        (relay.topic, relay.destination or "all", relay.type or "-", relay.priority, relay.waiting, relay.delivered,
         relay.dropped, relay.failed)
        for relay in state.relays
    ]  # fmt: skip
    return "relays", columns, rows


def frames(state: NetworkState, previous: Optional[NetworkState]) -> Rows:
    """By type, those that there are; per second since the state before."""

    def per_second(name: str, kind: int) -> str:
        if previous is None:
            return "-"
        before, seconds = getattr(previous, name), (state.stamp - previous.stamp).to_sec()
        new = getattr(state, name)[kind] - (before[kind] if kind < len(before) else 0)
        return f"{new / seconds:.1f}/s" if seconds > 0 and new >= 0 else "-"

    sent, received = state.frames_sent_by_type, state.frames_received_by_type
    rows = [
        (
            FRAME_TYPES[kind] if kind < len(FRAME_TYPES) else f"type {kind}",
            sent[kind],
            per_second("frames_sent_by_type", kind),
            received[kind],
            per_second("frames_received_by_type", kind),
        )
        for kind in range(min(len(sent), len(received)))
        if sent[kind] or received[kind]
    ]
    return "frames", ("frames", "sent", "now", "received", "now"), rows


def printable(text: object) -> str:
    """Names that come from the air must not drive the terminal."""
    return "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in str(text))


def plain_table(title: str, columns: Cells, rows: Sequence[Cells]) -> List[str]:
    if not rows:
        return [f"  no {title}"]
    cells = [[printable(cell) for cell in row] for row in (columns, *rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(columns))]
    return ["  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in cells]


def plain(sections: Iterable[Section]) -> str:
    lines: List[str] = []
    for title, facts_of_robot, tables in sections:
        lines += [printable(title), *(f"  {fact}" for fact in facts_of_robot)]
        for table in tables:
            lines += plain_table(*table)
    return "\n".join(lines)


def rich_table(title: str, columns: Cells, rows: Sequence[Cells]) -> "Table":
    table = Table(title=title, title_justify="left", title_style="bold", expand=False)
    for column in columns:
        table.add_column(str(column))
    for row in rows:
        table.add_row(*(escape(printable(cell)) for cell in row))
    return table


def rich_view(sections: Iterable[Section]) -> "Group":
    parts: List[Any] = []
    for title, facts_of_robot, tables in sections:
        parts += [escape(printable(title)), *facts_of_robot]
        parts += [rich_table(*table) if table[2] else f"no {table[0]}" for table in tables]
    return Group(*parts)


def published_topics() -> List[str]:
    """Topics of nodes that tell the state of their radio; exits with a sentence when there are none."""
    try:
        topics = [name for name, kind in rosgraph.Master("/adhoc_top").getPublishedTopics("") if kind == TYPE]
    except (rosgraph.MasterException, OSError):
        sys.exit(f"no ROS master answers at {rosgraph.get_master_uri()}: start roscore or set ROS_MASTER_URI")
    if not topics:
        sys.exit(f"no node publishes {TYPE}: is adhoc_communication running on the master {rosgraph.get_master_uri()}?")
    return topics


def wait_for_states(view: View, seconds: float) -> bool:
    end = time.monotonic() + seconds
    while not view.complete() and time.monotonic() < end and not rospy.is_shutdown():
        time.sleep(0.05)
    return bool(view.sections())


def show_live(view: View, interval: float) -> None:
    if not RICH or not sys.stdout.isatty():
        while not rospy.is_shutdown():
            print(plain(view.sections()), end="\n\n", flush=True)
            time.sleep(interval)
        return
    with Live(rich_view(view.sections()), console=Console(), screen=True, auto_refresh=False) as live:
        while not rospy.is_shutdown():
            live.update(rich_view(view.sections()), refresh=True)
            time.sleep(interval)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("topic", nargs="*", help=f"topics of type {TYPE}; default: all on this master")
    parser.add_argument("--once", action="store_true", help="print the state and end")
    parser.add_argument("--interval", type=float, default=1.0, metavar="SECONDS", help="between two views (default 1)")
    parser.add_argument("--timeout", type=float, default=5.0, metavar="SECONDS", help="to wait for a state (default 5)")
    return parser.parse_args(rospy.myargv(sys.argv)[1:])


def main() -> None:
    options = arguments()
    known = published_topics()
    topics = [rosgraph.names.resolve_name(topic, "/adhoc_top") for topic in options.topic] or known
    for topic in topics:
        if topic not in known:
            sys.exit(f"no node publishes {TYPE} on {topic} (there are: {', '.join(sorted(known))})")
    rospy.init_node("adhoc_top", anonymous=True, disable_signals=True)
    view = View(topics)
    if not wait_for_states(view, options.timeout):
        sys.exit(f"nothing arrived on {', '.join(topics)} within {options.timeout:g} s: does the node still run?")
    if options.once:
        print(plain(view.sections()))
        return
    with contextlib.suppress(KeyboardInterrupt):
        show_live(view, max(options.interval, 0.1))
