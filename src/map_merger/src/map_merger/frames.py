"""Robots that restart have a new frame, and what was known in the former one does not hold in it."""

from typing import Dict, List

from .effects import Effect
from .exchange import Exchange
from .graph.edges import EdgeReport
from .graph.team import TeamGraph
from .observations import Observations
from .own_transforms import OwnTransforms
from .told_runs import ToldRuns


class Frames:
    """Owns which run of each other robot is the present one."""

    def __init__(
        self, exchange: Exchange, observations: Observations, own_transforms: OwnTransforms, graph: TeamGraph
    ) -> None:
        """The exchange knows the runs; the others forget what was known in a former one."""
        self._exchange, self._observations = exchange, observations
        self._own_transforms, self._graph = own_transforms, graph
        self._runs: Dict[str, int] = {}
        self._told_runs = ToldRuns()

    def follow(self, robot: str) -> List[Effect]:
        """Takes note of the robot's run."""
        before, run = self._runs.get(robot, 0), self._exchange.run_of(robot)
        if run == before:
            return []
        self._runs[robot] = run
        self._graph.set_run(robot, self._exchange.boot_of(robot))
        return self._forget_frame_of(robot) if before else []

    def follow_told(self, report: EdgeReport) -> List[Effect]:
        """Takes note of the runs that a base names, to which alone the robots announce them."""
        effects: List[Effect] = []
        for robot in self._told_runs.restarted(report):
            effects += self._forget_frame_of(robot)
        return effects

    def forget(self, robot: str) -> List[Effect]:
        """Nothing that was known of the robot counts any more."""
        effects = self._forget_frame_of(robot)
        self._graph.forget(robot)
        self._runs.pop(robot, None)
        return effects

    def _forget_frame_of(self, robot: str) -> List[Effect]:
        self._observations.forget(robot)
        self._own_transforms.forget(robot)
        return self._own_transforms.renew()
