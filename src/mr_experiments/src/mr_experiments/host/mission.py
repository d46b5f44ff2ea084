"""One whole mission in virtual time: world, sensors, SLAM, radio, merging, auctions, navigation in one process."""

from __future__ import annotations

import functools
import math
from dataclasses import replace
from typing import Callable

import numpy as np

from explorer.status import State
from mr_experiments.common.stopwatch import Stopwatch
from mr_experiments.host import base_station
from mr_experiments.host.agenda import Agenda
from mr_experiments.host.base_station import BaseStation
from mr_experiments.host.exploring import TICK
from mr_experiments.host.fast.fast_body import FastBody
from mr_experiments.host.fast.perfect_radio import PerfectRadio
from mr_experiments.host.fast.team_sight import TeamSight
from mr_experiments.host.parameters import Member, explorer_options, merger_options, navigation_options, slam_options
from mr_experiments.host.radio import EVERYWHERE, Radio, TeamRadio, Walls
from mr_experiments.host.recorder import Recorder
from mr_experiments.host.robot import Robot
from mr_experiments.host.start_up import StartUp
from mr_experiments.trial.trial import Trial
from mr_experiments.trial.trial_world import platforms_of, world_of
from mr_grid import Pose
from mr_measures.patience import HOME_PATIENCE
from mr_robot.platforms.parameters import kinds_of
from mr_sim.body import Body
from mr_sim.world import World

READY_PATIENCE = 30.0  # s until every robot must have a map and a pose
OUT_OF_REACH = 10.0 * EVERYWHERE  # m
RADIO_PERIOD = 0.5  # s between two readings of the robots' places by the radio
FAST_STEP = 0.1  # s, of the motion of robots with perfect maps
VIEW_PERIOD = 0.5  # s between two looks
FAST_TICK = 0.5  # s between ticks of their explorers
START_SPREAD = 0.1  # m, to each side, of the start poses in fast mode
START_TURN = 0.2  # rad, same
ODOMETRY, TRUE = ["odometry_x", "odometry_y", "odometry_yaw"], ["x", "y", "yaw"]


