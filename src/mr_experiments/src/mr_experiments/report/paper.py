"""The numbers of the paper that this project repeats.

Source: T. Andre, D. Neuhold, C. Bettstetter: Coordinated Multi-Robot Exploration: Out of the Box Packages for ROS.
IEEE GLOBECOM Workshops, 2014. Forty simulated missions in Stage for each team size R, on a map of 26 m x 15 m with
error-free communication.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Mapping

WORLD, SCENARIO = "office26x15", "paper"  # where this project repeats the paper's simulations
MISSIONS = 40  # for each team size


@dataclass(frozen=True)
class Spread:
    """Row of a table: 0.05 quantile, arithmetic mean, 0.95 quantile."""

    low: float
    mean: float
    high: float


@dataclass(frozen=True)
class Mark:
    """Point of a curve that the text quotes: value in [0, 1] at a time in s for team size `robots`."""

    robots: int
    time: float
    value: float


# Table I: error e of the global maps, percent, by team size
MAP_ERROR: Mapping[int, Spread] = {
    1: Spread(-0.24, 0.11, 0.68),
    2: Spread(-1.73, 0.19, 1.53),
    3: Spread(-1.32, 1.83, 6.20),
    4: Spread(0.74, 6.40, 14.67),
}

# Table II a: distance driven by the whole team, m, by team size
DISTANCE: Mapping[int, Spread] = {
    1: Spread(65, 81, 96),
    2: Spread(93, 121, 157),
    3: Spread(127, 154, 176),
    4: Spread(196, 274, 371),
}

# Table II b: exploration time T, s, by team size
EXPLORATION_TIME: Mapping[int, Spread] = {
    1: Spread(865, 945, 1001),
    2: Spread(649, 783, 942),
    3: Spread(673, 776, 893),
    4: Spread(847, 1208, 1673),
}

# Section VII-B on Fig. 4: share of the area explored
PROGRESS_MARKS = (Mark(1, 400, 0.66), Mark(3, 400, 0.82))

# Section VII-B on Fig. 5: share of the robots that have finished
FINISHING_MARKS = (Mark(1, 900, 0.21), Mark(3, 900, 0.96), Mark(4, 1021, 0.50))
