"""The folder in which ~logOutput and `debug` write."""

import os
from typing import Mapping, Optional

import rospy

from mr_grid import OccupancyGrid
from mr_grid.log_folder import log_folder

from .effects import SaveDebugImages
from .log_files import (
    PERIODICAL_HEADER,
    PROGRESS,
    UPDATES_HEADER,
    LogBits,
    periodical_line,
    picture_of,
    updates_line,
)
from .report import LogFigures


class LogError(Exception):
    """Nothing, or not all, was written; the text says why."""


class LogFolder:
    """`<log_path>/map_merger/<robot>`; without a path nothing is written."""

    def __init__(self, log_path: str, robot: str) -> None:
        """`log_path`: empty for none; "~" is the home folder. LogError if the folder cannot be made or written to."""
        try:
            self._path = log_folder(log_path, "map_merger", robot)
        except OSError as error:
            raise LogError(f"parameter log_path is {log_path!r}: {error}") from error

    def write_output(
        self,
        bits: LogBits,
        local: Optional[OccupancyGrid],
        merged: Optional[OccupancyGrid],
        figures: LogFigures,
        now: float,
    ) -> None:
        """What ~logOutput asks for. LogError if there is no place for it or the disk refuses it."""
        if not self._path:
            raise LogError("parameter log_path is not set, so there is no place for the log")
        pictures = {}
        if merged is not None and bits & (LogBits.GLOBAL_MAP | PROGRESS):
            pictures["global.pgm"] = picture_of(merged)
        if local is not None and bits & (LogBits.LOCAL_MAP | PROGRESS):
            pictures["local.pgm"] = picture_of(local)
        try:
            self._write(pictures)
            if bits & PROGRESS:
                self._append("periodical.log", PERIODICAL_HEADER, periodical_line(now, figures, bits))
                self._append("updates_log", UPDATES_HEADER, updates_line(now, figures))
        except OSError as error:
            raise LogError(f"log not written: {error}") from error

    def write_debug(self, images: SaveDebugImages) -> None:
        """What cannot be written is reported once in a while."""
        if not self._path:
            return
        try:
            self._write({"local.pgm": picture_of(images.present), "old.pgm": picture_of(images.before)})
        except OSError as error:
            rospy.logwarn_throttle(60.0, f"map_merger: debug images not written: {error}")

    def _write(self, files: Mapping[str, bytes]) -> None:
        os.makedirs(self._path, exist_ok=True)
        for name, content in files.items():
            with open(os.path.join(self._path, name), "wb") as file:
                file.write(content)

    def _append(self, name: str, header: str, line: str) -> None:
        path = os.path.join(self._path, name)
        new = not os.path.exists(path)
        with open(path, "a", encoding="utf-8") as file:
            file.write((header if new else "") + line)
