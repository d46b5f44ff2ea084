"""What has to be known of all bags before the first message of an export is written."""

from __future__ import annotations

from collections import Counter
from typing import Any, Mapping

from mr_grid import Pose
from mr_launch.merger_status import transforms_of
from mr_launch.recordings.bags import SECOND, Span, decoded, messages, place_of, span_of, topic_of
from mr_launch.recordings.clocks import shifts

POSITIONS, MERGER, STATIC, CLOCK = "position_other_robots", "map_merger/status", "tf_static", "clock"


class Survey:
    """One robot. `believed`: where the maps of others lie in its own, as its map_merger said last; `heard`: least delay
    in ns of what each other robot told; `static`: transforms that never change, by child frame; `broken`: how many of
    the messages that were looked at cannot be decoded, by bag and topic."""

    def __init__(self, reader: Any) -> None:
        self.span: Span = span_of(reader)
        self.connections = list(reader.connections)
        self.topics = {topic_of(connection) for connection in self.connections}
        self.simulated = CLOCK in self.topics
        self.believed: dict[str, Pose] = {}
        self.heard: dict[str, int] = {}
        self.static: dict[str, Any] = {}
        self.broken: Counter[tuple[str, str]] = Counter()
        take = {POSITIONS: self._take_position, MERGER: self._take_status, STATIC: self._take_static}
        wanted = [connection for connection in self.connections if topic_of(connection) in take]
        for connection, time, octets in messages(reader, wanted):
            message = decoded(reader, connection, octets)
            if message is None:
                self.broken[place_of(connection)] += 1
            else:
                take[topic_of(connection)](message, time)

    def _take_position(self, message: Any, time: int) -> None:
        stamp = message.position.header.stamp
        delay = time - (stamp.sec * SECOND + stamp.nanosec)
        self.heard[message.src_robot] = min(delay, self.heard.get(message.src_robot, delay))

    def _take_status(self, message: Any, _: int) -> None:
        self.believed = transforms_of(message)

    def _take_static(self, message: Any, _: int) -> None:
        self.static.update({transform.child_frame_id: transform for transform in message.transforms})


def clock_shifts(surveys: Mapping[str, Survey]) -> dict[str, int]:
    """What to add to the times of each robot to get the common ones, ns. Simulated robots have one clock. Robots whose
    clock nothing ties to the first one's are left out."""
    if all(survey.simulated for survey in surveys.values()):
        return dict.fromkeys(surveys, 0)
    heard = {(name, other): delay for name, survey in surveys.items() for other, delay in survey.heard.items()}
    return shifts(list(surveys), heard)
