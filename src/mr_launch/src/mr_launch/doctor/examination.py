"""Gathers the facts of one robot from its master and its nodes."""

from __future__ import annotations

import contextlib
import os
import re
import socket
import threading
import time
import xmlrpc.client
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Iterable, Iterator, Mapping
from urllib.parse import urlparse

import rosgraph
import rospkg
import rospy
from adhoc_communication.msg import Status
from adhoc_communication.srv import GetNeighbors

from mr_launch.doctor.facts import FRAME_SIZE, HUB, Clock, Facts, Master, Radio, SetUp, Topic
from mr_launch.doctor.listener import TYPES, Listener
from mr_launch.doctor.machine import computer_of, fault_of_name, hub_of, interface_of, key_file_of
from mr_launch.doctor.set_up import BODY, RECORDER, folders_of, frame_size_of, parameters_of, set_up_of, topics_of

PATIENCE = 3.0  # s that a master, a node or a service may take to answer
TAIL = 65536  # octets of a log in which the last words are looked for
_LAST_WORDS = re.compile(r"(?:FATAL|ERROR)\S*\]?:? *(?:\[[^\]]*\]:? *)*(?P<text>[^\n\x1b]+)")


@dataclass(frozen=True)
class Wanted:
    """What the user gave in place of what stands on the master. `seconds` to listen."""

    interface: str = ""
    key_file: str = ""
    peers: tuple[str, ...] = ()
    seconds: float = 4.0


def examine(wanted: Wanted) -> Facts:
    """All facts; without a master those of the computer."""
    uri = rosgraph.get_master_uri()
    namespace = rosgraph.names.get_ros_namespace()
    with _patience():
        master, fault = _master()
        given = {} if fault else _parameters(master, namespace)
    facts = Facts(master=Master(uri, fault), peers=wanted.peers)
    facts = _with_files(facts, wanted, parameters_of(given, "adhoc_communication"))
    folders = [os.environ.get("ROS_HOME", "~/.ros"), *folders_of(given)]
    if fault:
        return replace(facts, computer=computer_of(folders, 0.5))
    robot = Robot(master, namespace, given)
    return robot.examine(replace(facts, set_up=set_up_of(given)), folders, wanted.seconds)


def _with_files(facts: Facts, wanted: Wanted, radio: Mapping[str, Any]) -> Facts:
    """With interface and key file as given, or as adhoc_communication has them."""
    interface = wanted.interface or str(radio.get("interface", ""))
    key_file = wanted.key_file or str(radio.get("key_file", ""))
    if interface.startswith(HUB):
        facts = replace(facts, hub=hub_of(interface))
    elif interface:
        facts = replace(facts, interface=interface_of(interface, frame_size_of(radio) or FRAME_SIZE))
    return replace(facts, key_file=key_file_of(key_file)) if key_file else facts


@contextlib.contextmanager
def _patience() -> Iterator[None]:
    """For calls of a master or a node, which have no time limit of their own."""
    before = socket.getdefaulttimeout()
    socket.setdefaulttimeout(PATIENCE)
    try:
        yield
    finally:
        socket.setdefaulttimeout(before)


def _master() -> tuple[Any, str]:
    """The master that ROS_MASTER_URI names, and what is wrong with it; nothing if it answers."""
    try:
        master = rosgraph.Master("/doctor")
        master.getPid()
    except (OSError, ValueError, rosgraph.MasterException, xmlrpc.client.Error) as error:
        return None, getattr(error, "strerror", None) or str(error) or type(error).__name__
    return master, ""


def _parameters(master: Any, namespace: str) -> dict[str, Any]:
    try:
        found = master.getParam(namespace)
    except rosgraph.MasterException:
        return {}
    return found if isinstance(found, dict) else {}


