"""The folder of the log files."""

import os

import rospy

from explorer import logs
from explorer.errors import ExplorerError
from explorer.messages import WriteLog
from mr_grid.log_folder import is_full, log_folder


class LogFolder:
    """`<log_path>/explorer/<robot>`; without a path nothing is written."""

    def __init__(self, log_path: str, robot: str, goes_on: bool) -> None:
        """`goes_on`: with the files of a former run of the node. ExplorerError if they cannot be written, unless it is
        for a full disk."""
        try:
            self._path = log_folder(log_path, "explorer", robot)
            if self._path and not goes_on:
                self._put("periodical.log", logs.PERIODICAL_HEADER, append=False)
        except OSError as error:
            if not is_full(error):
                raise ExplorerError(f"parameter ~log_path is {log_path!r}: {error}") from error
            self._complain(error)

    def write(self, effect: WriteLog) -> None:
        """What cannot be written is reported once in a while."""
        if not self._path:
            return
        try:
            self._put(effect.name, effect.text, effect.append)
        except OSError as error:
            self._complain(error)

    def _complain(self, error: OSError) -> None:
        text = f"explorer: cannot write the log in {self._path}: {error.strerror}; the mission goes on without"
        rospy.logwarn_throttle(60.0, text)

    def _put(self, name: str, text: str, append: bool) -> None:
        os.makedirs(self._path, exist_ok=True)
        with open(os.path.join(self._path, name), "a" if append else "w") as file:
            file.write(text)
