"""Messages of ROS 1 as those of ROS 2, by rosbags: standard types as ROS 2 defines them, all others as they were."""

from __future__ import annotations

from typing import Any, Sequence

from rosbags.convert.converter import LATCH, migrate_message
from rosbags.typesys import Stores, get_typestore

LATCHED: Sequence[Any] = LATCH  # quality of service of what late listeners are given, too


class Conversion:
    """`types`: what the bags define. What ROS 2 knows is taken from there."""

    def __init__(self, types: Sequence[Any]) -> None:
        self.types = get_typestore(Stores.ROS2_HUMBLE)
        for store in types:
            new = {name: fields for name, fields in store.fielddefs.items() if name not in self.types.fielddefs}
            self.types.register(new)
        self._defaults: dict[str, object] = {}

    def message(self, reader: Any, kind: str, octets: bytes) -> Any:
        """A message of a bag as a value of ROS 2, which may be changed."""
        return self.migrated(reader, kind, reader.typestore.deserialize_ros1(octets, kind))

    def migrated(self, reader: Any, kind: str, found: Any) -> Any:
        """The same of one that is decoded."""
        return migrate_message(reader.typestore, self.types, kind, kind, self._defaults, found)

    def octets(self, message: Any, kind: str) -> Any:
        """In CDR, as ROS 2 sends it."""
        return self.types.serialize_cdr(message, kind)

    def make(self, kind: str, *values: Any) -> Any:
        """A message of type `kind` of its fields in their order."""
        return self.types.types[kind](*values)
