"""First process of a replay: ``python3 -m mr_launch.recordings.inside LIFELINE PLAN``, started by mr_launch.outside."""

from __future__ import annotations

import contextlib
import os
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Callable

from mr_launch import isolation
from mr_launch.errors import TeamFailure
from mr_launch.exit_codes import FAILED, INTERRUPTED, OK
from mr_launch.first_process import hold_lifeline, make_private_file_system
from mr_launch.lifeline import Lifeline
from mr_launch.mission import Interrupted
from mr_launch.network import hold_namespace
from mr_launch.nodes import NodeWatch
from mr_launch.plan import namespace_prefix
from mr_launch.processes import Child, Children, dies_with_parent, program_environment
from mr_launch.recordings.replay_plan import SAVE, PlayedRobot, ReplayPlan, environment, launch_command
from mr_launch.reports import ReportServer
from mr_launch.running_state import remove_state, write_state
from mr_launch.team import NODES_PATIENCE, START_PATIENCE

READY_PATIENCE = 90.0  # s of real time for masters and nodes
STANDSTILL_PATIENCE = 30.0  # s of real time without recorded time
SLOWER = 1.2  # factor on the real time of a replay from which on it is said that it took longer
SAVE_PATIENCE = 15.0  # s of real time for the maps
TICK = 0.25  # s


class Replay:
    """From the first process to the last file."""

    def __init__(self, plan: ReplayPlan, lifeline: Lifeline) -> None:
        self.plan = plan
        self._lifeline = lifeline
        self._children = Children()
        self._launches: list[Child] = []
        self._holders: dict[str, int] = {}
        self._watches: dict[str, NodeWatch] = {}
        self._begun = False

    def run(self) -> int:
        names = [robot.name for robot in self.plan.robots]
        make_private_file_system(self.plan.isolation, self.plan.private, names)
        self._server = ReportServer(self.plan.socket("reports"), names)
        self._reports = self._server.reports
        try:
            return self._play()
        except Interrupted:
            say("replay: interrupted, winding up")
            return INTERRUPTED
        except TeamFailure as failure:
            say(f"replay: {failure}")
            return FAILED
        finally:
            self._wind_up()

    def _play(self) -> int:
        for robot in self.plan.robots:
            self._start(robot)
        write_state(
            Path(self.plan.out),
            self.plan.isolation,
            self._lifeline.wait_for_init(5.0),
            self._holders,
            {robot.name: environment(self.plan, robot) for robot in self.plan.robots},
        )
        self._wait(lambda: not any(report.missing for report in self._reports.values()), READY_PATIENCE, self._missing)
        self._begun = True
        say(f"replay: plays; look inside with: {look_inside(self.plan)}")
        for name in self._reports:
            self._server.request(name, request="go")
        begun = time.monotonic()
        self._follow()
        taken = time.monotonic() - begun
        if SAVE in self.plan.compute:
            self._save_maps()
        say(f"replay: played to the end, {self.plan.seconds:.0f} s{delay(self.plan.seconds / self.plan.rate, taken)}")
        return OK

    def _start(self, robot: PlayedRobot) -> None:
        log = self.plan.log_folder() / f"{robot.name}.log"
        surroundings = program_environment()
        prefix: list[str] = dies_with_parent(self.plan.isolation)
        if self.plan.isolation != isolation.HUB:
            holder = hold_namespace(robot.name, self._children, self.plan.log_folder() / "network.log", surroundings)
            self._holders[robot.name] = holder.process.pid
            prefix = namespace_prefix(holder.process.pid)
            done = subprocess.run(
                [*prefix, "ip", "link", "set", "lo", "up"], capture_output=True, text=True, check=False
            )
            if done.returncode:
                raise TeamFailure(f"no loopback for {robot.name}: {done.stderr.strip()}")
        command = [*prefix, *launch_command(self.plan, robot)]
        child = self._children.start(robot.name, command, log, {**surroundings, **environment(self.plan, robot)})
        self._launches.append(child)
        self._watches[robot.name] = NodeWatch(log)

    def _follow(self) -> None:
        """Until every robot's time has come to the end of its recording, and its nodes to there."""
        ends = {robot.name: robot.end for robot in self.plan.robots}
        newest, since, told = 0.0, time.monotonic(), 0.0
        while any(report.time < ends[name] for name, report in self._reports.items()):
            self._tick()
            left = max(ends[name] - report.time for name, report in self._reports.items())
            done = min(self.plan.seconds, max(0.0, self.plan.seconds - left))
            if done > newest:
                newest, since = done, time.monotonic()
            elif time.monotonic() - since > STANDSTILL_PATIENCE:
                nodes = f", or {' or '.join(self.plan.compute)} cannot keep up" if self.plan.compute else ""
                raise TeamFailure(f"time stands still at {done:.1f} s{nodes}; logs: {self.plan.log_folder()}")
            if done - told >= 10.0 * self.plan.rate:
                told = done
                say(f"replay: {done:.0f} of {self.plan.seconds:.0f} s")

    def _save_maps(self) -> None:
        for robot in self.plan.robots:
            path = str(Path(self.plan.out) / robot.name / "map")
            self._server.request(robot.name, request="save", path=path)
        self._wait(
            lambda: all(report.saved for report in self._reports.values()),
            SAVE_PATIENCE,
            lambda: (
                "no map from " + ", ".join(name for name, report in self._reports.items() if not report.saved)
                + f"; logs: {self.plan.log_folder()}"
            ),
        )  # fmt: skip

    def _missing(self) -> str:
        waiting = [
            f"{name} waits for {', '.join(each.missing)}" for name, each in self._reports.items() if each.missing
        ]
        return f"not ready after {READY_PATIENCE:.0f} s: {'; '.join(waiting)}; logs: {self.plan.log_folder()}"

    def _wait(self, done: Callable[[], bool], patience: float, complain: Callable[[], str]) -> None:
        end = time.monotonic() + patience
        while not done():
            self._tick()
            if time.monotonic() > end:
                raise TeamFailure(complain())

    def _tick(self) -> None:
        self._server.wait(TICK)
        if self._lifeline.stop.is_set():
            raise Interrupted
        broken = [child.describe_end() for child in self._children.failed()]
        broken += [end.describe(name) for name, watch in self._watches.items() for end in watch.failures()]
        self._children.reap_orphans()
        if broken:
            raise TeamFailure("\n".join(broken))

    def _wind_up(self) -> None:
        self._children.stop(self._launches, signal.SIGINT, NODES_PATIENCE if self._begun else START_PATIENCE)
        self._children.stop_all(5.0)
        self._server.close()
        with contextlib.suppress(OSError):
            remove_state(Path(self.plan.out))


def look_inside(plan: ReplayPlan) -> str:
    """A command that works from the moment on at which the robots are there."""
    out = min(plan.out, os.path.relpath(plan.out), key=len)
    return f"rosrun mr_launch enter --team {shlex.quote(out)} {plan.robots[0].name} rostopic list"


def delay(asked: float, taken: float) -> str:
    """What is said of a replay that took longer than asked for, both in s of real time."""
    late = taken > SLOWER * asked + TICK
    return f" in {taken:.0f} s, not {asked:.0f} s: time waits for nodes that need longer" if late else ""


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def main() -> int:
    plan = ReplayPlan.from_json(sys.argv[2])
    lifeline = hold_lifeline(int(sys.argv[1]), plan.isolation, plan.private)
    try:
        return Replay(plan, lifeline).run()
    except TeamFailure as failure:
        say(f"replay: {failure}")
        return FAILED


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    os._exit(code)  # the lifeline's thread may sit in a read
