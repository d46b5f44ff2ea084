"""Robots that are heard and seen at the same time."""

from .confirmation import Confirmation, confirmed
from .hypotheses import hypotheses_of
from .meetings import Meetings
from .sightings import Sightings
from .values import Hypothesis, LaserScan, Sensor, TrackReport

__all__ = [
    "Confirmation",
    "Hypothesis",
    "LaserScan",
    "Meetings",
    "Sensor",
    "Sightings",
    "TrackReport",
    "confirmed",
    "hypotheses_of",
]
