"""A recorded mission as one MCAP of ROS 2: topics and frames below the robots' names, one time, one tree of frames."""

from __future__ import annotations

import contextlib
import heapq
import math
import shutil
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable, Iterator, NamedTuple, Sequence

from mr_grid import Pose
from mr_launch.errors import UserError
from mr_launch.recordings.bags import (
    SECOND,
    Span,
    decoded,
    latched,
    messages,
    opened,
    pause_between_clocks,
    place_of,
    topic_of,
)
from mr_launch.recordings.conversion import LATCHED, Conversion
from mr_launch.recordings.message_frames import below, rewrite
from mr_launch.recordings.recording import Recording
from mr_launch.recordings.selection import selection
from mr_launch.recordings.survey import STATIC, Survey, clock_shifts
from mr_launch.recordings.ties import by_transforms

ROOT = "world"
TRUTH = "base_pose_ground_truth"  # in the frame of the world, whatever its header says
POSITIONS, SHOWN_POSITIONS = "all_positions", "positions"
LIST_OF_POINTS, POSE_ARRAY = "adhoc_communication/msg/MmListOfPoints", "geometry_msgs/msg/PoseArray"
TF, TF_MESSAGE = "tf", "tf2_msgs/msg/TFMessage"


@dataclass
class Exported:
    """`span`: of the common time, ns. `untied`: robots whose frames hang below no common one; `untimed`: those whose
    clock nothing ties to the others'; `broken`: how many messages cannot be decoded, by bag and topic."""

    messages: int = 0
    span: tuple[int, int] = (0, 0)
    topics: dict[str, int] = field(default_factory=dict)
    untied: tuple[str, ...] = ()
    untimed: tuple[str, ...] = ()
    broken: dict[tuple[str, str], int] = field(default_factory=dict)


class _Source(NamedTuple):
    """One robot. `place`: of its map in the common frame; `shift`: from its clock to the common one, ns."""

    robot: str
    reader: Any
    survey: Survey
    place: Pose | None
    shift: int


def export(
    recording: Recording,
    target: Path,
    topics: Sequence[str] = (),
    everything: bool = False,
    compress: bool = False,
    progress: Callable[[float], None] = lambda share: None,
) -> Exported:
    """Writes `target`, which appears when it is complete. Raises UserError and OSError."""
    with contextlib.ExitStack() as stack:
        readers = {robot.name: stack.enter_context(opened(robot.bags)) for robot in recording.robots}
        surveys = {name: Survey(reader) for name, reader in readers.items()}
        sources, result = _sources(recording, readers, surveys)
        _check_clocks(sources, result)
        wanted = selection(topics, everything, {topic for survey in surveys.values() for topic in survey.topics})
        work = stack.enter_context(_work_folder(target))
        writer = _Writer(work, compress, Conversion([reader.typestore for reader in readers.values()]), result)
        with writer:
            writer.write_static(sources)
            broken = _write_all(writer, sources, wanted, recording.plan is not None, everything, progress)
        for survey in surveys.values():
            broken |= survey.broken  # the larger count of each: some were met twice
        result.broken = dict(broken)
        (work / f"{work.name}.mcap").replace(target)
    return result


def _check_clocks(sources: Sequence[_Source], result: Exported) -> None:
    """Raises UserError where times are those of two clocks: of one robot's bags, then of one beside the others."""
    for source in sources:
        _check_pause(source, source.survey.span)
    timed = [source for source in sources if source.robot not in result.untimed]
    start = min(source.survey.span.start + source.shift for source in timed)
    end = max(source.survey.span.end + source.shift for source in timed)
    for source in timed:
        _check_pause(source, Span(start - source.shift, end - source.shift))


def _check_pause(source: _Source, span: Span) -> None:
    pause = pause_between_clocks(source.reader, span)
    if pause is not None:
        last, first = math.ceil(pause.start / SECOND), pause.end // SECOND
        raise UserError(
            f"{source.robot}: nothing was recorded from second {last} to {first} of its clock, so times are those of "
            "two clocks, simulated and real, and an export has one: "
            f"rosbag filter BAG PART.bag 't.to_sec() > {last + 1}' keeps what lies behind, with < what lies before"
        )


@contextlib.contextmanager
def _work_folder(target: Path) -> Iterator[Path]:
    """rosbags writes a folder; what is left of it goes."""
    work = target.with_name(f".{target.stem}.part")
    shutil.rmtree(work, ignore_errors=True)
    try:
        yield work
    finally:
        shutil.rmtree(work, ignore_errors=True)


def _sources(
    recording: Recording, readers: dict[str, Any], surveys: dict[str, Survey]
) -> tuple[list[_Source], Exported]:
    names = list(readers)
    if recording.plan:
        places = {robot.name: robot.start for robot in recording.plan.robots}
    else:
        places = by_transforms(names, {name: survey.believed for name, survey in surveys.items()})
    moves = clock_shifts(surveys)
    sources = [
        _Source(name, reader, surveys[name], places.get(name), moves.get(name, 0)) for name, reader in readers.items()
    ]
    result = Exported(
        span=(
            min(source.survey.span.start + source.shift for source in sources),
            max(source.survey.span.end + source.shift for source in sources),
        ),
        untied=tuple(name for name in names if name not in places),
        untimed=tuple(name for name in names if name not in moves),
    )
    return sources, result


