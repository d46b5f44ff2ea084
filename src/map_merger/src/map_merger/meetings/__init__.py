"""Robots that are heard and seen at the same time."""

from .confirmation import Confirmation, confirmed
from .hypotheses import Sightings
from .meetings import Meetings
from .rivals import agrees
from .values import Hypothesis, LaserScan, Sensor, TrackReport

__all__ = [
    "Confirmation",
    "Hypothesis",
    "LaserScan",
    "Meetings",
    "Sensor",
    "Sightings",
    "TrackReport",
    "agrees",
    "confirmed",
]
