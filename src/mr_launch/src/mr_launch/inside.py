"""First process of a running team. ``python3 -m mr_launch.inside LIFELINE PLAN [PAGE]`` is started by
mr_launch.outside.

In namespaces it is PID 1: whatever ends it, the kernel ends the rest.
"""

from __future__ import annotations

import os
import sys
import time
from dataclasses import replace
from pathlib import Path

from mr_launch.errors import TeamFailure
from mr_launch.exit_codes import FAILED, INTERRUPTED, OK
from mr_launch.first_process import hold_lifeline, make_private_file_system
from mr_launch.lifeline import Lifeline
from mr_launch.map_starts import MapStarts
from mr_launch.mission import Interrupted, Mission, Outcome
from mr_launch.plan import Plan
from mr_launch.processes import cpu_seconds
from mr_launch.processor_shares import cpu_shares
from mr_launch.reports import ReportServer
from mr_launch.results import print_results, write_results
from mr_launch.team import Team
from mr_launch.truth import Truth
from mr_launch.view import View


class Run:
    """One mission from the first process to the last file."""

    def __init__(self, plan: Plan, lifeline: Lifeline, page: int | None) -> None:
        self.plan = plan
        self.lifeline = lifeline
        self.view = View(plan.options.quiet)
        self.team = Team(plan, lifeline.wait_for_init(5.0), page)
        self.truth = Truth(Path(plan.out) / "truth.csv", [robot.name for robot in plan.robots])
        self.outcome = Outcome()
        self._map_starts = MapStarts()
        self._cpu: dict[int, tuple[str, float, int]] = {}
        self._cpu_time = 0.0
        self._begun = time.time()

    def run(self) -> int:
        hosts = [host.name for host in self.plan.hosts]
        make_private_file_system(self.plan.isolation, self.plan.private, hosts)
        base = "" if self.plan.base is None else self.plan.base.name
        self.server = ReportServer(self.plan.socket("reports"), list(self.truth.tracks), base)
        self.mission = Mission(
            self.plan, self.server, self.truth, self._failures, self.lifeline.stop.is_set, self.view.show
        )
        self.outcome = self.mission.outcome
        self.team.place = lambda robot: self.truth.tracks[robot].place if robot in self.truth.tracks else None
        self.team.on_restart = self.server.begin_anew
        with self.view:
            code = self._explore()
            self.view.pause()
            return self._wind_up(code)

    def _explore(self) -> int:
        try:
            self.team.start(self.lifeline.stop.is_set)
            self.mission.on_start = self._start_of_measuring
            outcome = self.mission.run()
        except TeamFailure as failure:
            self.outcome.reason, self.outcome.failed = str(failure), True
            self.view.notice(f"team: {failure}")
            return FAILED
        except Interrupted:
            self.outcome.reason = "interrupted"
            self.view.notice("team: interrupted, winding up")
            return INTERRUPTED
        if outcome.reason:
            self.view.notice(f"team: {outcome.reason}")
            return FAILED
        return OK

    def _failures(self) -> list[str]:
        failures = self.team.failures()
        for news in self.team.news():
            self.view.notice(f"team: {news}")
            self.outcome.notes.append(news)
        self._follow_new_maps()
        return failures

    def _follow_new_maps(self) -> None:
        """Of robots whose SLAM was started again: figures count from where they began."""
        for robot in self.team.take_lost_maps():
            self._map_starts.lose(self.server.reports[robot], self.truth.time)
        starts = self._map_starts.found(self.server.reports, self.server.logs, self.truth.tracks)
        for robot, start in starts.items():
            self.team.starts[robot] = start
            self.server.request(robot, request="begin", start=list(start))

    def _start_of_measuring(self) -> None:
        self._cpu, self._cpu_time = cpu_seconds(), time.monotonic()

    def _wind_up(self, code: int) -> int:
        """Maps, orderly end of all nodes, and the files; also after a failure, with what there is."""
        cpu = self._cpu_shares()
        begun = self.outcome.start > 0.0
        if begun:
            self.mission.collect_maps()
        self.outcome.restarts = self.team.restarts
        self.team.stop_robots(begun)
        if begun and code != INTERRUPTED:
            self._await_reference()
        self.team.stop_rest()
        self.server.close()
        self.truth.update()
        try:
            plan = self._plan_of_results()
            record = write_results(plan, self.outcome, self.server, self.truth, self._begun, cpu)
        except OSError as error:
            self.view.notice(f"team: results cannot be written to {error.filename or self.plan.out}: {error.strerror}")
            return code or FAILED
        print_results(self.plan, record)
        return code

    def _await_reference(self) -> None:
        if self.team.has_reference:
            return
        self.view.notice("team: waits for the reference of the world, to compare the maps with (Ctrl-C does without)")
        if not self.team.wait_for_reference(self.lifeline.stop.is_set):
            self.view.notice("team: the reference of the world was not computed in time: maps are not measured")

    def _plan_of_results(self) -> Plan:
        """Maps of robots that were started again begin where they stood then."""
        starts = self.team.starts
        robots = [replace(robot, start=starts.get(robot.name, robot.start)) for robot in self.plan.robots]
        return replace(self.plan, robots=robots)

    def _cpu_shares(self) -> dict[str, dict[str, float]]:
        if not self._cpu:
            return {}
        launches = {name: child.process.pid for name, child in self.team.launches.items()}
        return cpu_shares(self._cpu, cpu_seconds(), launches, time.monotonic() - self._cpu_time)


def main() -> int:
    plan = Plan.from_json(sys.argv[2])
    page = int(sys.argv[3]) if sys.argv[3:] else None
    lifeline = hold_lifeline(int(sys.argv[1]), plan.isolation, plan.private)
    try:
        return Run(plan, lifeline, page).run()
    except TeamFailure as failure:
        print(f"team: {failure}", file=sys.stderr)
        return FAILED


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    os._exit(code)  # the lifeline's thread may sit in a read
