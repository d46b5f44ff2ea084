"""What is done to a mission, when."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable

from mr_launch.disk_guard import free
from mr_launch.soak.running import RunningMission

NODES = ("explorer", "map_merger", "adhoc_communication", "move_base", "slam", "page")  # that are started again
LEFT_MB, DISK_MB = 60, 400  # what a nearly full disk has left, below what recorders want; size of the small disk
CLOCK_WRONG_S = 20.0
BALLAST = "ballast"


@dataclass(frozen=True)
class Fault:
    """`at`: s after the robots began to explore; `kind`: what it counts as in the table; `do`: False if it could not be
    done; `hurts`: False for what ends another one."""

    at: float
    kind: str
    what: str
    do: Callable[[RunningMission], bool]
    hurts: bool = True


def disturbed(robots: list[str], rotation: int) -> list[Fault]:
    """A partition, every node killed once, a restart of a master, clocks that are wrong for a while. `rotation`: who it
    hits."""
    first, second, third = (robots[(rotation + index) % len(robots)] for index in range(3))
    victims = (first, second, third, first, third, second)
    faults = [
        *_partition(8.0, 20.0, third),
        *_wrong_clock(32.0, first, 60.0),
        *_wrong_clock(44.0, third, -20.0),
        Fault(56.0, "master restart", f"master of {second} dies", lambda mission: mission.kill(second, "master")),
    ]
    for index, (node, victim) in enumerate(zip(NODES, victims)):
        faults.append(_kill(12.0 + 5.0 * index, victim, node))
    return sorted(faults, key=lambda fault: fault.at)


def full_disk(robots: list[str], rotation: int) -> list[Fault]:
    """The disk gets full in two steps, a node has to come back on it, and somebody makes room."""
    victim = robots[rotation % len(robots)]
    return [
        Fault(15.0, "full disk", f"{LEFT_MB} MB are left", lambda mission: fill(mission, LEFT_MB)),
        Fault(30.0, "full disk", "nothing is left", lambda mission: fill(mission, 0)),
        _kill(36.0, victim, "map_merger"),
        Fault(60.0, "full disk", "there is room again", make_room, hurts=False),
    ]


def partitions(robots: list[str], seconds: float) -> list[Fault]:
    """One robot after the other out of reach, while all stand."""
    turns = range(int(seconds // 40))
    return [fault for turn in turns for fault in _partition(40.0 * turn, 15.0, robots[turn % len(robots)])]


def make_room(mission: RunningMission) -> bool:
    mission.path(BALLAST).unlink()
    return True


def fill(mission: RunningMission, left_mb: int) -> bool:
    """Writes until so many MB are free on the disk of the output folder."""
    path = mission.path(BALLAST)
    with path.open("ab", buffering=0) as file:
        while True:
            wanted = free(path.parent) - left_mb * 1000000
            if wanted <= 0:
                return True
            try:
                file.write(b"\0" * min(wanted, 1 << 20))
            except OSError:
                return True


def _kill(at: float, robot: str, node: str) -> Fault:
    return Fault(at, "node kill", f"{node} of {robot} is killed", lambda mission: mission.kill(robot, node))


def _partition(at: float, seconds: float, robot: str) -> list[Fault]:
    def tell(command: str) -> Callable[[RunningMission], bool]:
        return lambda mission: mission.tell_radio(command, robot)

    return [
        Fault(at, "partition", f"{robot} hears nobody", tell("down")),
        Fault(at + seconds, "partition", f"{robot} is back", tell("up"), hurts=False),
    ]


def _wrong_clock(at: float, robot: str, offset: float) -> list[Fault]:
    """With all that the robot stamps; it jumps there and back."""

    def set_to(offset: float) -> Callable[[RunningMission], bool]:
        return lambda mission: mission.set_clock(robot, offset)

    what = f"clock of {robot}: {abs(offset):g} s {'ahead' if offset > 0.0 else 'back'}"
    return [
        Fault(at, "clock jump", what, set_to(offset)),
        Fault(at + CLOCK_WRONG_S, "clock jump", f"clock of {robot}: right", set_to(0.0), hurts=False),
    ]
