"""Scan logs of robots that are carried away, and how it is judged whether they find themselves."""

import math

import numpy as np
import pytest

from mr_sim.carried_robot import CARRYING, carried, judged
from mr_sim.scan_log import ScanLog


def test_wheels_are_silent_while_a_robot_is_carried() -> None:
    """Along a line of 10 m, from 8 m back to 5 m."""
    way = np.column_stack((np.linspace(0.0, 10.0, 101), np.zeros(101), np.zeros(101)))
    odometry = way + np.array([0.0, 2.0, 0.0])
    log = ScanLog("w", np.zeros(7), np.arange(101.0), np.arange(101.0, dtype=np.float32)[:, None], odometry, way)
    longer = carried(log, 81, 3.0, 0.0)
    assert longer.ranges[:, 0].tolist() == [*range(81), *range(50, 101)]
    assert longer.truth[80:82, 0] == pytest.approx([8.0, 5.0])
    assert longer.odometry[80:83, 0] == pytest.approx([8.0, 8.0, 8.1])
    assert longer.times[80:83] == pytest.approx([80.0, 80.0 + CARRYING, 81.0 + CARRYING])


@pytest.mark.parametrize("errors, matched, seconds, believed", [
    ([3.0, 3.0, 3.0, 0.1, 0.1], [False, False, False, True, True], 3.0, 0.0),
    ([3.0, 0.1, 3.0, 3.0, 0.1], [False, True, True, True, True], 4.0, 2.0),
    ([3.0, 3.0, 3.0, 3.0, 3.0], [False, True, True, True, True], math.inf, 3.0),
    ([0.1, 0.1, 0.1, 0.1, 0.1], [True, True, True, True, True], 0.0, 0.0),
])  # fmt: skip
def test_a_robot_has_found_itself_when_it_knows_its_place_to_the_end(
    errors: list, matched: list, seconds: float, believed: float
) -> None:
    assert judged(np.arange(7.0, 12.0), np.array(errors), np.array(matched)) == (seconds, believed)
