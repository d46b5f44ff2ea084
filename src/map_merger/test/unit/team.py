"""A team of agents on virtual time and a radio that loses what the test wants lost."""

import math
from dataclasses import dataclass, field
from typing import Callable, Dict, List

import numpy as np

from map_merger.agent import Agent
from map_merger.delivery import Delivery, take
from map_merger.effects import (
    AskNeighbors,
    BroadcastTransforms,
    Note,
    PublishMap,
    PublishPositions,
    Register,
    SaveDebugImages,
    Send,
)
from map_merger.messages import Tile
from map_merger.options import Options
from map_merger.robot_size import USUAL_SIZE
from map_merger.synthetic import Survey, Surveyor, office_plan

STEP_S = 0.25


def options(name, **changes):
    """Options of a robot that accepts every rotation."""
    values = dict(
        robot_name=name,
        body_radius=USUAL_SIZE.body_radius,
        largest_robot_radius=USUAL_SIZE.largest_radius,
        max_rotation_robots=-1.0,
        exchange_position=True,
        split_size=2048,
        debug=False,
    )
    values.update(changes)
    return Options(**values)


@dataclass
class Team:
    """Agents by name; `lost(sender, receiver, payload)` says what the radio loses; it refuses tiles of more
    than `largest_tile` cells."""

    agents: Dict[str, Agent]
    lost: Callable[[str, str, object], bool] = lambda sender, receiver, payload: False
    largest_tile: float = math.inf
    now: float = 100.0
    sends: List[tuple] = field(default_factory=list)
    maps: Dict[str, list] = field(default_factory=dict)
    places: Dict[str, tuple] = field(default_factory=dict)
    transforms: Dict[str, tuple] = field(default_factory=dict)
    notes: Dict[str, list] = field(default_factory=dict)
    asked: List[str] = field(default_factory=list)
    images: Dict[str, list] = field(default_factory=dict)
    jobs: int = 0

    def run(self, seconds):
        """Virtual time goes by."""
        for _ in range(round(seconds / STEP_S)):
            self.now += STEP_S
            for name, agent in self.agents.items():
                agent.tick(self.now)
                self.settle(name)

    def settle(self, name):
        """Carries out what the agent wants."""
        agent = self.agents[name]
        effects = agent.effects()
        while effects:
            for effect in effects:
                self._carry_out(name, agent, effect)
            effects = agent.effects()

    def _carry_out(self, name, agent, effect):
        if isinstance(effect, Send):
            self._deliver(name, agent, effect)
        elif isinstance(effect, Register):
            self.jobs += 1
            agent.on_registered(effect, effect.job.run(), self.now)
        elif isinstance(effect, PublishMap):
            self.maps.setdefault(name, []).append(effect.grid)
        elif isinstance(effect, PublishPositions):
            self.places[name] = effect.places
        elif isinstance(effect, BroadcastTransforms):
            self.transforms[name] = effect.transforms
        elif isinstance(effect, Note):
            self.notes.setdefault(name, []).append(effect.text)
        elif isinstance(effect, AskNeighbors):
            self.asked.append(name)
        elif isinstance(effect, SaveDebugImages):
            self.images.setdefault(name, []).append(effect)

    def _deliver(self, sender, agent, send):
        """A group send does not tell whom it missed."""
        delivery = Delivery(send)
        receivers = [name for name in self.agents if name != sender] if send.to_group else [send.destination]
        while delivery.next is not None:
            payload = delivery.next
            if isinstance(payload, Tile) and payload.cells.size > self.largest_tile:
                delivery.ended(False, too_large=True)
                continue
            self.sends.append((self.now, sender, send.destination, payload))
            heard = [name for name in receivers if name in self.agents and not self.lost(sender, name, payload)]
            for receiver in heard:
                take(self.agents[receiver], payload, self.now)
            delivery.ended(send.to_group or bool(heard))
        delivery.report(agent, self.now)

    def sent(self, kind, sender=None, destination=None):
        """Payloads of a kind that were sent."""
        return [
            payload
            for _, who, where, payload in self.sends
            if isinstance(payload, kind) and sender in (None, who) and destination in (None, where)
        ]


def team_of(*names, **changes):
    """A team of robots that know nothing of each other."""
    return Team({name: Agent(options(name, **changes), (1, number)) for number, name in enumerate(names)})


def survey(count, seed=5, path_length=25.0, stages=(1.0,), same_place=True):
    """Robot maps of one building, starting at one place with different headings."""
    random = np.random.default_rng(seed)
    surveyor = Surveyor(office_plan(random))
    first = surveyor.explore(random, Survey(path_length=path_length, stages=stages))
    others = [
        surveyor.explore(
            random,
            Survey(path_length=path_length, stages=stages),
            start=tuple(first.path[0, :2]) if same_place else None,
            yaw=2.0 * number + 0.4,
        )
        for number in range(count - 1)
    ]
    return [first, *others]
