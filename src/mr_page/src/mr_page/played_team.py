"""A synthetic team whose robots feed a server of its page in a process of its own, for tests and measurements."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Iterator

from mr_page.feeds import FeedLink
from mr_page.server import listening_sockets
from mr_page.synthetic_team import STEP, SyntheticTeam
from mr_page.update import encoded
from mr_page.viewer import Viewer

TITLE = "made-up floor, 8 robots"
PATIENCE = 10.0  # s
TURN = 0.02  # s between two looks at all feeds


class PlayedTeam:
    """`port`: of the page; `server`: process id of its server."""

    def __init__(self, team: SyntheticTeam, folder: Path) -> None:
        self._listener = listening_sockets(0, "127.0.0.1")[0]
        self.port = int(self._listener.getsockname()[1])
        feeds = str(folder / "feeds")
        given = self._listener.fileno()
        command = [sys.executable, "-m", "mr_page.team_page", "--feeds", feeds, "--radio", str(folder / "radio")]
        self._process = subprocess.Popen([*command, "--descriptor", str(given), "--title", TITLE], pass_fds=[given])
        self.server = self._process.pid
        self._team = team
        self._stop = threading.Event()
        self._links = [(_connected(feeds, robot.name), Viewer(robot.state), robot) for robot in team.robots]
        self._thread = threading.Thread(target=self._play)
        self._thread.start()

    def close(self) -> None:
        self._stop.set()
        self._thread.join()
        self._process.terminate()
        self._process.wait()
        self._listener.close()

    def server_seconds(self) -> float:
        """Processor time of the server so far, s."""
        fields = Path(f"/proc/{self.server}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def _play(self) -> None:
        due = time.monotonic()
        while not self._stop.is_set():
            if time.monotonic() >= due:
                due += STEP
                self._team.step()
            for link, viewer, robot in self._links:
                update = viewer.update(time.monotonic())
                if update is not None:
                    link.send(encoded(update))
                for order in link.orders(0.001):
                    link.answer(self._team.obey(robot, order))
            self._stop.wait(TURN)


def _connected(path: str, robot: str) -> FeedLink:
    """When the server is there. OSError if it does not come."""
    end = time.monotonic() + PATIENCE
    while True:
        try:
            return FeedLink(path, robot)
        except OSError:
            if time.monotonic() > end:
                raise
            time.sleep(0.02)


@contextlib.contextmanager
def played_team(robots: int = 8, explored: float = 600.0, seed: int = 1) -> Iterator[PlayedTeam]:
    """A team that has explored for so many seconds, and goes on in real time."""
    team = SyntheticTeam(robots, seed, explored)
    with tempfile.TemporaryDirectory(prefix="mr_page-") as folder, contextlib.ExitStack() as stack:
        played = PlayedTeam(team, Path(folder))
        stack.callback(played.close)
        yield played
