"""The file in which a map is written down while it grows, so that SLAM that is started anew after a crash goes on with
it. Only for the run of SLAM that wrote it and the next ones on the same computer: octets as they lie in its memory."""

import os
import tempfile
from pathlib import Path
from typing import NamedTuple

MAGIC = b"mr_robot map  2\n"
MOST = 1 << 30  # octets that are read; 20000 scans of 4000 beams are less


class JournalError(Exception):
    """A file that no map can be read from."""


class Kept(NamedTuple):
    state: bytes  # of a size that stays the same, written over and over
    entries: bytes


class MapJournal:
    """An open file; one process writes. All methods raise OSError as files do, as when the disk is full."""

    def __init__(self, path: Path, descriptor: int, state_size: int) -> None:
        self.path = path
        self._descriptor = descriptor
        self._state_size = state_size
        self._state = b""

    @classmethod
    def create(cls, folder: Path, state: bytes) -> "MapJournal":
        """A new file in the folder, which is made."""
        folder.mkdir(parents=True, exist_ok=True)
        descriptor, name = tempfile.mkstemp(suffix=".map", prefix="slam_", dir=folder)
        made = cls(Path(name), descriptor, len(state))
        _write(descriptor, MAGIC + state)
        return made

    @classmethod
    def open(cls, path: Path, state_size: int) -> "MapJournal":
        """Raises JournalError for what is no such file."""
        try:
            descriptor = os.open(path, os.O_RDWR)
        except OSError as error:
            raise JournalError(f"{path}: {error.strerror}") from error
        opened = cls(path, descriptor, state_size)
        if os.pread(descriptor, len(MAGIC), 0) != MAGIC or os.fstat(descriptor).st_size < opened._begin:
            opened.close()
            raise JournalError(f"{path} is no map of this version")
        return opened

    @property
    def _begin(self) -> int:
        return len(MAGIC) + self._state_size

    def read(self) -> Kept:
        self._state = os.pread(self._descriptor, self._state_size, len(MAGIC))
        with open(self.path, "rb") as file:
            file.seek(self._begin)
            return Kept(self._state, file.read(MOST))

    def keep_only(self, octets: int) -> None:
        """Of the entries; what is written next follows them."""
        os.ftruncate(self._descriptor, self._begin + octets)
        os.lseek(self._descriptor, 0, os.SEEK_END)

    def add(self, entries: bytes) -> None:
        _write(self._descriptor, entries)

    def set_state(self, state: bytes) -> None:
        if state != self._state:
            os.pwrite(self._descriptor, state, len(MAGIC))
            self._state = state

    def close(self) -> None:
        os.close(self._descriptor)

    def remove(self) -> None:
        """Nobody is to go on with this map."""
        self.close()
        self.path.unlink(missing_ok=True)


def _write(descriptor: int, octets: bytes) -> None:
    """A write may be short without an error, as the last one that a disk has room for."""
    left = memoryview(octets)
    while left:
        left = left[os.write(descriptor, left) :]
