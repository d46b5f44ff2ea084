"""Values kept by their place in the plane."""

import math
from typing import Dict, Generic, List, Optional, Tuple, TypeVar

Value = TypeVar("Value")


class Places(Generic[Value]):
    """Bounded table of values at points in metres, one in each square of `radius` metres; the oldest goes first."""

    def __init__(self, maximum: int, radius: float) -> None:
        self._maximum, self._radius = maximum, radius
        self._values: Dict[Tuple[int, int], Tuple[float, float, Value]] = {}

    def put(self, x: float, y: float, value: Value) -> None:
        square = self._square(x, y)
        self._values.pop(square, None)
        self._values[square] = (x, y, value)
        if len(self._values) > self._maximum:
            del self._values[next(iter(self._values))]

    def near(self, x: float, y: float) -> Optional[Value]:
        """The value at the nearest point that is less than `radius` metres away along each axis; None without one."""
        row, column = self._square(x, y)
        squares = [(row + i, column + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        entries = [self._values[square] for square in squares if square in self._values]
        entries = [e for e in entries if max(abs(e[0] - x), abs(e[1] - y)) < self._radius]
        return min(entries, key=lambda e: math.hypot(e[0] - x, e[1] - y))[2] if entries else None

    def values(self) -> List[Value]:
        """The oldest first."""
        return [value for _, _, value in self._values.values()]

    def _square(self, x: float, y: float) -> Tuple[int, int]:
        return (math.floor(y / self._radius), math.floor(x / self._radius))
