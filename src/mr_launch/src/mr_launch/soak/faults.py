"""What is done to a mission, when."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable

from mr_launch.disk_guard import free
from mr_launch.soak.running import RunningMission

NODES = ("explorer", "map_merger", "adhoc_communication", "move_base", "slam", "page")  # that are started again
LEFT_MB, DISK_MB = 60, 400  # what a nearly full disk has left, below what recorders want; size of the small disk
BALLAST = "ballast"


@dataclass(frozen=True)
class Fault:
    """`at`: s after the robots began to explore; `kind`: what it counts as in the table; `do`: False if it could not be
    done."""

    at: float
    kind: str
    what: str
    do: Callable[[RunningMission], bool]


def disturbed(robots: list[str], rotation: int) -> list[Fault]:
    """A partition, every node killed once, a restart of a master, clocks that jump. `rotation`: who it hits."""
    first, second, third = (robots[(rotation + index) % len(robots)] for index in range(3))
    victims = (first, second, third, first, third, second)
    faults = [
        Fault(8.0, "partition", f"{third} hears nobody", lambda mission: mission.tell_radio(f"down {third}")),
        Fault(28.0, "partition", f"{third} is back", lambda mission: mission.tell_radio(f"up {third}")),
        Fault(32.0, "clock jump", f"{first}: 60 s ahead", lambda mission: mission.jump_clock(first, 60.0)),
        Fault(44.0, "clock jump", f"{third}: 20 s back", lambda mission: mission.jump_clock(third, -20.0)),
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
        _kill(36.0, victim, "map_merger", "full disk"),
        Fault(60.0, "full disk", "there is room again", make_room),
    ]


def partitions(robots: list[str], seconds: float) -> list[Fault]:
    """One robot after the other out of reach, while all stand."""
    faults = []
    for index in range(int(seconds // 40)):
        robot = robots[index % len(robots)]
        for at, word in ((0.0, "down"), (15.0, "up")):
            faults.append(
                Fault(40.0 * index + at, "partition", f"{word} {robot}",
                      lambda mission, line=f"{word} {robot}": mission.tell_radio(line))  # type: ignore[misc]
            )  # fmt: skip
    return faults


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


def _kill(at: float, robot: str, node: str, kind: str = "node kill") -> Fault:
    return Fault(at, kind, f"{node} of {robot} is killed", lambda mission: mission.kill(robot, node))
