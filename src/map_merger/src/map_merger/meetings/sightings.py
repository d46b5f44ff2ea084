"""All that two robots saw and told, as one value."""

from dataclasses import dataclass, field
from typing import Mapping, Tuple

import numpy as np

from mr_grid import Pose

from .sweeps import Sweeps
from .tracking import Fragment
from .values import NO_SENSOR, UNMOVED, Sensor


@dataclass(frozen=True, eq=False)
class Sightings:
    """All that is known for the comparison of the own robot with another. Times are of the own clock.

    own, told: tracks (n, >= 3: time, x, y, ...) of the own robot and the other, each in its own frame; told also has
    the yaw. objects, told_objects: what each saw, in its own frame. sensor: the other's. others: tracks of the further
    robots that are heard, in their frames, as the other may be mistaken for them. placed: the believed ones of their
    transforms to the own frame. All tracks are free of jumps; jump: m by which both have jumped. own_map, told_map:
    from the frame of each robot's tracks to that of its map, in the mean.
    """

    robot: str
    own: np.ndarray
    told: np.ndarray
    objects: Tuple[Fragment, ...]
    told_objects: Tuple[Fragment, ...]
    sweeps: Sweeps
    sensor: Sensor = NO_SENSOR
    others: Mapping[str, np.ndarray] = field(default_factory=dict)
    placed: Mapping[str, Pose] = field(default_factory=dict)
    jump: float = 0.0
    own_map: Pose = UNMOVED
    told_map: Pose = UNMOVED
