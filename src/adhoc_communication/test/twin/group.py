"""A robot in groups, as docs/protocol.md describes them: a leaf in the trees of others, the root of its own."""

from functools import lru_cache
from typing import Dict, List, Optional, Set, Tuple

import frames
from frames import EVERYBODY, Fields
from robot import MS, Robot, is_newer

ACTIVATION, REFUSAL, GROUP_DATA, REPORT = 10, 11, 12, 13
JOIN, LEAVE, MEMBERS_REQUEST, MEMBERS, COPY = range(1, 6)
SEGMENT = 1390  # fills a frame of 1500 octets with its Ethernet header


def digest(member: bytes) -> int:
    x = int.from_bytes(member, "big")
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9 % 2**64
    x = (x ^ x >> 27) * 0x94D049BB133111EB % 2**64
    return (x ^ x >> 31) % 2**32


def coverage(members: Set[bytes]) -> int:
    result = 0
    for member in members:
        result ^= digest(member)
    return result


def product(a: int, b: int) -> int:
    """In GF(256)."""
    result = 0
    while b:
        result ^= a if b & 1 else 0
        a = a << 1 ^ (0x11D if a & 0x80 else 0)
        b >>= 1
    return result


@lru_cache(maxsize=None)
def inverse(a: int) -> int:
    return next(b for b in range(256) if product(a, b) == 1)


@lru_cache(maxsize=None)
def products(a: int) -> bytes:
    return bytes(product(a, b) for b in range(256))


def add(a: bytes, b: bytes) -> bytes:
    return (int.from_bytes(a, "big") ^ int.from_bytes(b, "big")).to_bytes(len(a), "big")


def times(factor: int, octets: bytes) -> bytes:
    return octets.translate(products(factor))


def of_user(image: bytes) -> Tuple[str, bytes]:
    fields = frames.read_image(image)
    return fields["topic"], fields["payload"]


class Block:
    """`symbols`: those at hand, padded to one length; from `size` on parity."""

    def __init__(self, size: int, length: int) -> None:
        self.size, self.length = size, length
        self.symbols: Dict[int, bytes] = {}

    def complete(self) -> bool:
        return all(number in self.symbols for number in range(self.size))

    def missing(self) -> int:
        """As a report tells it."""
        if self.size <= 3:
            return sum(1 << number for number in range(self.size) if number not in self.symbols)
        return 0 if self.complete() else self.size - len(self.symbols)

    def take(self, number: int, octets: bytes) -> None:
        if not self.complete():
            self.symbols[number] = octets.ljust(self.length, b"\0")
            if len(self.symbols) >= self.size:
                self.solve()

    def solve(self) -> None:
        """By Gauss and Jordan."""
        missing = [number for number in range(self.size) if number not in self.symbols]
        parities = [number for number in self.symbols if number >= self.size][: len(missing)]
        rows = [[inverse(parity ^ number) for number in missing] for parity in parities]
        right = [self.parity(parity, self.symbols[parity]) for parity in parities]
        for i in range(len(missing)):
            factor = inverse(rows[i][i])
            rows[i], right[i] = [product(factor, a) for a in rows[i]], times(factor, right[i])
            for j in set(range(len(missing))) - {i}:
                factor = rows[j][i]
                rows[j] = [a ^ product(factor, b) for a, b in zip(rows[j], rows[i])]
                right[j] = add(right[j], times(factor, right[i]))
        self.symbols.update(zip(missing, right))

    def parity(self, number: int, octets: Optional[bytes] = None) -> bytes:
        """What the frames at hand contribute to it, added to `octets`."""
        result = octets or bytes(self.length)
        for frame in range(self.size):
            if frame in self.symbols:
                result = add(result, times(inverse(number ^ frame), self.symbols[frame]))
        return result


