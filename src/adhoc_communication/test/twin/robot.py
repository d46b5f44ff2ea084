"""One robot as docs/protocol.md describes it, without groups. No I/O and no clock: times are int ns from the host."""

import random
from collections import defaultdict
from typing import Any, Callable, Dict, List, Optional, Set, Tuple

import frames
from frames import EVERYBODY, NOBODY, Fields

MS = 1_000_000
BEACON, REQUEST, REPLY, ERROR, HOP_ACKNOWLEDGMENT, DATA, ACKNOWLEDGMENT, REPLY_ACKNOWLEDGMENT = (*range(1, 8), 14)
SEGMENT = 1386  # fills a frame of 1500 octets with its Ethernet header
Route = Tuple[bytes, bytes, int, int, int]  # next hop, boot tag, sequence, cost, end


def is_newer(a: int, b: int) -> bool:
    return 0 < (a - b) % 2**32 < 2**31


class Link:
    """The hop to one run of a neighbour: frames on their way until acknowledged, and what has arrived from there."""

    def __init__(self, boot_id: bytes, first: int) -> None:
        self.boot_id, self.heard, self.listed, self.patience = boot_id, 0, -(10**18), 2000 * MS
        self.first = 0  # counter of the frame that proved the run to be alive
        self.counters: Set[int] = set()  # taken
        self.waiting: List[Tuple[int, int, Fields]] = []  # priority, type, fields
        self.flight: Dict[int, List[Any]] = {}  # type, fields, transmissions, counter and end of the last one's timer
        self.next, self.since = first, 0
        self.received: Set[int] = set()
        self.highest, self.newest, self.arrival, self.spacing, self.owed, self.due = 0, 0, 0, 0, 0, 0

    def next_frame(self, counter: int, now: int) -> Optional[Tuple[int, int, Fields]]:
        """Link sequence, type and fields of what goes out with this counter."""
        self.flight = {s: f for s, f in self.flight.items() if f[2] <= 10 or f[4] > now}
        sequence = next((s for s, f in self.flight.items() if f[4] <= now), None)
        if sequence is None:
            if not self.waiting or len(self.flight) >= 16 or self.next - min(self.flight, default=self.next) >= 64:
                return None
            self.waiting.sort(key=lambda item: item[0])
            self.since = self.since if self.flight else now
            sequence, self.next = self.next, self.next + 1
            self.flight[sequence] = [*self.waiting.pop(0)[1:], 0, 0, 0]
        flight = self.flight[sequence]
        flight[2:] = flight[2] + 1, counter, now + 50 * MS
        return sequence, flight[0], flight[1]

    def acknowledged(self, fields: Fields, now: int) -> None:
        bits = int.from_bytes(fields["received"], "big")
        behind = {s: (fields["highest"] - s) % 2**32 for s in self.flight}
        self.flight = {s: f for s, f in self.flight.items() if behind[s] >= 64 or not bits >> behind[s] & 1}
        for flight in self.flight.values():
            flight[4] = now if flight[3] <= fields["newest_counter"] else flight[4]

    def take(self, header: Fields, now: int) -> bool:
        """False for a repetition."""
        sequence, counter = header["link_sequence"], header["counter"]
        gap = bool(self.received) and is_newer(sequence, self.highest + 1)
        self.highest = sequence if not self.received or is_newer(sequence, self.highest) else self.highest
        fresh = sequence not in self.received and (self.highest - sequence) % 2**32 < 64
        self.received = {s for s in self.received | {sequence} if (self.highest - s) % 2**32 < 64}
        if counter > self.newest:
            self.spacing = now - self.arrival if counter == self.newest + 1 else 0
            self.newest, self.arrival = counter, now
        self.owed += 1
        at_once = header["flags"] & frames.ACKNOWLEDGE_NOW or gap or not fresh or self.owed >= 6
        self.due = now if at_once else self.due or now + 3 * MS
        return fresh

    def acknowledgment(self, now: int) -> Fields:
        self.owed = self.due = 0
        bits = sum(1 << (self.highest - s) % 2**32 for s in self.received)
        return {"boot_tag": self.boot_id[:8], "newest_counter": self.newest, "spacing": min(self.spacing, 2**32 - 1),
                "held": now - self.arrival, "highest": self.highest, "received": bits.to_bytes(8, "big")}  # fmt: skip


