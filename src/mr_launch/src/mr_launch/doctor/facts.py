"""What the doctor knows of a robot, as plain values. None: not looked at, because something before it is missing."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Mapping

HUB = "hub:"  # how the name of an interface begins that is a socket of a radio daemon
HOST_NAME = "host name"  # source of the own name where no variable says another
FRAME_SIZE = 1500  # octets, default of adhoc_communication's max_frame_size


@dataclass(frozen=True)
class Finding:
    """One fault. `part`: of the robot, as in `Finding.part` of --json; `what` is wrong, `remedy` in the imperative."""

    part: str
    what: str
    remedy: str

    def __str__(self) -> str:
        return f"{self.what}: {self.remedy}"


@dataclass(frozen=True)
class Interface:
    """A network interface. `mode`: of a wireless one, in the words of `iw`, empty if unknown; `mtu`: octets without the
    Ethernet header; `frame_size`: octets with it that adhoc_communication is told to send."""

    name: str
    existing: tuple[str, ...] = ()
    up: bool = True
    wireless: bool = False
    mode: str = ""
    mtu: int = 1500
    frame_size: int = 1500

    @property
    def exists(self) -> bool:
        return self.name in self.existing


@dataclass(frozen=True)
class Hub:
    """The socket of a radio daemon. `fault`: why nobody answers there, empty if somebody does."""

    path: str
    fault: str = ""


@dataclass(frozen=True)
class KeyFile:
    """`fault`: why no key can be read from it, empty if one can; `denied`: only to this user, as far as is known;
    `mode`: permission bits."""

    path: str
    absolute: bool = True
    fault: str = ""
    denied: bool = False
    mode: int = 0o600


@dataclass(frozen=True)
class OwnName:
    """By what nodes tell others to reach them. `source`: who says so, the host name or a variable; `fault`: why it does
    not lead to this computer, empty if it does."""

    name: str = "anna"
    source: str = HOST_NAME
    fault: str = ""


@dataclass(frozen=True)
class Computer:
    """`busy`: share of all cores now; `load`: programs of the last minute that ran or waited, for each core; `busiest`:
    the process with the largest share; octets of memory, and of the file systems that the robot writes to, by folder;
    `year` of the system's clock."""

    host_name: str = "anna"
    own_name: OwnName = OwnName()
    raw_sockets: bool = True
    program: str = ""
    busy: float = 0.1
    load: float = 0.1
    busiest: str = ""
    memory: int = 8 << 30
    memory_available: int = 4 << 30
    disks: Mapping[str, int] = field(default_factory=dict)
    year: int = 2026


@dataclass(frozen=True)
class Master:
    uri: str
    fault: str = ""


@dataclass(frozen=True)
class Topic:
    """What was heard of a topic. `kind`: type as published, empty without a publisher; `rate`: Hz by the stamps of
    messages, 0 if none came; `age`: s of ROS time from stamp to arrival, the median; `frame`: of its header."""

    name: str
    wanted: str = ""
    kind: str = ""
    publishers: tuple[str, ...] = ()
    subscribers: tuple[str, ...] = ()
    rate: float = 0.0
    age: float = 0.0
    frame: str = ""
    stamped: bool = True
    valid: float = 1.0  # share of the beams of a scan that are not nearer than the sensor can measure

    @property
    def heard(self) -> bool:
        return self.rate > 0.0


@dataclass(frozen=True)
class Link:
    """One transform of tf and the node that publishes it."""

    parent: str
    child: str
    node: str


@dataclass(frozen=True)
class Clock:
    """`simulated`: nodes that start now take the time from /clock; `publishers` of it; `runs`: it went on meanwhile. By
    full names, nodes that began when that was otherwise: `ignored_by` those that do not listen to /clock though time is
    `simulated`, `awaited_by` those that do though it is not."""

    simulated: bool = False
    publishers: tuple[str, ...] = ()
    runs: bool = True
    ignored_by: tuple[str, ...] = ()
    awaited_by: tuple[str, ...] = ()


@dataclass(frozen=True)
class Complaint:
    """What adhoc_communication says on /diagnostics all the while. `level`: 1 warning, 2 error."""

    part: str
    level: int
    text: str


@dataclass(frozen=True)
class Radio:
    """`answers`: the service get_neighbors does; `robots` that the radio reaches now."""

    answers: bool = True
    robots: tuple[str, ...] = ()
    complaints: tuple[Complaint, ...] = ()


@dataclass(frozen=True)
class SetUp:
    """How the robot is set up, by the parameters on its master. `nodes` of it that should run; `body`: the node that
    simulates it, empty for a real robot; `recorder`: the node that records it, empty where nobody wants that; `names`
    that the nodes have for this robot, empty for the host name; `faults`: what is wrong with the parameters of a node.
    """

    nodes: tuple[str, ...] = ()
    body: str = ""
    recorder: str = ""
    names: Mapping[str, str] = field(default_factory=dict)
    faults: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    map_frame: str = "map"
    odom_frame: str = "odom"
    base_frame: str = "base_footprint"
    has_body: bool = True

    @property
    def processes(self) -> tuple[str, ...]:
        """All nodes that should run."""
        return (*self.nodes, *filter(None, (self.body, self.recorder)))


@dataclass(frozen=True)
class Facts:
    """All of them. `topics` by what they are for: scan, odometry, velocity, map; `running`: nodes that answer;
    `last_words`: the last error in the log of a node that does not; `astray`: of such nodes, the host at which the
    master knows them, where that is not this computer; `peers`: robots that are to be in reach; `offered`: somebody
    offers the action move_base."""

    computer: Computer = field(default_factory=Computer)
    interface: Interface | None = None
    hub: Hub | None = None
    key_file: KeyFile | None = None
    master: Master | None = None
    set_up: SetUp | None = None
    running: tuple[str, ...] = ()
    clock: Clock | None = None
    topics: Mapping[str, Topic] = field(default_factory=dict)
    links: tuple[Link, ...] = ()
    radio: Radio | None = None
    last_words: Mapping[str, str] = field(default_factory=dict)
    astray: Mapping[str, str] = field(default_factory=dict)
    offered: bool = True
    peers: tuple[str, ...] = ()
