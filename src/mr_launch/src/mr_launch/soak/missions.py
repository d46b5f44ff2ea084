"""One mission of a soak: started, disturbed, sampled, ended, and what came of it."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Mapping, Sequence

from mr_launch.programs import free_ports
from mr_launch.soak.faults import DISK_MB, Fault, partitions
from mr_launch.soak.leftovers import Leftovers
from mr_launch.soak.memory import Samples
from mr_launch.soak.running import RunningMission
from mr_measures.record.files import STACK_RECORD, RecordError, read_record
from mr_measures.record.mission_record import MissionRecord

ROBOTS = ["robot_0", "robot_1", "robot_2"]
PERIOD = 2.0  # s between two samples
READY_PATIENCE, LIMIT_S = 150.0, 420.0  # s of real time until the robots explore; s of simulation time for a mission
ENDLESS_S = 86400.0
EXPLORING_S = 45.0  # for which all robots certainly explore
# Only what is worth keeping leaves a disk that vanishes with its namespace.
ON_SMALL_DISK = (
    'keep="$0"; out="$1"; shift; mount -t tmpfs -o size={size}m none "$out" || exit 3; "$@"; code=$?; '
    'cp "$out/record.json" "$keep/"; exit $code'
)


@dataclass
class Outcome:
    """`stuck`: robots that did not finish; `said`: lines of the runner that begin with its name; `faults`: what was
    done, `omitted`: what was to be done and could not; `exploring`, `hold`: real times between which all robots
    explored, or stood."""

    name: str
    code: int
    stuck: list[str]
    left: list[str]
    said: list[str]
    faults: list[Fault]
    omitted: list[Fault]
    restarts: Mapping[str, Mapping[str, int]]
    samples: Samples
    exploring: tuple[float, float] = (0.0, 0.0)
    hold: tuple[float, float] = (0.0, 0.0)
    output: str = field(default="", repr=False)

    @property
    def survived(self) -> bool:
        return self.code == 0 and not self.stuck and not self.left


class SoakMission:
    """`folder`: for its output; `world` as of the team runner; `page`: each robot has a node of the status page."""

    def __init__(
        self,
        name: str,
        folder: Path,
        world: str,
        seed: int,
        small_disk: bool = False,
        page: bool = False,
        robots: Sequence[str] = ROBOTS,
    ) -> None:
        self.name = name
        self._robots = robots
        self._folder = folder
        self._out = folder / "out"
        self._small_disk = small_disk
        asked: tuple[str, ...] = ("--world", world, "--robots", str(len(robots)), "--seed", str(seed), "--respawn")
        asked += ("--page", str(free_ports(1)[0])) if page else ()
        self._command = ["rosrun", "mr_launch", "team", *asked, "--out", str(self._out), "--duration"]

    def run(self, faults: Sequence[Fault] = (), hold: float = 0.0) -> Outcome:
        """`hold`: s for which the robots stand after they have explored, with partitions, before they may finish."""
        shutil.rmtree(self._folder, ignore_errors=True)
        self._out.mkdir(parents=True)
        log = self._folder / "output"
        with log.open("wb") as output:
            process = subprocess.Popen(self._words(hold), stdin=subprocess.DEVNULL, stdout=output, stderr=output,
                                       start_new_session=True)  # fmt: skip
        self._mission, self._samples = RunningMission(process, self._out), Samples()
        self._leftovers = Leftovers(self._mission)
        self._done: list[Fault] = []
        self._omitted: list[Fault] = []
        try:
            self._until(lambda: "\nexploring" in log.read_text(errors="replace"), READY_PATIENCE)
            begin = time.monotonic()
            held = self._hold(begin, hold) if hold else (0.0, 0.0)
            self._disturb(faults, begin)
            self._until(lambda: False, LIMIT_S)
        finally:
            self._end()
        text = log.read_text(errors="replace")
        record = self._record()
        return Outcome(
            name=self.name,
            code=process.returncode,
            stuck=[name for name in self._robots if not _finished(record, name)],
            left=self._leftovers.found(),
            said=[line.replace(f"{self._folder}/", "") for line in text.splitlines() if line.startswith("team: ")],
            faults=self._done,
            omitted=self._omitted,
            restarts=record.restarts if record else {},
            samples=self._samples,
            exploring=(begin, begin + EXPLORING_S),
            hold=held,
            output=text,
        )

    def _words(self, hold: float) -> list[str]:
        words = [*self._command, f"{ENDLESS_S if hold else LIMIT_S:g}"]
        if not self._small_disk:
            return words
        script = ON_SMALL_DISK.format(size=DISK_MB)
        return [
            "unshare",
            "--mount",
            "--propagation",
            "private",
            "sh",
            "-c",
            script,
            str(self._folder),
            str(self._out),
            *words,
        ]

    def _hold(self, begin: float, seconds: float) -> tuple[float, float]:
        """One robot is paused before it finishes, so the mission stays; when the others have ended, the time counts."""
        self._until(lambda: time.monotonic() - begin > EXPLORING_S, LIMIT_S)
        self._mission.enter(ROBOTS[0], "rosservice", "call", "/explorer/pause")
        self._until(self._others_stand, LIMIT_S)
        start = time.monotonic()
        self._disturb(partitions(ROBOTS, seconds), start)
        self._until(lambda: time.monotonic() - start > seconds, seconds + 60.0)
        end = time.monotonic()
        self._mission.enter(ROBOTS[0], "rosservice", "call", "/explorer/resume")
        return start, end

    def _others_stand(self) -> bool:
        """By what they publish: no goal is left."""
        look = ("timeout", "5", "rostopic", "echo", "-n1", "/explorer/state/has_goal")
        return all("False" in self._mission.enter(robot, *look) for robot in ROBOTS)

    def _disturb(self, faults: Sequence[Fault], begin: float) -> None:
        for fault in faults:
            self._until(lambda due=begin + fault.at: time.monotonic() >= due, LIMIT_S)  # type: ignore[misc]
            done = False
            if self._mission.process.poll() is None:
                with contextlib.suppress(OSError):
                    done = fault.do(self._mission)
            (self._done if done else self._omitted).append(fault)

    def _until(self, done: Any, patience: float) -> None:
        """Samples meanwhile; returns when the mission is over, too."""
        end = time.monotonic() + patience
        while self._mission.process.poll() is None and not done() and time.monotonic() < end:
            self._samples.take(self._mission)
            self._leftovers.look()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._mission.process.wait(PERIOD)

    def _end(self) -> None:
        """Ctrl-C for a mission that did not end; then it is over, however."""
        process = self._mission.process
        for number, patience in ((signal.SIGINT, 60.0), (signal.SIGTERM, 30.0), (signal.SIGKILL, 10.0)):
            if process.poll() is not None:
                return
            os.killpg(process.pid, number)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(patience)

    def _record(self) -> MissionRecord | None:
        place = self._folder if self._small_disk else self._out
        try:
            return read_record(place / STACK_RECORD)
        except RecordError:
            return None


def _finished(record: MissionRecord | None, robot: str) -> bool:
    found = record.robots.get(robot) if record else None
    return found is not None and found.state == "finished"
