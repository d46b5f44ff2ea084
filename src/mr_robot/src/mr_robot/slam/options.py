"""Options of the SLAM engine; without the engine, for who only names them."""

from dataclasses import dataclass, fields

import numpy as np


class SlamError(ValueError):
    """A parameter or a message that SLAM cannot work with."""


@dataclass(frozen=True)
class SlamOptions:
    """Lengths in metres, angles in radians, times in seconds."""

    resolution: float = 0.05  # of the map
    match_distance: float = 0.04  # by odometry, after which a scan is matched
    match_angle: float = 0.035
    insert_distance: float = 0.1  # between scans that enter the map
    insert_angle: float = 0.087
    insert_interval: float = 1.0  # s between scans that change the map while the robot stands
    search_window: float = 0.4  # half width of the search when odometry does not lead to a match
    surface_window: float = 0.15  # hits this near to one another form a surface
    surface_deviation: float = 0.02  # standard deviation of hits around surfaces
    free_radius: float = 0.17  # around the robot that is free because the robot is there
    free_range: float = 20.0  # along beams that hit nothing
    small_object_size: float = 0.7  # things that stand free up to this size may be robots and are not matched

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (np.isfinite(value) and value > 0.0):
                raise SlamError(f"parameter {field.name} must be a positive number, not {value!r}")