class Robot:
    """One robot on a master that answers. `namespace` begins and ends with a slash, as ROS gives it."""

    def __init__(self, master: Any, namespace: str, given: Mapping[str, Any]) -> None:
        self._master, self._namespace, self._given = master, namespace, given
        self._status: Any = None

    def examine(self, facts: Facts, folders: list[str], seconds: float) -> Facts:
        rospy.init_node("doctor", anonymous=True, disable_signals=True, disable_rostime=True)
        assert facts.set_up is not None
        with _patience():
            running = tuple(node for node in facts.set_up.processes if self._runs(node))
            astray = self._astray(node for node in facts.set_up.processes if node not in running)
            publishers, subscribers, _ = self._master.getSystemState()
            kinds = dict(self._master.getTopicTypes())
        graph = Graph(dict(publishers), dict(subscribers), kinds)
        topics = self._topics(facts.set_up, graph)
        simulated = self._is_simulated()
        listener = Listener(topics, simulated)
        rospy.Subscriber(f"{self._namespace}adhoc_communication/status", Status, self._on_status, queue_size=1)
        began = time.monotonic()
        computer = computer_of(folders, seconds)
        answers = self._radio_answers() if "adhoc_communication" in running else False
        time.sleep(max(0.0, began + seconds - time.monotonic()))
        return replace(
            facts,
            computer=computer,
            running=running,
            astray=astray,
            clock=self._of_all_nodes(listener.clock(graph.publishers("/clock")), running, topics, graph),
            topics=listener.topics(),
            links=listener.links(),
            radio=self._radio(answers, listener),
            last_words={node: self._last_words(node) for node in facts.set_up.processes if node not in running},
            offered=bool(graph.subscribers(f"{self._namespace}move_base/goal")),
        )

    def _is_simulated(self) -> bool:
        try:
            return bool(self._master.getParam("/use_sim_time"))
        except rosgraph.MasterException:
            return False

    def _runs(self, node: str) -> bool:
        """The master remembers nodes that have died: only an answer counts."""
        try:
            uri = self._master.lookupNode(self._namespace + node)
            xmlrpc.client.ServerProxy(uri).getPid("/doctor")
        except (OSError, rosgraph.MasterException, xmlrpc.client.Error):
            return False
        return True

    def _astray(self, nodes: Iterable[str]) -> dict[str, str]:
        """Those that the master knows at hosts that do not lead here, and these hosts."""
        found = {}
        for node in nodes:
            with contextlib.suppress(OSError, rosgraph.MasterException, xmlrpc.client.Error):
                host = urlparse(self._master.lookupNode(self._namespace + node)).hostname or ""
                if host and fault_of_name(host):
                    found[node] = host
        return found

    def _of_all_nodes(self, clock: Clock, running: Iterable[str], topics: Mapping[str, Topic], graph: Graph) -> Clock:
        """With nodes and drivers of the robot that began when `simulated` was otherwise. Who simulates the robot need
        not listen to /clock, and who records it does in any case."""
        nodes = {self._namespace + node for node in running if node not in (BODY, RECORDER)}
        drivers = {node for purpose in TYPES if purpose in topics for node in topics[purpose].publishers}
        listeners = set(graph.subscribers("/clock"))
        if not clock.simulated:
            return replace(clock, awaited_by=tuple(sorted((nodes | drivers) & listeners)))
        makers = {self._namespace + BODY, *graph.publishers("/clock")}
        return replace(clock, ignored_by=tuple(sorted((nodes | drivers) - makers - listeners)))

    def _topics(self, set_up: SetUp, graph: Graph) -> dict[str, Topic]:
        """What the nodes of a robot with a body need. Where a launch file renames one, the node's own word counts."""
        if not set_up.has_body or not set_up.nodes:
            return {}
        found = {}
        for purpose, topic in topics_of(self._given).items():
            name = rosgraph.names.resolve_name(topic.name, self._namespace + "node")
            if purpose in ("scan", "odometry") and not graph.publishers(name):
                name = graph.renamed(topic.wanted, self._namespace + "slam") or name
            found[purpose] = replace(
                topic,
                name=name,
                kind=graph.kinds.get(name, "") if graph.publishers(name) else "",
                publishers=graph.publishers(name),
                subscribers=graph.subscribers(name),
            )
        return found

    def _on_status(self, message: Any) -> None:
        self._status = message

    def _radio_answers(self) -> bool:
        answered = threading.Event()

        def call() -> None:
            try:
                rospy.ServiceProxy(f"{self._namespace}adhoc_communication/get_neighbors", GetNeighbors)()
                answered.set()
            except (rospy.ServiceException, rospy.ROSException, OSError):
                pass

        threading.Thread(target=call, daemon=True).start()
        return answered.wait(PATIENCE)

    def _radio(self, answers: bool, listener: Listener) -> Radio:
        told = [each for each in listener.complaints() if _is_fault(each.part, each.text)]
        robots = tuple(self._status.robots) if self._status is not None else ()
        return Radio(answers, robots, tuple(told))

    def _last_words(self, node: str) -> str:
        """The last error in the log of a node that has ended; empty if there is none."""
        try:
            folder = Path(rospkg.get_log_dir()) / str(self._master.getParam("/run_id"))
        except (rosgraph.MasterException, OSError):
            return ""
        logs = sorted(folder.glob(f"{node}-*.log"), key=lambda path: path.stat().st_mtime, reverse=True)
        for log in logs:
            found = _LAST_WORDS.findall(log.read_bytes()[-TAIL:].decode(errors="replace"))
            if found:
                return str(found[-1]).strip()
        return ""


def _is_fault(part: str, text: str) -> bool:
    """A weak link is none: robots drive out of reach. Open frames are the user's choice, and what else is told of
    security is told of the frames that are refused, too."""
    return part != "security" and not (part == "neighbors" and " lost to " in text)


@dataclass(frozen=True)
class Graph:
    """Who publishes and subscribes what, and the types, by full names."""

    publishing: Mapping[str, list[str]]
    subscribing: Mapping[str, list[str]]
    kinds: Mapping[str, str]

    def publishers(self, topic: str) -> tuple[str, ...]:
        return tuple(node for node in self.publishing.get(topic, ()) if not node.startswith("/doctor"))

    def subscribers(self, topic: str) -> tuple[str, ...]:
        return tuple(node for node in self.subscribing.get(topic, ()) if not node.startswith("/doctor"))

    def renamed(self, kind: str, node: str) -> str:
        """The topic of that type that the node reads and somebody publishes; empty if there is none."""
        for topic, nodes in self.subscribing.items():
            if node in nodes and self.kinds.get(topic) == kind and self.publishers(topic):
                return topic
        return ""
