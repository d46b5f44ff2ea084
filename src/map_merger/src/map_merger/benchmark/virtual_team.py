"""Whole agents on virtual time with a radio that loses nothing; registrations run in place."""

from dataclasses import dataclass, field
from typing import Dict, Tuple

from ..agent import Agent
from ..delivery import Delivery, take
from ..effects import Register, Send
from ..graph.edges import EdgeReport
from ..job import Job
from ..registration import Registration

STEP_S = 0.25


@dataclass
class VirtualTeam:
    """Agents by name. now: s."""

    agents: Dict[str, Agent]
    now: float = 100.0
    jobs: Dict[Tuple[str, str], Register] = field(default_factory=dict)
    """The latest registration of each robot with each other one."""
    edges: Dict[str, EdgeReport] = field(default_factory=dict)
    """The transforms that each robot told last."""

    def run(self, seconds: float) -> None:
        """Time goes by."""
        for _ in range(round(seconds / STEP_S)):
            self.now += STEP_S
            for name, agent in self.agents.items():
                agent.tick(self.now)
                self.settle(name)

    def settle(self, name: str) -> None:
        """Carries out what the agent wants."""
        agent = self.agents[name]
        effects = agent.effects()
        while effects:
            for effect in effects:
                if isinstance(effect, Send):
                    self._deliver(name, effect)
                elif isinstance(effect, Register):
                    self.jobs[name, effect.job.robot] = effect
                    agent.on_registered(effect, self.outcome(name, effect.job), self.now)
            effects = agent.effects()

    def outcome(self, name: str, job: Job) -> Registration:
        """What the registration gives."""
        return job.run()

    def mislead(self, name: str, robot: str, outcome: Registration) -> None:
        """The latest registration of `name` with `robot` gives this outcome now. KeyError if there was none."""
        self.agents[name].on_registered(self.jobs[name, robot], outcome, self.now)
        self.settle(name)

    def _deliver(self, sender: str, send: Send) -> None:
        delivery = Delivery(send)
        while delivery.next is not None:
            if isinstance(delivery.next, EdgeReport):
                self.edges[sender] = delivery.next
            for name, agent in self.agents.items():
                if name != sender and (send.to_group or name == send.destination):
                    take(agent, delivery.next, self.now)
            delivery.ended(True)
        delivery.report(self.agents[sender], self.now)
