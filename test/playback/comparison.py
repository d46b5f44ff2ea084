"""Stored expectations, read with rosbags, and how far observed messages are from them. No ROS is needed here."""

import dataclasses
import math
from pathlib import Path
from typing import Any, Dict, Iterator, List, Sequence

import numpy as np
from rosbags.highlevel import AnyReader


def stored(bag: Path) -> Dict[str, List[Dict[str, Any]]]:
    """All messages of a bag by topic (without leading slash) as plain values."""
    messages: Dict[str, List[Dict[str, Any]]] = {}
    with AnyReader([bag]) as reader:
        for connection, _, raw in reader.messages():
            message = plain(reader.deserialize(raw, connection.msgtype))
            messages.setdefault(connection.topic.lstrip("/"), []).append(message)
    return messages


def order(bag: Path) -> List[str]:
    """The topics (without leading slash) of all messages of a bag in their order."""
    with AnyReader([bag]) as reader:
        return [connection.topic.lstrip("/") for connection, _, _ in reader.messages()]


def plain(value: Any) -> Any:
    """A message of rospy or rosbags as nested dictionaries, lists, strings and numbers."""
    if dataclasses.is_dataclass(value):
        names = [field.name for field in dataclasses.fields(value) if not field.name.startswith("__")]
        return {{"sec": "secs", "nanosec": "nsecs"}.get(name, name): plain(getattr(value, name)) for name in names}
    if hasattr(value, "__slots__"):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    return value


def differences(expected: Any, observed: Any, tolerance: float, where: str = "") -> Iterator[str]:
    """A line for each place at which two plain values differ, numbers by more than `tolerance`."""
    if isinstance(expected, dict) and isinstance(observed, dict) and expected.keys() == observed.keys():
        for name in expected:
            yield from differences(expected[name], observed[name], tolerance, f"{where}.{name}")
    elif isinstance(expected, list) and isinstance(observed, list) and len(expected) == len(observed):
        for index, pair in enumerate(zip(expected, observed)):
            yield from differences(*pair, tolerance, f"{where}[{index}]")
    elif isinstance(expected, float) and isinstance(observed, (int, float)):
        if not abs(observed - expected) <= tolerance:
            yield f"{where}: expected {expected:.3f}, observed {observed:.3f}"
    elif expected != observed:
        yield f"{where}: expected {_short(expected)}, observed {_short(observed)}"


def report(title: str, lines: Sequence[str], most: int = 8) -> str:
    """The text of a failed comparison."""
    rest = f"\n  ... and {len(lines) - most} more" if len(lines) > most else ""
    return f"{title} differs from the stored expectation:\n  " + "\n  ".join(lines[:most]) + rest


def cells_of(grid: Dict[str, Any]) -> np.ndarray:
    """Cells (rows, columns) of a plain OccupancyGrid."""
    return np.array(grid["data"], dtype=np.int8).reshape(grid["info"]["height"], grid["info"]["width"])


def planar(transform: Dict[str, Any]) -> tuple:
    """x and y in m, yaw in rad of a plain Transform."""
    rotation = transform["rotation"]
    yaw = 2.0 * math.atan2(rotation["z"], rotation["w"])
    return transform["translation"]["x"], transform["translation"]["y"], math.atan2(math.sin(yaw), math.cos(yaw))


def _short(value: Any) -> str:
    text = f"a list of {len(value)}" if isinstance(value, list) else repr(value)
    return text if len(text) < 80 else f"{text[:77]}..."
