"""What roslaunch says about the nodes of one robot: which ended, and where their logs are."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from mr_launch.disk_guard import LABEL

_ENDED = re.compile(
    r"\[(?P<name>[^\[\]\s]+?)-\d+\] process has (?P<how>died|finished cleanly)(?: \[(?P<detail>[^\]]*)\])?"
)
_NOT_STARTED = re.compile(r"ERROR: cannot launch node of type \[(?P<type>[^\]]+)\]: (?P<reason>[^\n\x1b]*)")
_LOG = re.compile(r"log file: (?P<pattern>[^\n\x1b]+)")
_RECORDING = re.compile(rf"^{LABEL}(?P<text>.*)$", re.MULTILINE)
_EXIT = re.compile(r"exit code (-?\d+)")
RECORDER = "bag"  # ends by itself when its bag is full; missions go on without it
ALWAYS_RESPAWNED = ("page",)  # nobody needs it
RESPAWNED = (
    "adhoc_communication",
    "map_merger",
    "explorer",
    "slam",
    "move_base",
    "mission_control",
    "velocity_override",
)  # by robot.launch with respawn:=true
MOST_RESTARTS = 20  # of one node in a mission


@dataclass(frozen=True)
class NodeEnd:
    """The end of one node. ``log`` is the pattern of its log files, empty if roslaunch gave none."""

    name: str
    clean: bool
    exit_code: int | None
    log: str
    reason: str = ""  # why it never started

    def describe(self, robot: str) -> str:
        if self.reason:
            return f"{self.name} of {robot} was not started: {self.reason}"
        how = "ended" if self.clean else f"died (exit code {self.exit_code})"
        return f"{self.name} of {robot} {how}; log: {self.log or 'none'}"

    def describe_recording(self) -> str:
        """Of the recorder."""
        log = f"; log: {self.log}" if self.log else ""
        return f"the recorder died (exit code {self.exit_code}); the mission goes on unrecorded{log}"


def parse_ends(output: str) -> list[NodeEnd]:
    """All ends of nodes in the output of roslaunch, except of those that may end by themselves."""
    ends = [
        NodeEnd(found["type"], clean=False, exit_code=None, log="", reason=found["reason"])
        for found in _NOT_STARTED.finditer(output)
    ]
    for found in _ENDED.finditer(output):
        if found["name"] == RECORDER and found["how"] != "died":
            continue
        following = output[found.end() :].split("process has", 1)[0]
        code = _EXIT.search(found["detail"] or "")
        log = _LOG.search(following)
        ends.append(
            NodeEnd(
                name=found["name"],
                clean=found["how"] != "died",
                exit_code=int(code[1]) if code else None,
                log=log["pattern"] if log else "",
            )
        )
    return ends


class NodeWatch:
    """Follows the output file of one roslaunch. `respawns`: it starts the nodes of `RESPAWNED` again; `begin`: octets
    in the file that are of roslaunches before."""

    def __init__(self, output: Path, respawns: bool = False, begin: int = 0) -> None:
        self._output = output
        self._begin = begin
        self._seen = begin
        self._respawns = respawns
        self.restarts: dict[str, int] = {}
        self._news: list[str] = []
        self._told = 0
        self._lost_maps = 0

    def failures(self) -> list[NodeEnd]:
        """Ends that the mission does not survive. The others are counted in `restarts`."""
        ends = self.new_ends()
        if not ends:
            return []
        started_again = ALWAYS_RESPAWNED + (RESPAWNED if self._respawns else ())
        self.restarts = dict(Counter(end.name for end in ends if end.name in started_again and not end.reason))
        return [end for end in ends if end.reason or not self._survives(end.name)]

    def _survives(self, node: str) -> bool:
        return node == RECORDER or node in ALWAYS_RESPAWNED or 0 < self.restarts.get(node, 0) <= MOST_RESTARTS

    def take_lost_map(self) -> bool:
        """Whether SLAM has ended since this was last asked, and its map with it."""
        before, self._lost_maps = self._lost_maps, self.restarts.get("slam", 0)
        return self._lost_maps > before

    def new_ends(self) -> list[NodeEnd]:
        """All ends so far if there are new ones, else none."""
        try:
            size = self._output.stat().st_size
        except OSError:
            return []
        if size == self._seen:
            return []
        self._seen = size
        output = self._output.read_bytes()[self._begin :].decode(errors="replace")
        ends = parse_ends(output)
        self._news = [found["text"] for found in _RECORDING.finditer(output)]
        self._news += [end.describe_recording() for end in ends if end.name == RECORDER]
        return ends

    def take_news(self) -> list[str]:
        """What people should know and the mission survives, each once."""
        new, self._told = self._news[self._told :], len(self._news)
        return new
