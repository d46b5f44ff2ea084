"""The transforms that this robot finds itself: which registration is next, what follows from it, and what the team is
told of it."""

from typing import Dict, List, Optional, Set

from .effects import Effect, Note, Register
from .exchange import Exchange
from .graph.edges import Edge, EdgeReport
from .graph.patience import Patience
from .graph.team import TeamGraph
from .graph.telling import Telling
from .job import Versioned
from .messages import Boot
from .observations import Observations
from .options import Options
from .own_edges import own_edges
from .reference import Reference
from .registrar import Registrar, Team
from .registration import Registration
from .report import beyond_limits, news_of
from .topology import topology_of


class OwnTransforms:
    """Owns the registrar, and what the graph and the others know of its transforms."""

    def __init__(
        self,
        options: Options,
        boot: Boot,
        exchange: Exchange,
        reference: Reference,
        observations: Observations,
        graph: TeamGraph,
    ) -> None:
        """`boot` names the run of the own frame. The graph's own edges are set here and nowhere else."""
        self._name, self._boot = options.robot_name, boot
        self._merges = topology_of(options).relies_on is None
        self._exchange, self._reference, self._observations = exchange, reference, observations
        self._graph = graph
        self.registrar = Registrar(options, observations.whereabouts, observations.sightings, observations.meetings)
        self._telling = Telling(self._name, boot)
        self._patience = Patience()
        self._refused: Set[str] = set()

    def next_job(self, now: float) -> Optional[Register]:
        """The registration to start now; None if none is due."""
        if self._reference.grid is None or not self._merges:
            return None
        target = Versioned((self._name, self._reference.frame, self._reference.version), self._reference.grid)
        maps = self._maps(now)
        team = Team(target, maps, self._graph.placed(), self._graph.disputed(), self._reference.robot)
        return self.registrar.next_job(now, team)

    def _maps(self, now: float) -> Dict[str, Versioned]:
        maps = {}
        for robot in self._exchange.robots():
            grid = self._exchange.map_of(robot)
            if grid is not None:
                version, known = self._exchange.version_of(robot), self.registrar.generation(robot)
                maps[robot] = Versioned((robot, known, self._exchange.run_of(robot), version), grid)
                self._observations.look_through(robot, grid, version, now)
        return maps

    def finished(self, effect: Register, result: Registration) -> List[Effect]:
        """A registration ended."""
        robot, effects = effect.job.robot, self._refusal(effect.job.robot, result)
        news = self.registrar.finished(effect, result)
        if news:
            # They have served, and if they misled they would do so again.
            self._observations.sightings.forget(robot)
        if news is not None:
            effects += news_of(robot, news, self.registrar.alignment(robot), result)
            effects += self.renew()
        return effects

    def _refusal(self, robot: str, result: Registration) -> List[Effect]:
        refusal = beyond_limits(robot, result)
        if refusal is None or robot in self._refused:
            return []
        self._refused.add(robot)
        return [Note(refusal, warning=True)]

    def give_up_refuted(self, now: float) -> List[Effect]:
        """A transform that the team contradicts for long is given up."""
        effects: List[Effect] = []
        refuted = self._patience.lasting(self._graph.refuted(), now)
        for robot, words in refuted.items():
            if self.registrar.alignment(robot).refuted(words):
                effects.append(Note(f"transform to {robot} revoked: {words}", warning=True))
        return effects + self.renew() if refuted else effects

    def forget(self, robot: str) -> None:
        """The robot's frame or the own one is a new one; then `renew`."""
        self.registrar.forget(robot)

    def begin_run(self, boot: Boot) -> None:
        """The own frame is a new one, and others are told so."""
        self._boot = boot
        self._graph.begin_run(boot)
        self._telling.begin_run(boot)

    def renew(self) -> List[Effect]:
        """The transforms have changed: the graph takes them."""
        return [Note(text, warning=True) for text in self._graph.set_own(self._edges())]

    def report(self, now: float) -> Optional[EdgeReport]:
        """What to tell the others now, if it is time."""
        return self._telling.due(self._graph.own(), now)

    def _edges(self) -> List[Edge]:
        base = self._reference.robot if self._reference.grid is not None else None
        return own_edges(self._name, self._boot, self.registrar, self._exchange, base)
