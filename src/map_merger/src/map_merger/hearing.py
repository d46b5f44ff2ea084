"""When each robot was heard, and how much of its map came."""

from typing import Dict


class Hearing:
    """Owns these figures, for the status only. Of robots that the exchange has met, so bounded as that is."""

    def __init__(self) -> None:
        self._first: Dict[str, float] = {}
        self._heard: Dict[str, float] = {}
        self._octets: Dict[str, int] = {}

    def on_news(self, robot: str, now: float, octets: int = 0) -> None:
        """Something came from the robot, with so many cells of its map (a byte each)."""
        self._heard[robot] = now
        self._first[robot] = min(now, self._first.get(robot, now))
        self._octets[robot] = self._octets.get(robot, 0) + octets

    def forget(self, robot: str) -> None:
        """The robot is to be forgotten."""
        self._heard.pop(robot, None)
        self._first.pop(robot, None)
        self._octets.pop(robot, None)

    def age(self, robot: str, now: float) -> float:
        """Seconds since the robot was heard last; -1 if it never was."""
        return max(0.0, now - self._heard[robot]) if robot in self._heard else -1.0

    def known_for(self, robot: str, now: float) -> float:
        """Seconds since the robot was heard for the first time."""
        return now - self._first.get(robot, now)

    def octets(self, robot: str) -> int:
        """Cells of its map that came, repeated ones counted each time."""
        return self._octets.get(robot, 0)
