"""A centralized team in virtual time: the robots know each other's areas from the base alone."""

from dataclasses import replace

import numpy as np
import pytest

from mr_experiments.host.mission import Mission
from mr_experiments.host.radio import Radio
from mr_experiments.sweep.record import record_of
from mr_experiments.trial.scenario import load_scenario
from mr_experiments.trial.trial import Trial, TrialError

SHORT = replace(load_scenario("centralized").trial(2, 7, 1, "small8x8"), limit=60.0)


class Heard:
    """Which robot's radio is asked to send maps where."""

    def __init__(self, monkeypatch):
        self.maps = set()
        send = Radio.send

        def noted(radio, robot, service, destination, *rest):
            if service == "send_map_update":
                self.maps.add((robot, destination))
            send(radio, robot, service, destination, *rest)

        monkeypatch.setattr(Radio, "send", noted)


def known_of(mission, robot):
    """Which of the reference cells a robot's global map knows, bool (n,)."""
    grid, start = mission.recorder.logs[robot].global_map, mission.recorder.starts[robot]
    places = start.apply_inverse(mission.recorder.truth.reference)
    cells = np.floor((places - (grid.info.origin.x, grid.info.origin.y)) / grid.info.resolution).astype(int)
    inside = ((cells >= 0) & (cells < (grid.info.width, grid.info.height))).all(axis=1)
    known = np.zeros(len(places), bool)
    known[inside] = grid.cells[cells[inside, 1], cells[inside, 0]] >= 0
    return known


def test_both_robots_know_what_the_other_has_seen(monkeypatch):
    heard = Heard(monkeypatch)
    mission = Mission(SHORT)
    mission.run(until=30.0)
    own = mission.recorder.known_cells()
    for robot in range(2):
        others_only = own[1 - robot] & ~own[robot]
        assert np.count_nonzero(others_only) > 50
        assert known_of(mission, robot)[others_only].mean() > 0.8
    base = mission.base.own_radio.index
    assert {destination for robot, destination in heard.maps if robot != base} == {"base"}
    assert (base, "mc_base") in heard.maps
    record = record_of(mission, None)
    assert set(record.robots) == {"robot_0", "robot_1"}
    for robot in record.robots.values():
        assert [merge.kind for merge in robot.merges] and all(merge.right for merge in robot.merges)
    assert record.asked.settings["base"] == list(SHORT.base) and record.asked.settings["topology"] == "centralized"


def test_both_topologies_end_with_the_same_map():
    shares = []
    for trial in (SHORT, replace(SHORT, topology="distributed", base=None)):
        mission = Mission(trial)
        mission.run(until=45.0)
        shares.append([known_of(mission, robot).mean() for robot in range(2)])
    assert np.min(shares) > 0.98


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"topology": "star"}, "topology 'star' is unknown"),
        ({"topology": "centralized"}, "a base is given if, and only if"),
        ({"base": (0.0, 0.0)}, "a base is given if, and only if"),
        ({"topology": "centralized", "base": (0.0, 0.0), "fast": True}, "need no base"),
    ],
)
def test_bad_topology_is_told(changes, text):
    with pytest.raises(TrialError, match=text):
        Trial("small8x8", 2, 1, **changes)