def _write_all(
    writer: _Writer,
    sources: Sequence[_Source],
    wanted: Callable[[Any], bool],
    true_world: bool,
    everything: bool,
    progress: Callable[[float], None],
) -> Counter[tuple[str, str]]:
    """Returns how many messages cannot be decoded, by bag and topic."""
    broken: Counter[tuple[str, str]] = Counter()
    chosen = {source.robot: [each for each in source.survey.connections if wanted(each)] for source in sources}
    total = sum(each.msgcount for connections in chosen.values() for each in connections)
    streams = [_stream(source, chosen[source.robot]) for source in sources]
    for count, (time, source, connection, octets) in enumerate(heapq.merge(*streams, key=lambda entry: entry[0])):
        topic = topic_of(connection)
        if topic == STATIC or (topic == TRUTH and not true_world):
            continue
        found = decoded(source.reader, connection, octets)
        if found is None:
            broken[place_of(connection)] += 1
            continue
        message = writer.conversion.migrated(source.reader, connection.msgtype, found)
        rewrite(message, below(source.robot), source.shift)
        if topic == TRUTH:
            message.header.frame_id = ROOT
        if topic == POSITIONS:
            writer.write_positions(source.robot, message, time)
            if not everything:
                continue
        name = "/tf" if topic == TF else f"/{source.robot}/{topic}"
        writer.write(name, connection.msgtype, message, time, latched(connection))
        if count % 500 == 0:
            progress(count / total)
    progress(1.0)
    return broken


def _stream(source: _Source, connections: Sequence[Any]) -> Iterator[tuple[int, _Source, Any, bytes]]:
    for connection, time, octets in messages(source.reader, connections):
        yield time + source.shift, source, connection, octets


class _Writer:
    """Keeps the topics of the MCAP and counts."""

    def __init__(self, folder: Path, compress: bool, conversion: Conversion, result: Exported) -> None:
        from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

        self.conversion = conversion
        self._result = result
        self._writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
        if compress:
            self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        self._connections: dict[tuple[str, str], Any] = {}

    def __enter__(self) -> _Writer:
        self._writer.open()
        return self

    def __exit__(self, *error: Any) -> None:
        self._writer.__exit__(*error)

    def write(self, topic: str, kind: str, message: Any, time: int, keeps: bool = False) -> None:
        """`keeps`: late listeners are given the last message, too."""
        connection = self._connections.get((topic, kind))
        if connection is None:
            quality = LATCHED if keeps else ()
            connection = self._writer.add_connection(
                topic, kind, typestore=self.conversion.types, offered_qos_profiles=quality
            )
            self._connections[topic, kind] = connection
        self._writer.write(connection, time, self.conversion.octets(message, kind))
        self._result.messages += 1
        self._result.topics[topic] = self._result.topics.get(topic, 0) + 1

    def write_static(self, sources: Sequence[_Source]) -> None:
        """All transforms that never change in one message: viewers that seek take only the last one of a topic."""
        start = self._result.span[0]
        transforms = [self._tie(source.robot, source.place, start) for source in sources if source.place is not None]
        for source in sources:
            for found in source.survey.static.values():
                kept = source.reader.typestore.serialize_ros1(found, "geometry_msgs/msg/TransformStamped")
                message = self.conversion.message(source.reader, "geometry_msgs/msg/TransformStamped", kept)
                rewrite(message, below(source.robot), 0)
                message.header.stamp = self._stamp(start)
                transforms.append(message)
        self.write("/tf_static", TF_MESSAGE, self.conversion.make(TF_MESSAGE, transforms), start, keeps=True)

    def write_positions(self, robot: str, message: Any, time: int) -> None:
        """Where a robot believes the others to be, as poses, which viewers draw."""
        make = self.conversion.make
        still = make("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0)
        poses = [
            make("geometry_msgs/msg/Pose", make("geometry_msgs/msg/Point", point.x, point.y, 0.0), still)
            for point in message.positions
        ]
        header = make("std_msgs/msg/Header", self._stamp(time), f"{robot}/map")
        self.write(f"/{robot}/{SHOWN_POSITIONS}", POSE_ARRAY, make(POSE_ARRAY, header, poses), time)

    def _tie(self, robot: str, place: Pose, time: int) -> Any:
        make = self.conversion.make
        half = 0.5 * place.yaw
        transform = make(
            "geometry_msgs/msg/Transform",
            make("geometry_msgs/msg/Vector3", place.x, place.y, 0.0),
            make("geometry_msgs/msg/Quaternion", 0.0, 0.0, math.sin(half), math.cos(half)),
        )
        header = make("std_msgs/msg/Header", self._stamp(time), ROOT)
        return make("geometry_msgs/msg/TransformStamped", header, f"{robot}/map", transform)

    def _stamp(self, time: int) -> Any:
        return self.conversion.make("builtin_interfaces/msg/Time", *divmod(time, SECOND))
