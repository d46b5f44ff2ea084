"""All checks, in the order in which one should mend what they find."""

from __future__ import annotations

from typing import Callable, Iterator

from mr_launch.doctor import machine_checks as machine
from mr_launch.doctor import robot_checks as robot
from mr_launch.doctor.facts import Facts, Finding

Check = Callable[[Facts], Iterator[Finding]]

CHECKS: tuple[Check, ...] = (
    machine.check_host_name,
    machine.check_interface,
    machine.check_hub,
    machine.check_rights,
    machine.check_key,
    machine.check_disks,
    machine.check_memory,
    machine.check_load,
    machine.check_date,
    robot.check_master,
    robot.check_set_up,
    robot.check_parameters,
    robot.check_robot_names,
)

ASKING_CHECKS: tuple[Check, ...] = (
    robot.check_hosts,
    robot.check_nodes,
    robot.check_time,
    robot.check_clocks,
    robot.check_drivers,
    robot.check_frames,
    robot.check_map,
    robot.check_velocity,
    robot.check_navigation,
    robot.check_radio,
)
"""Of what nodes answer, which they cannot under a name that leads elsewhere."""


def diagnose(facts: Facts) -> list[Finding]:
    """What is wrong, the cause before its consequences."""
    checks = CHECKS if facts.computer.own_name.fault else CHECKS + ASKING_CHECKS
    return [finding for check in checks for finding in check(facts)]