class Mission:
    """Owns the virtual time, s since the world began to move."""

    def __init__(self, trial: Trial, snapshot_period: float = math.inf, scene_path: str = "") -> None:
        """`snapshot_period`: s between stored global maps. `scene_path`: folder for the explorers' decisions, empty for
        none. Raises TrialError."""
        self._scene_path = scene_path
        self.trial = trial
        self.world = world_of(trial)
        self.agenda = Agenda()
        self.stopwatch = Stopwatch()
        self.now = 0.0
        self.begun_at: float | None = None
        self._switched_on = False
        self._start_up = StartUp.of_team(trial.robots, trial.seed)
        self._ordered = False
        visible = self.world.visible
        walls = Walls(visible.cells, visible.resolution, visible.origin)
        self.radio: TeamRadio
        if trial.fast:
            self.radio = PerfectRadio(self.agenda)
        else:
            self.radio = Radio(trial.radio, trial.seed, walls)
        poses = _start_poses(trial, self.world)
        starts = dict(zip(self.world.names, poses))
        self._sight = TeamSight(starts)
        platforms = platforms_of(self.world)
        self._members = [Member(platform, tuple(kinds_of(platforms))) for platform in platforms]
        self.recorder = Recorder(trial, self.world, poses, snapshot_period)
        self.robots = [self._robot(index, starts) for index in range(trial.robots)]
        # Those that take part to the end, also if they join later.
        self._survivors = [robot for robot in self.robots if robot.index not in trial.deaths]
        self.base = None if trial.base is None else self._base_station(trial.base, starts)
        radios = [robot.own_radio for robot in self.robots]
        if self.base is not None:
            radios.append(self.base.own_radio)
        self.recorder.attach(self.robots, self.radio, [each.index for each in radios])

    def _robot(self, index: int, starts: dict[str, Pose]) -> Robot:
        name, description = self.world.names[index], self.world.robots[index]
        ranger, member = description.rangers[description.main_ranger], self._members[index]
        exploring = replace(explorer_options(self.trial, name, index, member), scene_path=self._scene_path)
        navigation = navigation_options(member)
        body: Body | FastBody
        if self.trial.fast:
            body = FastBody(name, starts[name], ranger, navigation, self.world.visible, self._sight, self.stopwatch)
        else:
            body = Body(name, ranger, slam_options(member), navigation, self.trial.seed, self.stopwatch.span)
        return Robot(
            index, starts[name], merger_options(self.trial, name, starts, member),
            exploring, body, self.trial.seed, self.agenda, self.radio,
            self.stopwatch, self.recorder, lambda: self.now,
            FAST_TICK if self.trial.fast else TICK, self._sight,
        )  # fmt: skip

    def _base_station(self, place: tuple[float, float], starts: dict[str, Pose]) -> BaseStation:
        boot = (self.trial.seed % 2**31, self.trial.robots + 1)
        options = merger_options(self.trial, base_station.NAME, starts, self._members[0])
        return BaseStation(
            place, options, boot, self.agenda, self.radio, self.stopwatch, self.recorder, lambda: self.now
        )  # fmt: skip

    def run(self, until: float = math.inf, progress: Callable[[float], None] = lambda _: None) -> None:
        """To the end of the mission, or to `until` s after its start for a replay. `progress` is told the time."""
        if not self._switched_on:
            self._switched_on = True
            self._switch_on()
        while not self._over() and self.since_start < until:
            self._advance()
            progress(self.since_start)

    def _switch_on(self) -> None:
        for robot in self.robots:
            if self.trial.joins.get(robot.index, 0.0) > 0.0:
                self.radio.switch_off(robot.own_radio.index)
            else:
                self._boot(robot, 0.0)
        if self.base is not None:
            self.base.start(0.0)
        if self.trial.fast:
            self.agenda.every(FAST_STEP, 0.0, lambda _: self._drive())
            self.agenda.every(VIEW_PERIOD, 0.0, lambda _: self._look())
        else:
            self._step_world(0.0)
            self.agenda.every(RADIO_PERIOD, 0.0, lambda _: self._tell_places())

    def _boot(self, robot: Robot, now: float) -> None:
        self.agenda.at(now + self._start_up.sensing[robot.index], lambda _: robot.start_sensing())
        self.agenda.at(now + self._start_up.nodes[robot.index], robot.switch_on)

    @property
    def since_start(self) -> float:
        """s since the mission was started; 0 before."""
        return 0.0 if self.begun_at is None else self.now - self.begun_at

    def _advance(self) -> None:
        """To the next moment at which something happens."""
        due = self.agenda.next_time
        with self.stopwatch.span("radio"):
            now = self.radio.advance(due)
            # The medium counts in whole nanoseconds.
            self.now = due if now >= due else max(self.now, now)
            self.radio.tell(self.now)
        if now >= due:
            self.agenda.run_due(due)

    def _step_world(self, now: float) -> None:
        with self.stopwatch.span("world"):
            self.world.step()
            scans = list(self.world.due_scans())
            states = self.world.states()
            odometry, true = states[ODOMETRY].tolist(), states[TRUE].tolist()
        for scan in scans:
            robot = self.robots[scan.robot]
            if scan.ranger == self.world.robots[scan.robot].main_ranger and robot.senses:
                robot.on_scan(scan.ranges, Pose(*odometry[scan.robot]))
                self._steer(robot, odometry)
                self.recorder.on_pose(scan.robot, Pose(*true[scan.robot]))
        for robot in self.robots:
            self._steer(robot, odometry)
        with self.stopwatch.span("recording"):
            self.recorder.on_step(states, self.since_start)
        self._start_if_ready()
        self.agenda.at((self.world.steps + 1) * self.world.interval, self._step_world)

    def _steer(self, robot: Robot, odometry: list[list[float]]) -> None:
        """If it is time for it. `odometry`: x, y, yaw of each robot."""
        velocities = robot.steer(Pose(*odometry[robot.index]))
        if velocities is not None:
            self.world.command(robot.index, *velocities)

    def _drive(self) -> None:
        for robot in self.robots:
            if robot.running:
                assert isinstance(robot.body, FastBody)
                robot.body.drive(FAST_STEP)

    def _look(self) -> None:
        """Robots that are where they want to be: no sensors, no contacts."""
        states = np.zeros(len(self.robots), dtype=self.world.states().dtype)
        for robot, state in zip(self.robots, states):
            assert isinstance(robot.body, FastBody)
            speed, turn = 0.0, 0.0
            if robot.senses:
                robot.on_view()
                self.recorder.on_pose(robot.index, robot.body.true_pose)
                speed, turn = robot.body.velocity
            state["x"], state["y"], state["yaw"] = robot.body.true_pose
            state["velocity_x"], state["velocity_y"] = speed * math.cos(state["yaw"]), speed * math.sin(state["yaw"])
            state["velocity_yaw"] = turn
        with self.stopwatch.span("recording"):
            self.recorder.on_step(states, self.since_start)
        self._start_if_ready()

    def _tell_places(self) -> None:
        for robot in self.robots:
            x, y, _ = self.world.pose(robot.index)
            self.radio.place(robot.own_radio.index, x + self._apart(robot), y)

    def _apart(self, robot: Robot) -> float:
        """Metres that a robot's radio is taken aside: in a partition half of the team is out of everybody's reach."""
        if self.begun_at is None or self.trial.partition is None:
            return 0.0
        begin, end = self.trial.partition
        beyond = robot.index >= (len(self.robots) + 1) // 2
        return OUT_OF_REACH if beyond and begin <= self.since_start < end else 0.0

    def _start_if_ready(self) -> None:
        if self._ordered:
            return
        missing = ", ".join(robot.name for robot in self._first() if not robot.explorer.ready)
        if not missing:
            self._ordered = True
            self.agenda.at(self.now + self._start_up.order, self._begin)
        elif self.now > READY_PATIENCE:
            raise RuntimeError(f"{missing} had neither map nor pose after {READY_PATIENCE:.0f} s")

    def _first(self) -> list[Robot]:
        """Those that are there from the start."""
        return [robot for robot in self.robots if self.trial.joins.get(robot.index, 0.0) <= 0.0]

    def _begin(self, now: float) -> None:
        self.begun_at = now
        self.recorder.begin(now)
        for robot in self._first():
            robot.explorer.begin()
        for index, delay in self.trial.joins.items():
            self.agenda.at(now + delay, functools.partial(self._join, self.robots[index]))
        for index, delay in self.trial.deaths.items():
            self.agenda.at(now + delay, functools.partial(self._die, self.robots[index]))

    def _join(self, robot: Robot, now: float) -> None:
        self.radio.switch_on(robot.own_radio.index)
        self._boot(robot, now)
        self.agenda.every(1.0, now + 1.0, lambda _: self._begin_late(robot))

    @staticmethod
    def _begin_late(robot: Robot) -> None:
        if robot.running and robot.explorer.ready and robot.explorer.agent.started_at is None:
            robot.explorer.begin()

    def _die(self, robot: Robot, now: float) -> None:
        self.recorder.on_death(robot.index, now)
        robot.switch_off()

    def _over(self) -> bool:
        if self.begun_at is None:
            return False
        if self.since_start > self.trial.limit:
            return True
        if not self._survivors:
            return not any(robot.running for robot in self.robots)
        last = -math.inf
        agents = []
        for robot in self._survivors:
            agent = robot.explorer.agent
            if agent.finished_at is None:
                return False
            agents.append(agent)
            last = max(last, agent.finished_at)
        return all(agent.state == State.FINISHED for agent in agents) or self.now - last > HOME_PATIENCE

    @property
    def finished(self) -> bool:
        """There is a robot that lives, and every one that does has finished its exploration within the limit."""
        return bool(self._survivors) and all(robot.explorer.agent.finished_at is not None for robot in self._survivors)


def _start_poses(trial: Trial, world: World) -> list[Pose]:
    """World frame. Beside the start-up nothing but these depends on the seed where sensors, motion and radio are
    perfect."""
    poses = [world.pose(i) for i in range(trial.robots)]
    if not trial.fast:
        return poses
    generator = np.random.default_rng(trial.seed)
    shifts = generator.uniform(-1.0, 1.0, (trial.robots, 3)) * (START_SPREAD, START_SPREAD, START_TURN)
    return [Pose(x + dx, y + dy, yaw + turn) for (x, y, yaw), (dx, dy, turn) in zip(poses, shifts.tolist())]
