"""The map whose frame is the own frame: the local one or, on a base station, that of the robot that it adopted."""

from typing import List, Optional

from mr_grid import OccupancyGrid

from .exchange import Exchange

BASE_LOST_S = 60.0
"""A base station that could not merge anything gives up an adopted robot that is gone for so long, in s."""


class Reference:
    """Owns that map."""

    def __init__(self) -> None:
        self.grid: Optional[OccupancyGrid] = None
        self.version = 0
        """Counts the maps."""
        self.robot: Optional[str] = None
        """The robot whose map a base station has adopted."""
        self.frame = 0
        """Counts the frames: another number means that nothing known in the former one holds."""
        self._run = 0
        self._seen = -1
        self._lost_at: Optional[float] = None

    def set(self, grid: OccupancyGrid) -> None:
        """The map changed."""
        self.grid = grid
        self.version += 1

    def follow(self, exchange: Exchange, merged: bool, now: float) -> List[str]:
        """On a base station: takes the present map of the adopted robot, adopts the first one that has a map, and
        another one when that is lost before anything was merged. Returns what a person wants to know."""
        notes = []
        if self.robot is not None and self._is_lost(exchange, self.robot, merged, now):
            notes.append(f"base station: {self.robot}, whose map was the reference, is lost")
            self._begin(None, 0)
        if self.robot is None:
            adopted = self._first_with_map(exchange)
            if adopted is None:
                return notes
            self._begin(adopted, exchange.run_of(adopted))
            notes.append(f"base station: the map of {adopted} is the reference")
        self._take(exchange)
        return notes

    def _begin(self, robot: Optional[str], run: int) -> None:
        self.robot, self._run, self._seen, self._lost_at = robot, run, -1, None
        self.grid = None
        self.frame += 1

    def _take(self, exchange: Exchange) -> None:
        assert self.robot is not None
        run, version = exchange.run_of(self.robot), exchange.version_of(self.robot)
        if run != self._run:
            self._begin(self.robot, run)
        grid = exchange.map_of(self.robot)
        if version != self._seen and grid is not None:
            self._seen = version
            self.set(grid)

    def _is_lost(self, exchange: Exchange, robot: str, merged: bool, now: float) -> bool:
        if merged or (exchange.present(robot) and exchange.map_of(robot) is not None):
            self._lost_at = None
            return False
        if self._lost_at is None or now < self._lost_at:
            self._lost_at = now
        return now - self._lost_at >= BASE_LOST_S and self._first_with_map(exchange, robot) is not None

    @staticmethod
    def _first_with_map(exchange: Exchange, without: str = "") -> Optional[str]:
        robots = (name for name in exchange.robots() if name != without and exchange.present(name))
        return next((name for name in robots if exchange.map_of(name) is not None), None)
