"""Frames and stamps inside messages of any type, as rosbags reads them."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any, Callable

from mr_launch.recordings.bags import SECOND

FRAME_FIELDS = ("frame_id", "child_frame_id")


def rewrite(message: Any, frame: Callable[[str], str], shift: int) -> None:
    """In place: each frame becomes `frame(name)`, each stamp of a header moves by `shift` ns. Empty names and
    stamps of zero say nothing and stay."""
    if isinstance(message, list):
        for entry in message:
            rewrite(entry, frame, shift)
        return
    if not is_dataclass(message):
        return
    for field in fields(message):
        value = getattr(message, field.name)
        if field.name in FRAME_FIELDS and value:
            setattr(message, field.name, frame(value))
        elif field.name == "stamp" and shift:
            _move(value, shift)
        elif isinstance(value, list) or is_dataclass(value):
            rewrite(value, frame, shift)


def _move(stamp: Any, shift: int) -> None:
    total = stamp.sec * SECOND + stamp.nanosec
    if total:
        stamp.sec, stamp.nanosec = divmod(total + shift, SECOND)


def below(robot: str) -> Callable[[str], str]:
    """Names of a robot's frames in the common tree: map of anna is anna/map."""
    return lambda name: f"{robot}/{name.lstrip('/')}"
