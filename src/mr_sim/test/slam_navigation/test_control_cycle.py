"""Simulated robots are steered in navigation's own period, as by its node, however often their lasers scan."""

import math
from pathlib import Path
from typing import Callable

import numpy as np
import pytest

from mr_grid import Pose
from mr_sim.closed_loop import ClosedLoop
from mr_sim.control_cycle import ControlCycle
from mr_sim.world_description import RangerDescription

LASER = RangerDescription(Pose(0.1, 0.0, 0.0), 0.0, 8.0, math.pi, 181, 0.2, 0.0)


def test_a_cycle_begins_with_the_first_scan() -> None:
    cycle = ControlCycle(LASER, 0.1)
    assert not cycle.due(0.0)
    cycle.see(np.ones(181, np.float32), Pose(), 0.35)
    assert [cycle.due(now) for now in (0.35, 0.35, 0.4, 0.45, 0.5, 0.55)] == [True, False, False, True, False, True]
    assert [cycle.due(now) for now in (2.0, 2.05, 2.1)] == [True, False, True], "what is late is not made up for"


def test_the_latest_scan_is_seen_from_where_the_robot_is_by_then() -> None:
    cycle = ControlCycle(LASER, 0.1)
    cycle.see(np.full(181, 2.0, np.float32), Pose(1.0, 0.0, math.pi / 2.0), 0.0)
    ahead = cycle.scan(Pose(1.0, 0.0, math.pi / 2.0)).points[90]
    assert ahead == pytest.approx((2.1, 0.0))
    driven = cycle.scan(Pose(1.0, 0.5, math.pi / 2.0)).points[90]
    assert driven == pytest.approx((1.6, 0.0))
    turned = cycle.scan(Pose(1.0, 0.0, math.pi)).points[90]
    assert turned == pytest.approx((0.0, -2.1))


@pytest.mark.parametrize("interval", [50, 100, 200, 250])
def test_navigation_is_asked_ten_times_a_second(draw_world: Callable[..., str], interval: int) -> None:
    """It was asked with each scan: lasers of 5 Hz halved the accelerations and the corrections, those of 20 Hz doubled
    them."""
    path = Path(draw_world((6.0, 4.0), [], [(1.0, 2.0, 0.0)]))
    path.write_text(path.read_text().replace("update_interval 100 pose", f"update_interval {interval} pose"))
    loop = ClosedLoop(str(path), 1, 1)
    asked, step = [], loop.robots[0].navigator.step
    loop.robots[0].navigator.step = lambda now, *rest: (asked.append(now), step(now, *rest))[1]  # type: ignore
    loop.run(1.0)
    loop.robots[0].set_goal(Pose(3.0, 0.0, 0.0), loop.world.time)
    loop.run(2.0)
    assert np.diff(asked) == pytest.approx(0.1)
    speed = math.hypot(*(float(loop.world.states()[0][name]) for name in ("velocity_x", "velocity_y")))
    assert speed == pytest.approx(0.5, abs=0.05), "a second at 1 m/s^2"
