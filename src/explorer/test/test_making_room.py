"""Robots at home that stand in the way of others."""

import math
from types import SimpleNamespace
from typing import Any, List, Optional, Tuple, cast

import numpy as np
import pytest
from usual_robot import LARGEST

from explorer.foreign import ForeignFrontiers
from explorer.grid import OccupancyMap
from explorer.making_room import CLEARANCE, HELD, PATIENCE, TIMES, MakingRoom
from explorer.perception import Perception
from explorer.senses import Senses
from explorer.team import Team
from explorer.ways import Ways
from mr_grid import Pose

RADIUS = 0.25
HERE = Pose(2.0, 0.0, 0.0)


def dead_end(half_width: float = 1.3) -> OccupancyMap:
    """A corridor along x from 0 to 10 m, open at its far end."""
    cells = np.full((80, 220), 100, np.int8)
    rows = slice(40 - round(half_width / 0.05), 40 + round(half_width / 0.05))
    cells[rows, 20:] = 0
    return OccupancyMap.of(cells, 0.05, Pose(-1.0, -2.0, 0.0))


class Bench:
    """This robot at home in the corridor; the map of robot_1 begins at `home`."""

    def __init__(self, home: Optional[Tuple[float, float]] = (1.0, 0.0), half_width: float = 1.3) -> None:
        senses = Senses(HERE)
        senses.take_pose(HERE, 0.0)
        self.senses, self.team, foreign = senses, Team("robot_0", 30.0), ForeignFrontiers()
        self.team.set_known(["robot_1"])
        if home is not None:
            foreign.set_transform("robot_1", np.array([[1.0, 0.0, home[0]], [0.0, 1.0, home[1]]]))
        ways = Ways(dead_end(half_width), RADIUS, [], LARGEST)
        perception = cast(Perception, SimpleNamespace(ways=ways))
        self.room, self.now = MakingRoom(senses, perception, self.team, foreign, RADIUS), 100.0

    def run(self, seconds: float, x: float, y: float = 0.0, speed: float = 0.0) -> List[Optional[Pose]]:
        """Places that are to be driven to while robot_1 is there."""
        places: List[Optional[Pose]] = []
        for _ in range(int(seconds)):
            self.now += 1.0
            x += speed
            self.team.set_positions({"robot_1": (x, y)}, self.now)
            places.append(self.room.place(self.now))
        return places


def test_a_robot_at_home_makes_room_for_one_that_lives_behind_it() -> None:
    """Robots that came home first stood in the corridor, and those that lived behind them tried five times in vain."""
    bench = Bench()
    places = bench.run(HELD + 2.0, 3.2)
    assert places[0] is None and bench.room.robot == "robot_1"
    place: Any = places[-1]
    way = [(x, 0.0) for x in np.arange(1.0, 3.2, 0.05)]
    assert min(math.dist(place[:2], point) for point in way) >= 2 * RADIUS + CLEARANCE - 0.06
    assert bench.run(2.0, 1.1)[-1] is None and bench.room.robot is None, "it is in"


@pytest.mark.parametrize(
    "home, x, y, speed",
    [
        ((1.0, 0.0), 1.3, 0.0, 0.0),  # at home
        ((1.0, 0.0), 3.2, 0.0, 0.6),  # gets on
        ((1.0, 0.0), 6.0, 0.0, 0.0),  # somewhere else
        ((5.0, 0.0), 4.0, 0.0, 0.0),  # on this side
        (None, 3.2, 0.0, 0.0),  # nobody knows
    ],
)
def test_a_robot_at_home_stays_where_nobody_needs_room(home: Any, x: float, y: float, speed: float) -> None:
    bench = Bench(home)
    assert bench.run(HELD + 10.0, x, y, speed) == [None] * int(HELD + 10.0)


def test_there_is_no_room_to_be_made_in_a_corridor_that_is_too_narrow() -> None:
    bench = Bench(home=(0.4, 0.0), half_width=0.4)
    assert bench.run(HELD + 10.0, 3.2)[-1] is None


def test_room_is_made_for_a_while_and_not_for_ever() -> None:
    bench = Bench()
    made = [place is not None for place in bench.run(5.0 * (PATIENCE + 2.0), 3.2)]
    assert 0.9 * TIMES * PATIENCE < sum(made) < 1.1 * TIMES * PATIENCE and not made[-1]