class GroupPacket:
    """Cut into blocks; what a member knows of it."""

    def __init__(self, total: int, segment_size: int, image: bytes = b"") -> None:
        self.total, self.length = total, min(segment_size, total)
        count = -(-total // self.length)
        blocks = -(-count // 128)
        self.blocks = [Block(count // blocks + (i < count % blocks), self.length) for i in range(blocks)]
        self.round, self.due, self.told = 0, 0, 0  # greatest round heard, report due, epoch told that it is complete
        at = 0
        for block in self.blocks if image else []:
            for number in range(block.size):
                block.take(number, image[at : at + self.length])
                at += self.length

    def complete(self) -> bool:
        return all(block.complete() for block in self.blocks)

    def image(self) -> bytes:
        return b"".join(block.symbols[i] for block in self.blocks for i in range(block.size))[: self.total]

    def symbol(self, block: int, number: int) -> bytes:
        """As it goes on the air."""
        this = self.blocks[block]
        octets = this.symbols[number] if number < this.size else this.parity(number)
        last = block == len(self.blocks) - 1 and number == this.size - 1
        return octets[: (self.total - 1) % self.length + 1] if last else octets


class Tree:
    """The place in that of one run of a root, and its packets by priority and number."""

    def __init__(self, boot_tag: bytes) -> None:
        self.boot_tag, self.epoch = boot_tag, 0
        self.upstream: Optional[bytes] = None
        self.next: Dict[int, int] = {}  # to deliver, by priority
        self.packets: Dict[Tuple[int, int], GroupPacket] = {}


class Child:
    """Of the root, for one packet."""

    def __init__(self) -> None:
        self.missing: Dict[int, int] = {}  # by block
        self.round, self.asked, self.done = 0, 0, False


class Sending:
    """A packet of the own group on its way."""

    def __init__(self, image: bytes, first_parity: int) -> None:
        self.packet = GroupPacket(len(image), SEGMENT, image)
        self.queue = [(b, i) for b, block in enumerate(self.packet.blocks) for i in range(block.size)]
        self.round, self.sent_in = 1, 0
        self.children: Dict[bytes, Child] = {}
        self.parities = [first_parity] * len(self.packet.blocks)

    def repair(self) -> None:
        """Once all children have told what they miss of all that was sent."""
        behind = [child for child in self.children.values() if not child.done]
        if self.queue or any(child.round < self.sent_in for child in behind):
            return
        for number, block in enumerate(self.packet.blocks):
            missing = [child.missing.get(number, 0) for child in behind]
            if block.size <= 3:
                self.queue += [(number, i) for i in range(block.size) if any(bits >> i & 1 for bits in missing)]
            else:
                for _ in range(max(missing, default=0)):
                    self.queue.append((number, block.size + self.parities[number] % (256 - block.size)))
                    self.parities[number] += 1


class GroupRobot(Robot):
    def __init__(self, name: str, address: bytes, boot_id: bytes, now: int, team_key: Optional[bytes] = None) -> None:
        super().__init__(name, address, boot_id, now, team_key)
        self.trees: Dict[bytes, Tree] = {}
        self.joined: Set[str] = set()
        self.group, self.epoch = "mc_" + name, 1
        self.members: Set[bytes] = set()
        self.branches: Dict[bytes, Set[bytes]] = {}  # members by child
        self.sending: Dict[Tuple[int, int], Sending] = {}
        self.number, self.told_again = 0, 0
        self.handlers.update({ACTIVATION: self.on_activation, REFUSAL: self.on_refusal, GROUP_DATA: self.on_group_data,
                              REPORT: self.on_report})  # fmt: skip

    def join(self, root: str) -> None:
        self.joined.add("mc_" + root)
        self.send_image(root, frames.write_image(JOIN, "mc_" + root, "", b""), 0)

    def send_to_group(self, topic: str, payload: bytes, priority: int = 2) -> None:
        """To those that have joined and to whom there is a route."""
        self.number += 1
        sending = Sending(frames.write_image(0, self.group, topic, payload, ord("A")), digest(self.address) % 256)
        placed = set().union(*self.branches.values())
        for member in self.members - placed:
            hop = self.next_hop(member)
            if hop is not None:
                self.branches.setdefault(hop, set()).add(member)
        for child in self.branches:
            sending.children[child] = Child()
            self.activate(child)
        self.sending[priority, self.number] = sending

    def poll(self, now: int) -> List[Tuple[bytes, bytes]]:
        self.now = now
        for root, tree in self.trees.items():
            for (priority, number), packet in tree.packets.items():
                delivered = packet.complete() and is_newer(tree.next[priority], number)
                if tree.upstream and delivered and packet.told != tree.epoch:
                    packet.told = tree.epoch
                    self.report(root, tree, priority, number, reliably=True)
                elif packet.due and packet.due <= now:
                    self.report(root, tree, priority, number, reliably=False)
        for (priority, number), sending in list(self.sending.items()):
            self.serve_group(priority, number, sending)
        return super().poll(now)

    def deadline(self) -> int:
        busy = self.sending or any(packet.due for tree in self.trees.values() for packet in tree.packets.values())
        return min(super().deadline(), self.now + MS) if busy else super().deadline()

    def on_packet(self, source: bytes, boot_tag: bytes, image: Fields, hops: int) -> None:
        super().on_packet(source, boot_tag, image, hops)
        if image["kind"] == JOIN and image["group"] == self.group:
            self.members.add(source)
        elif image["kind"] == LEAVE and image["group"] == self.group:
            self.members.discard(source)
        elif image["kind"] == MEMBERS_REQUEST and image["group"] == self.group:
            names = [self.name, *(self.names[member] for member in self.members)]
            listed = b"".join(bytes([len(name)]) + name.encode() for name in names)
            payload = len(names).to_bytes(2, "big") + listed
            self.send_image(self.names[source], frames.write_image(MEMBERS, self.group, "", payload), 0)
        elif image["kind"] == COPY:
            copy = frames.Reader(image["payload"])
            priority, number = copy.one("u8", []), copy.one("u32", [])
            tree = self.tree_of(source, boot_tag)
            if not is_newer(tree.next.setdefault(priority, number), number):
                self.packets.append((self.names[source], *of_user(copy.octets), 1))
                tree.next[priority] = number + 1
                self.deliver_group(source, tree, priority, 1)

    # In the tree of another.

    def branch(self, kind: int, to: bytes, root: bytes, boot_tag: bytes, epoch: int, members: Set[bytes]) -> None:
        fields = {"root": root, "root_boot_tag": boot_tag, "epoch": epoch}
        self.unicast(kind, {**fields, "members": [{"address": member} for member in sorted(members)]}, to)

    def tree_of(self, root: bytes, boot_tag: bytes) -> Tree:
        if root not in self.trees or self.trees[root].boot_tag != boot_tag:
            self.trees[root] = Tree(boot_tag)
        return self.trees[root]

    def on_activation(self, source: bytes, fields: Fields) -> None:
        root, boot_tag, epoch = fields["root"], fields["root_boot_tag"], fields["epoch"]
        members = {member["address"] for member in fields["members"]}
        tree = self.tree_of(root, boot_tag)
        anew = tree.epoch == 0 or is_newer(epoch, tree.epoch)
        if anew or (epoch == tree.epoch and tree.upstream in (None, source)):
            mine = members & {self.address} if "mc_" + self.names.get(root, "") in self.joined else set()
            tree.epoch, tree.upstream = epoch, source if mine else None
            members -= mine
        if members:
            self.branch(REFUSAL, source, root, boot_tag, epoch, members)

    def on_group_data(self, source: bytes, fields: Fields) -> None:
        if fields["stream"] & 0x20:
            return  # flooded: the root sends a copy to who says nothing of it
        root, priority, number = fields["root"], fields["stream"] & 3, fields["packet"]
        tree = self.trees.get(root, Tree(b""))
        asked, question = fields["stream"] & 0x80, not fields["octets"]
        if tree.boot_tag != fields["root_boot_tag"] or not tree.upstream or (question and tree.upstream != source):
            return self.disown(source, fields) if question else None
        following = tree.next.setdefault(priority, fields["base"])
        if source == tree.upstream and is_newer(fields["base"], following):
            tree.next[priority] = fields["base"]
        base = fields["base"]
        tree.packets = {key: p for key, p in tree.packets.items() if key[0] != priority or not is_newer(base, key[1])}
        packet = tree.packets.setdefault((priority, number), GroupPacket(fields["total"], fields["segment_size"]))
        if not question:
            packet.blocks[fields["block"]].take(fields["symbol"], fields["octets"])
        self.deliver_group(root, tree, priority, fields["hops"])
        if asked and source == tree.upstream:
            packet.round = max(packet.round, fields["round"])
            packet.due = self.now + self.random.randrange(MS) + 1
            if question:
                self.report(root, tree, priority, number, reliably=True)

    def deliver_group(self, root: bytes, tree: Tree, priority: int, hops: int) -> None:
        packet = tree.packets.get((priority, tree.next[priority]))
        while packet is not None and packet.complete():
            self.packets.append((self.names[root], *of_user(packet.image()), hops))
            tree.next[priority] += 1
            packet = tree.packets.get((priority, tree.next[priority]))

    def report(self, root: bytes, tree: Tree, priority: int, number: int, reliably: bool) -> None:
        packet = tree.packets[priority, number]
        packet.due = 0
        first = next((i for i, block in enumerate(packet.blocks) if not block.complete()), len(packet.blocks))
        settled = packet.complete() and is_newer(tree.next[priority], number)
        fields = {"root": root, "root_boot_tag": tree.boot_tag, "stream": priority | (0x80 if settled else 0),
                  "packet": number, "epoch": tree.epoch, "round": packet.round, "measured_counter": 0, "spacing": 0,
                  "coverage": digest(self.address), "first_block": first,
                  "missing": bytes(block.missing() for block in packet.blocks[first : first + 16])}  # fmt: skip
        if tree.upstream is not None and reliably:
            self.unicast(REPORT, fields, tree.upstream)
        elif tree.upstream is not None:
            self.transmit(REPORT, fields, tree.upstream)

    def disown(self, source: bytes, fields: Fields) -> None:
        nothing = dict.fromkeys(("epoch", "round", "measured_counter", "spacing", "coverage", "first_block"), 0)
        same = {name: fields[name] for name in ("root", "root_boot_tag", "packet")}
        self.unicast(REPORT, {**nothing, **same, "stream": fields["stream"] & 3, "missing": b""}, source)

    # At the root.

    def activate(self, child: bytes) -> None:
        self.branch(ACTIVATION, child, self.address, self.tag, self.epoch, self.branches.get(child, set()))

    def on_refusal(self, source: bytes, fields: Fields) -> None:
        """Who cannot be reached gets copies."""
        if fields["root"] != self.address or fields["root_boot_tag"] != self.tag or fields["epoch"] != self.epoch:
            return
        for member in {item["address"] for item in fields["members"]} & self.branches.get(source, set()):
            self.branches[source].discard(member)
            for (priority, number), sending in self.sending.items():
                payload = bytes([priority]) + number.to_bytes(4, "big") + sending.packet.image()
                self.send_image(self.names[member], frames.write_image(COPY, self.group, "", payload), priority)
        self.branches = {child: members for child, members in self.branches.items() if members}

    def on_report(self, source: bytes, fields: Fields) -> None:
        sending = self.sending.get((fields["stream"] & 3, fields["packet"]))
        if fields["root"] != self.address or fields["root_boot_tag"] != self.tag or sending is None:
            return
        known = fields["epoch"] == self.epoch and fields["coverage"] == coverage(self.branches.get(source, set()))
        if not known and self.now - self.told_again > 50 * MS:
            self.told_again = self.now
            self.activate(source)
        child = sending.children.get(source)
        if child is not None and fields["round"] >= child.round:
            child.round, child.asked = fields["round"], self.now
            child.missing = {fields["first_block"] + i: missing for i, missing in enumerate(fields["missing"])}
            child.done = child.done or (known and bool(fields["stream"] & 0x80))
            sending.repair()

    def serve_group(self, priority: int, number: int, sending: Sending) -> None:
        sending.children = {child: state for child, state in sending.children.items() if child in self.branches}
        if all(child.done for child in sending.children.values()):
            del self.sending[priority, number]
            return
        packet = sending.packet
        base = min(n for p, n in self.sending if p == priority)
        fields = {"root": self.address, "root_boot_tag": self.tag, "stream": priority, "hops": 1, "packet": number,
                  "base": base, "total": packet.total, "segment_size": SEGMENT}  # fmt: skip
        for block, symbol in sending.queue[:4]:
            del sending.queue[0]
            asks = 0 if sending.queue else 0x80
            octets = packet.symbol(block, symbol)
            data = {
                "stream": priority | asks,
                "round": sending.round,
                "block": block,
                "symbol": symbol,
                "octets": octets,
            }
            self.transmit(GROUP_DATA, {**fields, **data}, EVERYBODY)
            if asks:
                sending.sent_in, sending.round = sending.round, sending.round + 1
                for child in sending.children.values():
                    child.asked = self.now
        silent = [a for a, child in sending.children.items() if not child.done and self.now - child.asked > 50 * MS]
        for address in silent if not sending.queue else []:
            sending.children[address].asked = self.now
            question = {**fields, "stream": priority | 0x80, "round": sending.round, "block": 0, "symbol": 0}
            self.unicast(GROUP_DATA, {**question, "octets": b""}, address)
        sending.round += 1 if silent and not sending.queue else 0
