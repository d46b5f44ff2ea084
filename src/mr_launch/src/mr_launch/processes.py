"""Child processes: start them with a log file each, notice when one ends, and end them all in order."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from pathlib import Path
from typing import Callable, Mapping, Sequence

from mr_launch import isolation

FEW_THREADS = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}


def program_environment() -> dict[str, str]:
    """For all programs of a team. Several nodes share few cores; threads of numerical libraries would only get in each
    other's way."""
    environment = {**os.environ, **FEW_THREADS}
    for name in isolation.MISLEADING:
        environment.pop(name, None)
    return environment


def dies_with_parent(kind: str) -> list[str]:
    """Without a PID namespace programs ask the kernel for a signal when the process that started them dies."""
    return ["setpriv", "--pdeathsig", "TERM", "--"] if kind == isolation.HUB else []


class Child:
    """One started program. Its output goes to ``log``; with ``may_finish`` a good end is no failure, and no end is of
    one that is not ``needed``."""

    def __init__(
        self, name: str, process: subprocess.Popen[bytes], log: Path, may_finish: bool, needed: bool = True
    ) -> None:
        self.name = name
        self.process = process
        self.log = log
        self.may_finish = may_finish
        self.needed = needed

    @property
    def failed(self) -> bool:
        """It ended although the mission needs it."""
        code = self.process.poll()
        return self.needed and code is not None and not (self.may_finish and code == 0)

    def describe_end(self) -> str:
        code = self.process.returncode
        how = f"ended with exit code {code}" if code >= 0 else f"was killed by {signal.Signals(-code).name}"
        return f"{self.name} {how}; its log is {self.log}{last_lines(self.log)}"


def last_lines(log: Path, count: int = 3) -> str:
    """The end of a log file for an error message, indented; empty if there is nothing to show."""
    try:
        lines = [line for line in log.read_text(errors="replace").splitlines() if line.strip()]
    except OSError:
        return ""
    return "".join(f"\n    {line[:200]}" for line in lines[-count:])


class Children:
    """All programs the team started, in the order of their start."""

    def __init__(self) -> None:
        self._children: list[Child] = []

    def start(
        self,
        name: str,
        command: Sequence[str],
        log: Path,
        environment: Mapping[str, str],
        may_finish: bool = False,
        needed: bool = True,
        descriptors: Sequence[int] = (),
    ) -> Child:
        """Start ``command`` in a session of its own, so that Ctrl-C reaches only the team's first process. It inherits
        ``descriptors``."""
        log.parent.mkdir(parents=True, exist_ok=True)
        with log.open("ab") as output:
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                env=dict(environment),
                start_new_session=True,
                pass_fds=descriptors,
            )
        child = Child(name, process, log, may_finish, needed)
        self._children.append(child)
        return child

    def forget(self, child: Child) -> None:
        """It has ended and another one has its place."""
        self._children.remove(child)

    def failed(self) -> list[Child]:
        return [child for child in self._children if child.failed]

    def running(self, name: str) -> list[Child]:
        return [child for child in self._children if child.name == name and child.process.poll() is None]

    def wait(self, name: str, patience: float, stopped: Callable[[], bool]) -> bool:
        """Whether all of that name have ended by themselves, within `patience` s and before somebody asked to stop."""
        return not still_running(self.running(name), patience, stopped)

    def stop(self, children: Sequence[Child], how: signal.Signals, patience: float) -> list[Child]:
        """Ask with one signal, wait ``patience`` seconds for all together, then kill. Returns those killed."""
        running = [child for child in children if child.process.poll() is None]
        for child in running:
            child.process.send_signal(how)
        running = still_running(running, patience)
        for child in running:
            child.process.kill()
            child.process.wait()
        return running

    def stop_all(self, patience: float) -> list[Child]:
        return self.stop(self._children[::-1], signal.SIGTERM, patience)

    def pids(self) -> set[int]:
        return {child.process.pid for child in self._children}

    def reap_orphans(self) -> None:
        """PID 1 inherits orphans; collect those that ended and leave our own children to their Popen."""
        while True:
            try:
                found = os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
            except ChildProcessError:
                return
            if found is None or found.si_pid in self.pids():
                return
            os.waitpid(found.si_pid, os.WNOHANG)


def still_running(
    children: Sequence[Child], patience: float, stopped: Callable[[], bool] = lambda: False
) -> list[Child]:
    """Those that have not ended by themselves after `patience` s, or when somebody asked to stop."""
    running, end = list(children), time.monotonic() + patience
    while running and time.monotonic() < end and not stopped():
        time.sleep(0.05)
        running = [child for child in running if child.process.poll() is None]
    return running


def cpu_seconds() -> dict[int, tuple[str, float, int]]:
    """CPU time of all visible processes: process id -> (command line, seconds of user and system time, parent)."""
    ticks = os.sysconf("SC_CLK_TCK")
    table = {}
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
            command = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace").strip()
        except (OSError, IndexError):
            continue
        table[int(entry.name)] = (command, (int(fields[11]) + int(fields[12])) / ticks, int(fields[1]))
    return table
