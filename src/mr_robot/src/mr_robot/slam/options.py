"""Options of the SLAM engine; without the engine, for who only names them."""

from dataclasses import dataclass, fields

import numpy as np


class SlamError(ValueError):
    """A parameter or a message that SLAM cannot work with."""


@dataclass(frozen=True)
class SlamOptions:
    """Lengths in metres, angles in radians, times in seconds. What has no default follows from the robot:
    `mr_robot.platforms.engines`."""

    surface_deviation: float  # standard deviation of hits around surfaces
    free_radius: float  # around the robot that is free because the robot is there
    small_object_size: float  # things that stand free up to this size may be robots and are not matched
    resolution: float = 0.05  # of the map
    match_distance: float = 0.04  # by odometry, after which a scan is matched
    match_angle: float = 0.035
    insert_distance: float = 0.1  # between scans that enter the map
    insert_angle: float = 0.087
    insert_interval: float = 1.0  # s between scans that change the map while the robot stands
    search_window: float = 0.4  # half width of the search when odometry does not lead to a match
    surface_window: float = 0.15  # hits this near to one another form a surface
    free_range: float = 20.0  # along beams that hit nothing

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (np.isfinite(value) and value > 0.0):
                raise SlamError(f"parameter {field.name} must be a positive number, not {value!r}")
