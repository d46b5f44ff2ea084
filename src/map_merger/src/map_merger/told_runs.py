"""The runs of the team's robots as a base tells them."""

from typing import Dict, List

from .graph.edges import EdgeReport
from .messages import Boot


class ToldRuns:
    """Who sends its map to the base only announces its restart to nobody else: the base's edges tell."""

    def __init__(self) -> None:
        self._runs: Dict[str, Boot] = {}

    def restarted(self, report: EdgeReport) -> List[str]:
        """The robots whose run is another one than in former reports."""
        told = {edge.target: edge.target_run for edge in report.edges}
        restarted = [robot for robot, run in told.items() if self._runs.get(robot, run) != run]
        self._runs.update(told)
        return restarted
