"""The course of one mission: wait for all nodes, start, watch, notice the end."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Callable

from mr_launch.errors import TeamFailure
from mr_launch.mission_clock import MissionClock
from mr_launch.plan import Plan
from mr_launch.reports import FINISHED, ReportServer, RobotReport
from mr_launch.truth import Truth
from mr_launch.view import Picture, RobotRow
from mr_measures.patience import HOME_PATIENCE

READY_PATIENCE = 120.0  # s of real time for masters, nodes and the first maps
STANDSTILL_PATIENCE = 60.0  # s of real time without simulation time
SAVE_PATIENCE = 15.0  # s of real time for the monitors to hand over the final maps
TICK = 0.25  # s


@dataclass
class Outcome:
    """How it ended. Times in s of simulation time; ``reason`` is empty when every robot finished; ``failed``: something
    broke; ``restarts``: how often which node of which robot was started again."""

    start: float = 0.0
    end: float = 0.0
    reason: str = ""
    failed: bool = False
    notes: list[str] = field(default_factory=list)
    restarts: dict[str, dict[str, int]] = field(default_factory=dict)


class Interrupted(Exception):
    """The user asked to stop."""


class Mission:
    """Talks to the monitors and follows the truth trace; starts and stops no process.

    Args:
        plan: the mission.
        server: the monitors' reports.
        truth: trace of the world.
        failures: lists what broke since the start, empty while all is well.
        stopped: true when the user asked to stop.
        show: takes the current picture.
    """

    def __init__(
        self,
        plan: Plan,
        server: ReportServer,
        truth: Truth,
        failures: Callable[[], list[str]],
        stopped: Callable[[], bool],
        show: Callable[[Picture], None],
    ) -> None:
        self.outcome = Outcome()
        self._plan = plan
        self._server = server
        self._truth = truth
        self._failures = failures
        self._stopped = stopped
        self._show = show
        self._clock = MissionClock()
        self._phase = "getting ready"
        self._may_start = False
        self._asked: dict[str, RobotReport] = {}  # which of its starts each robot was told to explore in
        self._wall_start = time.monotonic()
        self._moved: tuple[float, float] = (0.0, time.monotonic())  # latest simulation time, when it was new
        self.on_start: Callable[[], None] = lambda: None

    @property
    def reports(self) -> list[RobotReport]:
        return list(self._server.reports.values())

    def run(self) -> Outcome:
        """The whole mission. Raises TeamFailure or Interrupted; the outcome so far stays readable."""
        self._wait_until(self._all_ready, READY_PATIENCE, self._missing)
        self._start()
        self._phase = "exploring"
        self._follow(lambda: all(report.exploration_finished for report in self.reports), self._plan.options.duration)
        if self.outcome.reason:
            return self.outcome
        self._phase = "returning"
        since_start = self._clock.time - self.outcome.start
        self._follow(lambda: all(report.state == FINISHED for report in self.reports), since_start + HOME_PATIENCE)
        if self.outcome.reason:
            late = ", ".join(report.robot for report in self.reports if report.state != FINISHED)
            self.outcome.notes.append(f"not at rest {HOME_PATIENCE:.0f} s after the end of exploration: {late}")
            self.outcome.reason = ""
        return self.outcome

    def collect_maps(self) -> list[str]:
        """Ask every monitor for its final map; returns the robots that gave none."""
        for report in self.reports:
            report.saved = ""
            self._server.request(report.robot, request="save", path=self._plan.socket(f"{report.robot}.npz"))
        end = time.monotonic() + SAVE_PATIENCE
        while time.monotonic() < end and not all(report.saved for report in self.reports):
            self._server.wait(TICK)
        return [report.robot for report in self.reports if not report.saved]

    def _all_ready(self) -> bool:
        return all(not report.missing for report in self.reports)

    def _missing(self) -> str:
        waiting = [f"{report.robot} waits for {', '.join(report.missing)}" for report in self.reports if report.missing]
        return f"not ready after {READY_PATIENCE:.0f} s: {'; '.join(waiting)}; logs: {self._plan.log_folder()}"

    def _start(self) -> None:
        self._may_start = True
        self._wait_until(
            lambda: all(report.started for report in self.reports),
            30.0,
            lambda: (
                "no answer to explorer/start from "
                + ", ".join(report.robot for report in self.reports if not report.started)
            ),
        )
        self.outcome.start = min(report.start_time for report in self.reports)
        self.on_start()

    def _start_robots(self) -> None:
        """Those that are up and wait, once in each of their starts."""
        if not self._may_start:
            return
        for report in self.reports:
            if report.start_error:
                raise TeamFailure(f"explorer of {report.robot} does not start: {report.start_error}")
            if not report.missing and not report.started and self._asked.get(report.robot) is not report:
                self._asked[report.robot] = report
                self._server.request(report.robot, request="start")

    def _wait_until(self, done: Callable[[], bool], patience: float, complain: Callable[[], str]) -> None:
        end = time.monotonic() + patience
        while not done():
            self._tick()
            if time.monotonic() > end:
                raise TeamFailure(complain())

    def _follow(self, done: Callable[[], bool], limit: float) -> None:
        """Until ``done`` or until ``limit`` s of simulation time since the start."""
        while not done():
            self._tick()
            self._check_standstill()
            if self._clock.time - self.outcome.start > limit:
                self.outcome.reason = f"limit of {limit:.0f} s of simulation time reached"
                return

    def _tick(self) -> None:
        self._server.wait(TICK)
        self._truth.update()
        self._clock.update(self._truth.time, [report.time for report in self.reports], time.monotonic())
        self.outcome.end = self._clock.time
        self._show(self.picture())
        self._start_robots()
        if self._stopped():
            raise Interrupted
        broken = self._failures()
        if broken:
            raise TeamFailure("\n".join(broken))

    def _check_standstill(self) -> None:
        now = time.monotonic()
        if self._clock.time > self._moved[0]:
            self._moved = (self._clock.time, now)
        elif now - self._moved[1] > STANDSTILL_PATIENCE:
            log = self._plan.log_folder() / "world.log"
            raise TeamFailure(f"simulation time stands still at {self._clock.time:.1f} s; log: {log}")

    def picture(self) -> Picture:
        started = self.outcome.start > 0.0  # also while a robot is started again
        start, now = self.outcome.start, self._clock.time
        rows = [
            RobotRow(
                name=report.robot,
                state="waits for " + ", ".join(report.missing) if report.missing else report.state_name,
                coverage=report.coverage,
                explored=report.explored,
                distance=self._truth.tracks[report.robot].distance,
                goal=None if report.goal is None else (report.goal[0], report.goal[1]),
                neighbors=report.neighbors,
                merged=report.merged,
                text=report.text,
            )
            for report in self.reports
        ]
        return Picture(
            phase=self._phase,
            elapsed=now - start if started else 0.0,
            limit=self._plan.options.duration,
            real_time_factor=self._truth.real_time_factor(max(start, now - 20.0), now) if started else None,
            robots=rows,
        )