class Outgoing:
    """A packet until its destination has it."""

    def __init__(self, number: int, image: bytes) -> None:
        self.number, self.image, self.attempt = number, image, -1
        self.begin_anew()

    def begin_anew(self) -> None:
        self.attempt += 1
        self.sent: Dict[int, int] = {}  # when, by segment
        self.open = set(range(-(-len(self.image) // SEGMENT)))

    def arrived(self, first: int, bits: int) -> None:
        self.open = {i for i in self.open if i == first or (i > first and not bits >> (i - first - 1) & 1)}
        newest = max((at for i, at in self.sent.items() if i not in self.open), default=0)
        self.sent = {i: at for i, at in self.sent.items() if i in self.open and at + 50 * MS >= newest}


class Stream:
    """Packets of one priority to one robot."""

    def __init__(self) -> None:
        self.packets: List[Outgoing] = []
        self.boot_tag, self.next, self.tries, self.since, self.paused = b"", 1, 0, 0, 0

    def next_segment(self, now: int) -> Optional[Tuple[Outgoing, int, bool]]:
        """Packet, segment, and whether it asks for an acknowledgment."""
        on_the_way = sum(len(packet.sent) for packet in self.packets)
        if on_the_way and now - self.since > min(150 * MS * (2 + self.tries), 1000 * MS):
            packet = next(p for p in self.packets if p.sent)
            self.tries, self.since = self.tries + 1, now
            return packet, min(packet.sent), True
        for packet in self.packets if on_the_way < 256 and now >= self.paused else []:
            for index in sorted(packet.open - packet.sent.keys()):
                return packet, index, index == max(packet.open)
        return None

    def acknowledged(self, fields: Fields, now: int) -> None:
        for packet in self.packets if self.boot_tag not in (b"", fields["source_boot_tag"]) else []:
            packet.begin_anew()
        self.boot_tag, self.tries, self.since = fields["source_boot_tag"], 0, now
        self.packets = [p for p in self.packets if not is_newer(fields["next"], p.number)]
        for packet in self.packets:
            if {"packet": packet.number, "attempt": packet.attempt} in fields["refused"] and packet.sent:
                packet.begin_anew()
                self.paused = now + 100 * MS
            for item in fields["partial"]:
                if (item["packet"], item["attempt"]) == (packet.number, packet.attempt):
                    packet.arrived(item["first_missing"], int.from_bytes(item["received"], "little"))


class Incoming:
    """Packets of one stream from one run of a robot."""

    def __init__(self, base: int) -> None:
        self.next, self.owed, self.due = base, 0, 0
        self.packets: Dict[int, Tuple[Fields, Dict[int, bytes]]] = {}  # the latest segment, all by index

    def take(self, fields: Fields, now: int) -> List[Tuple[bytes, int]]:
        """Images and hops of the packets that are whole now, in order."""
        self.next = fields["base"] if is_newer(fields["base"], self.next) else self.next
        fresh, complete = False, []
        if (fields["packet"] - self.next) % 2**32 < 1024:
            segments = self.packets.get(fields["packet"], ({}, {}))[1]
            fresh = fields["index"] not in segments
            self.packets[fields["packet"]] = (fields, {**segments, fields["index"]: fields["octets"]})
        while self.next in self.packets:
            latest, segments = self.packets[self.next]
            if sum(map(len, segments.values())) < latest["total"]:
                break
            complete.append((b"".join(octets for _, octets in sorted(segments.items())), latest["hops"]))
            del self.packets[self.next]
            self.next = (self.next + 1) % 2**32
        self.owed += 1
        at_once = fields["stream"] & 0x80 or not fresh or complete or self.owed >= 64
        self.due = now if at_once else self.due or now + 50 * MS
        return complete

    def acknowledgment(self) -> Fields:
        self.owed = self.due = 0
        partial = []
        for number, (latest, segments) in self.packets.items() if len(self.packets) == 1 else []:
            first = next(i for i in range(len(segments) + 1) if i not in segments)
            bits = sum(1 << i - first - 1 for i in segments if first < i <= first + 1024)
            partial.append({"packet": number, "attempt": latest["attempt"], "first_missing": first,
                            "received": bits.to_bytes(-(-bits.bit_length() // 8), "little")})  # fmt: skip
        return {"next": self.next, "partial": partial, "refused": []}


class Robot:
    def __init__(self, name: str, address: bytes, boot_id: bytes, now: int, team_key: Optional[bytes] = None) -> None:
        self.name, self.address, self.boot_id, self.tag, self.team_key = name, address, boot_id, boot_id[:8], team_key
        self.random = random.Random(boot_id)
        self.counter, self.sequence, self.requests, self.beacons, self.malformed = 1, 0, 0, 0, 0
        self.now, self.started, self.beacon_due = now, now, now
        self.links: Dict[bytes, Link] = {}
        self.names: Dict[bytes, str] = {}
        self.routes: Dict[bytes, Route] = {}
        self.requests_seen: Set[Tuple[bytes, bytes, int]] = set()
        self.searches: Dict[Tuple[bytes, str], List[int]] = {}  # tries, when the next one is due
        self.streams: Dict[Tuple[str, int], Stream] = {}
        self.incoming: Dict[Tuple[bytes, bytes, int], Incoming] = {}
        self.packets: List[Tuple[str, str, bytes, int]] = []  # source, topic, payload, hops
        self.out: List[Tuple[bytes, bytes]] = []
        self.handlers: Dict[int, Callable[[bytes, Fields], None]] = defaultdict(lambda: lambda *_: None)
        self.handlers.update({
            BEACON: self.on_beacon, REQUEST: self.on_request, REPLY: self.on_reply, ERROR: self.on_error,
            HOP_ACKNOWLEDGMENT: self.on_hop_acknowledgment, DATA: self.on_data,
            ACKNOWLEDGMENT: self.on_acknowledgment})  # fmt: skip

    def send(self, destination: str, topic: str, payload: bytes, priority: int = 2) -> None:
        self.send_image(destination, frames.write_image(0, "", topic, payload, ord("A")), priority)

    def send_image(self, destination: str, image: bytes, priority: int) -> None:
        stream = self.streams.setdefault((destination, priority), Stream())
        stream.packets.append(Outgoing(stream.next, image))
        stream.next, stream.since = stream.next + 1, self.now

    def receive(self, destination: bytes, source: bytes, octets: bytes, now: int) -> None:
        self.now, mine = now, (EVERYBODY, self.address)
        if destination not in mine:
            return
        try:
            header, fields = frames.open_frame(octets, self.team_key)
            if header["next_hop"] in mine and header["sender"] == source and self.admits(header, fields):
                self.handlers[header["type"]](source, fields)
        except frames.Malformed:
            self.malformed += 1

    def admits(self, header: Fields, fields: Fields) -> bool:
        """The frame is new, and its run alive: in a sealed team, it has named the present run of this robot."""
        link = self.links.get(header["sender"])
        if link is None or link.boot_id != header["boot_id"]:
            link = self.links[header["sender"]] = Link(header["boot_id"], self.counter)
            self.beacon_due = min(self.beacon_due, self.now + self.random.randrange(10 * MS))
        if self.team_key is not None:
            oldest = max(link.first, max(link.counters, default=0) - 1024)
            if header["counter"] in link.counters or header["counter"] <= oldest:
                return False
            link.counters.add(header["counter"])
            if not link.first and any(heard["tag"] == self.boot_id[:6] for heard in fields.get("heard", [])):
                link.first = header["counter"]
            if not link.first:
                return False
        link.heard = self.now
        return not header["flags"] & frames.WANTS_ACKNOWLEDGMENT or link.take(header, self.now)

    def poll(self, now: int) -> List[Tuple[bytes, bytes]]:
        """Destinations and octets of the frames to put on the air now."""
        self.now = now
        if self.beacon_due <= now:
            self.send_beacon()
        for address, link in list(self.links.items()):
            silent = now - max(link.heard, link.since)
            if (link.flight and silent > 1000 * MS) or silent > max(5000 * MS, link.patience):
                del self.links[address]
        for (destination, priority), stream in self.streams.items():
            self.serve(destination, priority, stream)
        for key, incoming in self.incoming.items():
            if incoming.due and incoming.due <= now:
                self.acknowledge(*key, incoming)
        self.search()
        for address, link in self.links.items():
            if link.due and link.due <= now:
                self.transmit(HOP_ACKNOWLEDGMENT, link.acknowledgment(now), address)
            while (frame := link.next_frame(self.counter, now)) is not None:
                self.transmit(frame[1], frame[2], address, frames.WANTS_ACKNOWLEDGMENT, frame[0])
        out, self.out = self.out, []
        return out

    def deadline(self) -> int:
        busy = bool(self.searches) or any(stream.packets for stream in self.streams.values())
        busy = busy or any(link.flight or link.waiting or link.due for link in self.links.values())
        busy = busy or any(incoming.due for incoming in self.incoming.values())
        return min(self.beacon_due, self.now + MS) if busy else self.beacon_due

    def transmit(self, kind: int, fields: Fields, next_hop: bytes, flags: int = 0, link_sequence: int = 0) -> None:
        header = {"version": 2, "type": kind, "flags": flags, "sender": self.address, "boot_id": self.boot_id,
                  "counter": self.counter, "next_hop": next_hop, "link_sequence": link_sequence}  # fmt: skip
        self.counter += 1
        self.out.append((next_hop, frames.close(header, fields, self.team_key)))

    def unicast(self, kind: int, fields: Fields, next_hop: bytes, priority: int = 0) -> None:
        self.links[next_hop].waiting.append((priority, kind, fields))

    # Presence.

    def send_beacon(self) -> None:
        alive = [link for link in self.links.values() if not link.first or self.now - link.heard < link.patience]
        heard = [{"tag": link.boot_id[:6], "loss": 0} for link in alive[:24]]
        self.beacons += 1
        self.transmit(BEACON, {
            "sequence": self.sequence, "life_sign": 1 + (self.now - self.started) // (1000 * MS), "name": self.name,
            "number": self.beacons, "heard_count": len(alive), "heard": heard,
            "rumors": [], "extensions": {1: (250).to_bytes(4, "big")}}, EVERYBODY)  # fmt: skip
        self.beacon_due = self.now + self.random.randrange(237, 263) * MS

    def on_beacon(self, source: bytes, fields: Fields) -> None:
        link = self.links[source]
        self.names.update({rumor["address"]: rumor["name"] for rumor in fields["rumors"]})
        self.names[source] = fields["name"]
        interval = int.from_bytes(fields["extensions"].get(1, b""), "big") or 250
        beacons = -(-fields["heard_count"] // max(len(fields["heard"]), 1)) or 1
        link.patience = 8 * min(max(interval, 50), 10_000) * MS * min(beacons, 11)
        if any(heard["tag"] == self.boot_id[:6] for heard in fields["heard"]):
            link.listed = self.now

    def two_way(self, address: bytes) -> bool:
        return address in self.links and self.now - self.links[address].listed < self.links[address].patience

    # Routes.

    def next_hop(self, address: bytes) -> Optional[bytes]:
        hop, tag, sequence, cost, end = self.routes.get(address, (address, b"", 0, 0, 0))
        if end > self.now and self.two_way(hop):
            self.routes[address] = (hop, tag, sequence, cost, max(end, self.now + 10_000 * MS))
            return hop
        return address if self.two_way(address) else None

    def offer(self, address: bytes, offer: Route, name: str) -> bool:
        _, tag, sequence, cost, end = self.routes.get(address, (b"", b"", 0, 0, 0))
        better = is_newer(offer[2], sequence) or (offer[2] == sequence and offer[3] < cost)
        if tag == offer[1] and end > self.now and not better:
            return False
        self.routes[address], self.names[address] = offer, name
        return True

    def want(self, address: bytes, name: str = "") -> None:
        self.searches.setdefault((address, name), [0, self.now])

    def search(self) -> None:
        for (address, name), search in list(self.searches.items()):
            known = [a for a, n in self.names.items() if n == name] or [address]
            if search[0] == 4 or any(self.next_hop(a) for a in known):
                del self.searches[address, name]
            elif search[1] <= self.now:
                self.sequence, self.requests = self.sequence + 1, self.requests + 1
                self.transmit(REQUEST, {
                    "flags": 0x38, "hop_count": 0, "hop_limit": 35, "cost": 0, "id": self.requests,
                    "destination": address, "destination_sequence": 0, "destination_name": name,
                    "originator": self.address, "originator_sequence": self.sequence, "originator_boot_tag": self.tag,
                    "originator_name": self.name, "extensions": {}}, EVERYBODY)  # fmt: skip
                search[:] = search[0] + 1, self.now + 120 * MS * 2 ** search[0]

    def on_request(self, source: bytes, fields: Fields) -> None:
        originator = fields["originator"]
        if not self.two_way(source) or originator == self.address:
            return
        key = (originator, fields["originator_boot_tag"], fields["id"])
        first = key not in self.requests_seen
        self.requests_seen.add(key)
        fields.update(hop_count=fields["hop_count"] + 1, cost=fields["cost"] + 16)
        back = (source, key[1], fields["originator_sequence"], fields["cost"], self.now + 700 * MS)
        if not self.offer(originator, back, fields["originator_name"]) and not first:
            return
        named = fields["destination"] == NOBODY and fields["destination_name"] == self.name
        if not named and fields["destination"] != self.address:
            return self.pass_on(REQUEST, source, fields)
        if not fields["flags"] & 0x08 and is_newer(fields["destination_sequence"], self.sequence):
            self.sequence = fields["destination_sequence"]
        self.sequence += 1 if first and fields["flags"] & 0x10 else 0
        self.unicast(REPLY, {
            "flags": 0, "hop_count": 0, "cost": 0, "destination": self.address, "destination_boot_tag": self.tag,
            "destination_sequence": self.sequence, "destination_name": self.name, "originator": originator,
            "lifetime": 20_000, "extensions": {}}, source)  # fmt: skip

    def on_reply(self, source: bytes, fields: Fields) -> None:
        if fields["flags"] & 0x40:
            self.transmit(REPLY_ACKNOWLEDGMENT, {}, source)
        fields.update(hop_count=fields["hop_count"] + 1, cost=fields["cost"] + 16)
        route = (source, fields["destination_boot_tag"], fields["destination_sequence"], fields["cost"],
                 self.now + fields["lifetime"] * MS)  # fmt: skip
        if fields["destination"] != self.address:
            self.offer(fields["destination"], route, fields["destination_name"])
            self.pass_on(REPLY, source, fields)

    def on_error(self, source: bytes, fields: Fields) -> None:
        lost = {item["address"] for item in fields["destinations"] if not fields["flags"] & 0x80}
        self.routes = {a: route for a, route in self.routes.items() if a not in lost or route[0] != source}

    # Packets.

    def on_hop_acknowledgment(self, source: bytes, fields: Fields) -> None:
        if fields["boot_tag"] == self.tag:
            self.links[source].listed = self.now
            self.links[source].acknowledged(fields, self.now)

    def acknowledge(self, source: bytes, boot_tag: bytes, priority: int, incoming: Incoming) -> None:
        next_hop = self.next_hop(source)
        if next_hop is None:
            self.want(source)
        else:
            fields = {"source": self.address, "source_boot_tag": self.tag, "destination": source, "hops": 1,
                      "destination_boot_tag": boot_tag, "stream": priority}  # fmt: skip
            self.unicast(ACKNOWLEDGMENT, {**fields, **incoming.acknowledgment()}, next_hop)

    def serve(self, destination: str, priority: int, stream: Stream) -> None:
        address = next((a for a, name in self.names.items() if name == destination), NOBODY)
        next_hop = self.next_hop(address)
        if next_hop is None and stream.packets:
            stream.since = self.now
            self.want(address, destination if address == NOBODY else "")
        while next_hop and len(self.links[next_hop].waiting) < 8 and (segment := stream.next_segment(self.now)):
            packet, index, asks = segment
            packet.sent[index] = self.now
            self.unicast(DATA, {
                "source": self.address, "source_boot_tag": self.tag, "destination": address, "hops": 1,
                "stream": priority | (0x80 if asks else 0), "packet": packet.number, "base": stream.packets[0].number,
                "index": index, "total": len(packet.image), "segment_size": SEGMENT, "attempt": packet.attempt,
                "octets": packet.image[index * SEGMENT : (index + 1) * SEGMENT]}, next_hop, priority)  # fmt: skip

    def on_data(self, source: bytes, fields: Fields) -> None:
        if fields["destination"] != self.address:
            return self.pass_on(DATA, source, fields)
        if fields["source"] not in self.names:
            return self.want(fields["source"])
        key = (fields["source"], fields["source_boot_tag"], fields["stream"] & 3)
        incoming = self.incoming.setdefault(key, Incoming(fields["base"]))
        for octets, hops in incoming.take(fields, self.now):
            self.on_packet(fields["source"], fields["source_boot_tag"], frames.read_image(octets), hops)

    def on_packet(self, source: bytes, boot_tag: bytes, image: Fields, hops: int) -> None:
        if image["kind"] == 0:
            self.packets.append((self.names[source], image["topic"], image["payload"], hops))

    def on_acknowledgment(self, source: bytes, fields: Fields) -> None:
        if fields["destination"] != self.address:
            return self.pass_on(ACKNOWLEDGMENT, source, fields)
        stream = self.streams.get((self.names.get(fields["source"], ""), fields["stream"]))
        if stream is not None and fields["destination_boot_tag"] == self.tag:
            stream.acknowledged(fields, self.now)

    def pass_on(self, kind: int, source: bytes, fields: Fields) -> None:
        """What is for others, as a relay does."""
        target = fields["originator"] if kind == REPLY else fields["destination"]
        next_hop = self.next_hop(target)
        if kind == REQUEST:
            if fields["hop_limit"] > 1 and fields["hop_count"] < 35:
                self.transmit(REQUEST, {**fields, "hop_limit": fields["hop_limit"] - 1}, EVERYBODY)
        elif kind == REPLY:
            if target != self.address and next_hop is not None and next_hop != source:
                self.unicast(REPLY, fields, next_hop)
        elif next_hop is not None and next_hop != source and fields["hops"] < 35:
            priority = fields["stream"] & 3 if kind == DATA else 0
            self.unicast(kind, {**fields, "hops": fields["hops"] + 1}, next_hop, priority)
        else:
            lost = [{"address": target, "sequence": 0}]
            self.unicast(ERROR, {"flags": 0x40, "destinations": lost, "extensions": {}}, source)
