"""Connections to publishers that rospy has missed.

A publisher that registers at the very moment at which a node subscribes is in the master's update, but not in its
answer to the node. rospy takes whichever came last, so the older answer may hide the update: the node never connects,
and what is latched never reaches it.
"""

import contextlib
import threading
import xmlrpc.client
from http.client import HTTPException
from typing import Dict, Iterator, List, Set, Tuple

import rosgraph
import rospy
from rospy.impl.registration import get_topic_manager

FIRST_LOOK, LONGEST_PAUSE = 2.0, 30.0  # s; while nothing new is subscribed to, each pause is twice the one before
INBOUND = "i"

Publishers = Dict[str, List[str]]
"""Names or URIs of nodes by topic."""


def watch_connections() -> None:
    """From now on, beside what the node does. It has to be initialised."""
    threading.Thread(target=_Watch().run, name="connections", daemon=True).start()


class Missed:
    """Tells of each connection that stays missing once: an address that cannot be reached is not tried for ever."""

    def __init__(self) -> None:
        self._missing: Set[Tuple[str, str]] = set()
        self._told: Set[Tuple[str, str]] = set()

    def told_now(self, published: Publishers, connected: Publishers) -> Publishers:
        """URIs by topic, of `published` ones that were not among the `connected` at the look before, either."""
        pairs = {(topic, uri) for topic, uris in published.items() for uri in uris}
        missing = pairs - {(topic, uri) for topic, uris in connected.items() for uri in uris}
        told = (missing & self._missing) - self._told
        self._missing, self._told = missing, (self._told & pairs) | told
        return {topic: published[topic] for topic in {topic for topic, _ in told}}


class _Watch:
    def __init__(self) -> None:
        self._missed = Missed()
        self._master = rosgraph.Master(rospy.get_name())
        self._subscribed: Set[str] = set()

    def run(self) -> None:
        pause = FIRST_LOOK
        while not rospy.core.is_shutdown_requested():
            rospy.rostime.wallsleep(pause)
            subscribed = {topic for topic, _ in get_topic_manager().get_subscriptions()}
            pause = FIRST_LOOK if subscribed != self._subscribed else min(2.0 * pause, LONGEST_PAUSE)
            self._subscribed = subscribed
            # Who does not answer, or not in order, is asked again at the next look.
            with contextlib.suppress(OSError, HTTPException, xmlrpc.client.Error, rosgraph.MasterException):
                self._look()

    def _look(self) -> None:
        connected = _connected()
        published = {
            topic: nodes
            for topic, nodes in self._master.getSystemState()[0]
            if topic in self._subscribed and len(nodes) > len(connected.get(topic, []))
        }
        uris = {node: self._master.lookupNode(node) for nodes in published.values() for node in nodes}
        missed = self._missed.told_now(
            {topic: [uris[node] for node in nodes] for topic, nodes in published.items()}, connected
        )
        for topic, addresses in missed.items():
            rospy.loginfo(f"{rospy.get_name()}: is not connected to a publisher of {topic}, asks for it anew")
            xmlrpc.client.ServerProxy(rospy.get_node_uri()).publisherUpdate(rospy.get_name(), topic, addresses)


def _connected() -> Publishers:
    found: Publishers = {}
    for topic, uri in _inbound():
        found.setdefault(topic, []).append(uri)
    return found


def _inbound() -> Iterator[Tuple[str, str]]:
    for _, uri, direction, _, topic, *_ in get_topic_manager().get_pub_sub_info():
        if direction == INBOUND:
            yield topic, uri
