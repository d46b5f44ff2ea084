"""The runs of the team's robots as a base tells them."""

from collections import deque
from typing import Deque, Dict, List

from .graph.edges import EdgeReport
from .messages import Boot

_FORMER_RUNS = 8
"""So many of each robot are known to be over."""


class ToldRuns:
    """Who sends its map to the base only announces its restart to nobody else: the base's edges tell."""

    def __init__(self) -> None:
        self._runs: Dict[str, Deque[Boot]] = {}
        """Of each robot, the present one last."""

    def restarted(self, report: EdgeReport) -> List[str]:
        """The robots whose run is none that former reports named: a late report names one that is over."""
        restarted = []
        for edge in report.edges:
            runs = self._runs.setdefault(edge.target, deque(maxlen=_FORMER_RUNS + 1))
            if edge.target_run not in runs:
                restarted += [edge.target] if runs else []
                runs.append(edge.target_run)
        return restarted
