"""A team that has explored and stands holds what it holds, however long it stands and whoever goes out of reach."""

import gc
import sys
from collections import deque

import numpy as np
import pytest

from mr_experiments.host.mission import Mission
from mr_experiments.trial.trial import Trial

SETTLE, REST = 1800.0, 1800.0  # s; until caches are full and the last registration is done, and afterwards
PARTITION_PERIOD, PARTITION = 40.0, 15.0  # s from one to the next, and how long each is
SLACK = 50_000  # octets in that time: a late registration may keep more of a map than the one before


def octets_of(root, others):
    """All that can be reached from an object, but for `others` and what belongs to code."""
    seen, waiting, octets = {id(other) for other in others}, deque([root]), 0
    while waiting:
        thing = waiting.popleft()
        if id(thing) in seen or isinstance(thing, (type, type(sys), type(octets_of))):
            continue
        seen.add(id(thing))
        octets += thing.nbytes if isinstance(thing, np.ndarray) and thing.base is None else sys.getsizeof(thing, 0)
        waiting.extend(gc.get_referents(thing))
    return octets


class Rest:
    """A mission whose robots have come to rest. Each robot in turn is out of reach for a while."""

    def __init__(self):
        self.mission = Mission(Trial("small8x8", 2, 1))
        self.mission.run()
        self._turn = 0
        self._partition(self.mission.now)

    def advance(self, seconds):
        end = self.mission.now + seconds
        while self.mission.now < end:
            self.mission._advance()

    def octets(self):
        """{(robot, part): octets}."""
        gc.collect()
        mission = self.mission
        parts = {
            (robot.name, part): held
            for robot in mission.robots
            for part, held in (("merger", robot.merger.agent), ("explorer", robot.explorer.agent), ("body", robot.body))
        }
        shared = [mission, mission.agenda, mission.radio, mission.recorder, mission.world, mission.stopwatch]
        shared += [*mission.robots, *(robot.merger for robot in mission.robots)]
        shared += [robot.explorer for robot in mission.robots]
        return {key: octets_of(held, [*shared, *(one for one in parts.values() if one is not held)])
                for key, held in parts.items()}  # fmt: skip

    def _partition(self, now):
        radio, robot = self.mission.radio, self.mission.robots[self._turn % 2].own_radio.index
        self._turn += 1
        radio.switch_off(robot)
        self.mission.agenda.at(now + PARTITION, lambda _: radio.switch_on(robot))
        self.mission.agenda.at(now + PARTITION_PERIOD, self._partition)


@pytest.fixture(scope="module")
def rest():
    return Rest()


def test_half_an_hour_at_rest_leaves_the_engines_as_large_as_they_were(rest):
    rest.advance(SETTLE)
    before = rest.octets()
    assert all(octets > 100_000 for octets in before.values()), "maps at least"
    rest.advance(REST)
    grown = {key: octets - before[key] for key, octets in rest.octets().items()}
    assert {key: octets for key, octets in grown.items() if octets > SLACK} == {}


def test_what_grows_is_seen(rest):
    before = rest.octets()
    agent = rest.mission.robots[1].merger.agent
    agent.leak = [np.zeros(1000) for _ in range(10)]
    grown = {key: octets - before[key] for key, octets in rest.octets().items()}
    del agent.leak
    assert grown.pop(("robot_1", "merger")) > 80_000 and set(grown.values()) == {0}
