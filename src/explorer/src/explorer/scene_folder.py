"""A folder with the recorded decisions of one robot. Used by hosts only: it writes files."""

import glob
import os
from typing import Callable, Optional

from explorer import scene_file
from explorer.decision import Decision
from explorer.errors import ExplorerError
from explorer.options import Options

MOST_FILES = 1000  # beyond, the oldest is removed


class SceneFolder:
    """`<path>/<robot>/decision_000000.json` and so on, in the order in which they were made. What a former run has left
    there is removed: decisions of two runs must not be taken for those of one."""

    def __init__(self, path: str, robot: str) -> None:
        """Raises `ExplorerError` if the folder cannot be made."""
        self._folder = os.path.join(os.path.expanduser(path), robot)
        self._count = 0
        try:
            os.makedirs(self._folder, exist_ok=True)
            for old in glob.glob(os.path.join(glob.escape(self._folder), "decision_*.json")):
                os.remove(old)
        except OSError as error:
            raise ExplorerError(f"parameter ~scene_path is {path!r}: {error}") from error

    def write(self, decision: Decision) -> None:
        """Raises `OSError` if that is not possible. A file appears complete or not at all."""
        path = self._path(self._count)
        with open(path + ".part", "w", encoding="utf-8") as file:
            file.write(scene_file.text_of(decision))
        os.replace(path + ".part", path)
        oldest = self._path(self._count - MOST_FILES)
        self._count += 1
        if self._count > MOST_FILES and os.path.exists(oldest):
            os.remove(oldest)

    def _path(self, number: int) -> str:
        return os.path.join(self._folder, f"decision_{number:06d}.json")


def recorder(options: Options) -> Optional[Callable[[Decision], None]]:
    """What writes the decisions of a robot; None if its parameters do not ask for it."""
    return SceneFolder(options.scene_path, options.robot_name).write if options.scene_path else None
