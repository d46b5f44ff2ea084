"""All processes of a team: radio, world, and one roslaunch with its own master per robot."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Callable

from mr_grid import Pose
from mr_launch import isolation
from mr_launch.errors import TeamFailure
from mr_launch.network import end_all_in_namespace, hold_namespace, lay_cable, switch_ipv6_off
from mr_launch.nodes import MOST_RESTARTS, NodeWatch
from mr_launch.plan import (
    RADIO_CONTROL,
    Plan,
    RobotPlan,
    base_position,
    key_command,
    key_file,
    launch_command,
    namespace_prefix,
    page_command,
    radio_command,
    robot_environment,
    truth_command,
    world_command,
)
from mr_launch.processes import Child, Children, dies_with_parent, last_lines, program_environment
from mr_launch.running_state import remove_state, write_state
from mr_launch.world import write_walls

REFERENCE_PATIENCE = 120.0  # s; alone it takes some, but it is nice, and the machine may be busy
NODES_PATIENCE = 25.0  # s; roslaunch itself waits 15 s for its nodes, then 2 s more
START_PATIENCE = (
    2.0  # s; a roslaunch that is starting nodes waits 20 s for itself, and one that is read may hear nothing
)


class Team:
    """Starts everything, tells what broke, stops everything. ``page``: listening socket for the status page."""

    def __init__(self, plan: Plan, init: int | None, page: int | None = None) -> None:
        self.plan = plan
        self.children = Children()
        self.launches: dict[str, Child] = {}
        self._init = init
        self._page = page
        self._holders: dict[str, int] = {}
        self._watches: dict[str, list[NodeWatch]] = {}  # one for each start of a robot
        self.starts: dict[str, Pose] = {}  # true poses of robots when their present maps began, where not at the start
        self.place: Callable[[str], Pose | None] = lambda robot: None
        self.on_restart: Callable[[str], None] = lambda robot: None
        self._own_namespaces = plan.isolation != isolation.HUB
        self._environment = program_environment()
        self._died_with_parent = dies_with_parent(plan.isolation)

    def start(self, stopped: Callable[[], bool]) -> None:
        """Namespaces, key, radio, world, robots, in the order in which they need each other."""
        self._make_network()
        self._make_key()
        self._start_radio(stopped)
        self._start_page()
        self._start("reference", truth_command(self.plan), {}, may_finish=True)
        self._start("world", world_command(self.plan), {})
        for robot in self.plan.hosts:
            if not stopped():
                self._launch(robot)
        self._write_state()

    def _launch(self, robot: RobotPlan) -> None:
        watches = self._watches.setdefault(robot.name, [])
        prefix = namespace_prefix(self._holders.get(robot.name))
        log = self.plan.log_folder() / f"{robot.name}.log"
        begin = log.stat().st_size if log.exists() else 0
        command = [*prefix, *launch_command(self.plan, robot, len(watches) + 1)]
        self.launches[robot.name] = self._start(robot.name, command, robot_environment(self.plan, robot))
        watches.append(NodeWatch(log, self.plan.options.respawn, begin))

    def _launch_again(self, robot: RobotPlan) -> None:
        """Its master has ended, or roslaunch: the robot is started again, as after a reboot, with a new map."""
        holder = self._holders.get(robot.name)
        if holder is not None:
            end_all_in_namespace(holder)
        self.children.forget(self.launches[robot.name])
        place = self.place(robot.name)
        if place is not None:
            self.starts[robot.name] = place
            robot = replace(robot, start=place)
        self._launch(robot)
        self.on_restart(robot.name)

    def _make_key(self) -> None:
        if self.plan.options.open:
            return
        Path(key_file(self.plan)).unlink(missing_ok=True)  # of a mission before in this folder
        made = subprocess.run(key_command(self.plan), capture_output=True, text=True, check=False)
        if made.returncode != 0:
            raise TeamFailure(f"no team key: {made.stderr.strip()}")

    def failures(self) -> list[str]:
        """What ended although it should run: one line each, with the log file."""
        self._start_robots_again()
        lines = [child.describe_end() for child in self.children.failed()]
        for name, watches in self._watches.items():
            lines += [end.describe(name) for end in watches[-1].failures()]
        self.children.reap_orphans()
        return lines

    def _start_robots_again(self) -> None:
        if not self.plan.options.respawn:
            return
        for robot in self.plan.hosts:
            launch = self.launches.get(robot.name)
            if launch is not None and launch.failed and len(self._watches[robot.name]) <= MOST_RESTARTS:
                self._launch_again(robot)

    def news(self) -> list[str]:
        """What people should know and the mission survives, each once."""
        return [
            f"{name}: {text}"
            for name, watches in self._watches.items()
            for watch in watches
            for text in watch.take_news()
        ]

    def take_lost_maps(self) -> list[str]:
        """Robots whose SLAM has ended and is started again, each once for each time."""
        return [name for name, watches in self._watches.items() if watches[-1].take_lost_map()]

    @property
    def restarts(self) -> dict[str, dict[str, int]]:
        """How often which node of which robot was started again."""
        counts: dict[str, dict[str, int]] = {}
        for name, watches in self._watches.items():
            total = Counter({"roslaunch": len(watches) - 1})
            for watch in watches:
                total.update(watch.restarts)
            counts[name] = dict(+total)
        return counts

    def stop_robots(self, begun: bool) -> None:
        """End all nodes in order, so that bags are closed and logs are complete. Before the mission has `begun` there
        is nothing to keep: what does not end soon goes with the namespace, or with the supervisor."""
        patience = NODES_PATIENCE if begun else START_PATIENCE
        self.children.stop(list(self.launches.values()), signal.SIGINT, patience)

    @property
    def has_reference(self) -> bool:
        """Nobody computes it any more."""
        return not self.children.running("reference")

    def wait_for_reference(self, stopped: Callable[[], bool]) -> bool:
        """What maps are compared with is computed beside the mission, which may be over before."""
        return self.children.wait("reference", REFERENCE_PATIENCE, stopped)

    def stop_rest(self) -> None:
        """End radio (it writes its statistics now) and world, then whatever is left."""
        self.children.stop_all(5.0)
        remove_state(Path(self.plan.out))

    def _start_page(self) -> None:
        if self._page is None:
            return
        command = [*self._died_with_parent, *page_command(self.plan, self._page)]
        log = self.plan.log_folder() / "page.log"
        self.children.start("page", command, log, self._environment, needed=False, descriptors=[self._page])
        os.close(self._page)

    def _start(self, name: str, command: list[str], extra: dict[str, str], may_finish: bool = False) -> Child:
        log = self.plan.log_folder() / f"{name}.log"
        return self.children.start(
            name, [*self._died_with_parent, *command], log, {**self._environment, **extra}, may_finish
        )

    def _make_network(self) -> None:
        if not self._own_namespaces:
            return
        switch_ipv6_off([])
        for robot in self.plan.hosts:
            log = self.plan.log_folder() / "network.log"
            holder = hold_namespace(robot.name, self.children, log, self._environment)
            self._holders[robot.name] = holder.process.pid
            lay_cable(robot, holder.process.pid)

    def _start_radio(self, stopped: Callable[[], bool]) -> None:
        weakened = self.plan.options.wall_attenuation > 0.0
        walls = write_walls(self.plan.world, self.plan.socket("walls.pgm")) if weakened else None
        radio = self._start("radio", radio_command(self.plan, walls), {})
        control = Path(self.plan.socket(RADIO_CONTROL))
        end = time.monotonic() + 15.0
        while not control.exists() and not stopped():
            if radio.process.poll() is not None:
                raise TeamFailure(radio.describe_end())
            if time.monotonic() > end:
                raise TeamFailure(f"the radio does not get ready; its log is {radio.log}{last_lines(radio.log)}")
            time.sleep(0.05)
        if self.plan.base and not stopped():
            self._tell_radio(base_position(self.plan.base))

    def _tell_radio(self, command: str) -> None:
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as control:
            control.connect(self.plan.socket(RADIO_CONTROL))
            control.send(command.encode())

    def _write_state(self) -> None:
        environments = {host.name: robot_environment(self.plan, host) for host in self.plan.hosts}
        write_state(Path(self.plan.out), self.plan.isolation, self._init, self._holders, environments)
