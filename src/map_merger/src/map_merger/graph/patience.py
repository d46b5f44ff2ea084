"""How long an own transform may be contradicted before it is given up.

After a loop closure of one robot's SLAM each of its neighbours follows in its own time; until the last one has told its
transform anew, right ones contradict one another.
"""

from typing import Dict, Mapping

PATIENCE_S = 12.0
"""Longer than two periods of following and the telling."""


class Patience:
    """Since when which own transforms are contradicted."""

    def __init__(self) -> None:
        self._since: Dict[str, float] = {}

    def lasting(self, refuted: Mapping[str, str], now: float) -> Dict[str, str]:
        """Those of the contradicted (see `TeamGraph.refuted`) that have been so without a break for PATIENCE_S. A clock
        that jumps back starts anew."""
        self._since = {robot: min(now, self._since.get(robot, now)) for robot in refuted}
        return {robot: words for robot, words in refuted.items() if now - self._since[robot] >= PATIENCE_S}
