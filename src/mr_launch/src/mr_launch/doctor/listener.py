"""Listens to one robot: topics of its drivers, tf, /clock, diagnostics. Judges nothing."""

from __future__ import annotations

import statistics
import time
from collections import deque
from dataclasses import replace
from typing import Any, Callable, Mapping

import numpy as np
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock as ClockMessage
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from mr_launch.doctor.facts import Clock, Complaint, Link, Topic

TYPES = {"scan": LaserScan, "odometry": Odometry}
WINDOW = 1000  # messages of one topic that are remembered
MOST_LINKS = 1000


class DriverTopic:
    """What comes on one topic with a header. `now` gives ROS time in s."""

    def __init__(self, now: Callable[[], float]) -> None:
        self._now = now
        self._stamps: deque[float] = deque(maxlen=WINDOW)
        self._ages: deque[float] = deque(maxlen=WINDOW)
        self._frame, self._valid = "", 1.0

    def take(self, message: Any) -> None:
        stamp = message.header.stamp.to_sec()
        self._stamps.append(stamp)
        self._ages.append(self._now() - stamp)
        self._frame = message.header.frame_id.strip("/")
        ranges = getattr(message, "ranges", None)
        if ranges is not None:
            # Infinity or no number is what some drivers say of nothing in reach, which is no fault.
            covered = ranges < message.range_min
            self._valid = 1.0 - float(np.mean(covered)) if len(ranges) else 0.0

    def fill(self, topic: Topic, seconds: float) -> Topic:
        """The same topic with what was heard within `seconds`."""
        count = len(self._stamps)
        if not count:
            return topic
        span = max(self._stamps) - min(self._stamps)
        rate = (count - 1) / span if count > 1 and span > 0.0 else count / seconds
        stamped, age = min(self._stamps) > 0.0, statistics.median(self._ages)
        return replace(topic, rate=rate, age=age, frame=self._frame, stamped=stamped, valid=self._valid)


class Listener:
    """Subscribes at once; tells what has come."""

    def __init__(self, topics: Mapping[str, Topic], simulated: bool) -> None:
        """`topics` by what they are for; `simulated`: ROS time is that of /clock."""
        self._simulated = simulated
        self._topics = dict(topics)
        self._times: deque[float] = deque(maxlen=WINDOW)
        self._maps = 0
        self._links: set[Link] = set()
        self._reports: list[set[Complaint]] = []
        self._drivers = {purpose: DriverTopic(self._now) for purpose in TYPES if purpose in topics}
        self._began = time.monotonic()
        rospy.Subscriber("/clock", ClockMessage, lambda message: self._times.append(message.clock.to_sec()))
        for name in ("/tf", "/tf_static"):
            rospy.Subscriber(name, TFMessage, self._on_transforms, queue_size=100)
        rospy.Subscriber("/diagnostics", DiagnosticArray, self._on_diagnostics, queue_size=10)
        if "map" in topics:
            rospy.Subscriber(topics["map"].name, rospy.AnyMsg, self._on_map, queue_size=1)
        for purpose, driver in self._drivers.items():
            topic = topics[purpose]
            if topic.kind in ("", topic.wanted):
                rospy.Subscriber(topic.name, numpy_msg(TYPES[purpose]), driver.take, queue_size=10)

    def clock(self, publishers: tuple[str, ...]) -> Clock:
        runs = len(self._times) > 1 and max(self._times) > min(self._times)
        return Clock(self._simulated, publishers, runs)

    def topics(self) -> dict[str, Topic]:
        seconds = time.monotonic() - self._began
        found = dict(self._topics)
        for purpose, driver in self._drivers.items():
            found[purpose] = driver.fill(found[purpose], seconds)
        if "map" in found:
            found["map"] = replace(found["map"], rate=self._maps / seconds)
        return found

    def links(self) -> tuple[Link, ...]:
        return tuple(sorted(self._links, key=lambda link: (link.child, link.parent, link.node)))

    def complaints(self) -> tuple[Complaint, ...]:
        """What adhoc_communication has said in every report: a robot that leaves makes it complain for a moment."""
        lasting = set.intersection(*self._reports) if self._reports else set()
        return tuple(sorted(lasting, key=lambda each: (-each.level, each.text)))

    def _now(self) -> float:
        if self._simulated:
            return self._times[-1] if self._times else 0.0
        return time.time()

    def _on_map(self, _: Any) -> None:
        self._maps += 1

    def _on_transforms(self, message: Any) -> None:
        node = message._connection_header["callerid"]
        for transform in message.transforms:
            if len(self._links) < MOST_LINKS:
                parent, child = transform.header.frame_id.strip("/"), transform.child_frame_id.strip("/")
                self._links.add(Link(parent, child, node))

    def _on_diagnostics(self, message: Any) -> None:
        ours = [status for status in message.status if status.name.startswith("adhoc_communication ")]
        if ours and len(self._reports) < WINDOW:
            self._reports.append(
                {
                    Complaint(status.name.split(": ")[-1], status.level, status.message)
                    for status in ours
                    if status.level
                }
            )
