"""How far the clocks of real robots are apart, from the stamps in what they told one another."""

from __future__ import annotations

from typing import Mapping

Delays = Mapping[tuple[str, str], int]
"""(listener, sender): the least difference, in ns, of when a message came on the listener's clock and its stamp on the
sender's. It is how far the listener's clock is ahead, and the shortest way of a message."""


def shifts(robots: list[str], delays: Delays) -> dict[str, int]:
    """What to add, in ns, to the times of each robot to get those of the first one. Robots that nothing ties to it
    are left out.

    As in NTP, of both ways between two robots half the difference counts; of one way alone the shortest delay is taken
    for nothing.
    """
    found = {robots[0]: 0}
    waiting = [robots[0]]
    for known in waiting:
        for other in robots:
            ahead = _ahead(other, known, delays)
            if other not in found and ahead is not None:
                found[other] = found[known] - ahead
                waiting.append(other)
    return found


def _ahead(robot: str, other: str, delays: Delays) -> int | None:
    """ns by which the clock of `robot` is ahead of that of `other`."""
    there, back = delays.get((robot, other)), delays.get((other, robot))
    if there is not None and back is not None:
        return (there - back) // 2
    if there is not None:
        return there
    return None if back is None else -back
