"""How sure a transform is, 0 to 1: the probability that it is right. One definition for robots, files and benchmark.

It is right if it names the right one of all places that look alike, and if there, where the maps meet, it is exact to
0.25 m. The first is a matter of evidence: of the walls and what contradicts them where two maps are all that there is.
A robot believes nothing before sightings, later maps or the team leave no doubt about the place. The second follows
from the covariance.
"""

import math

import numpy as np

from .covariance import Covariance
from .graph.edges import covariance_at_walls
from .registration import Registration

_RIGHT_M = 0.25
_MOST, _MOST_WITH_PRIOR = 0.93, 0.98
_TELLING_WALL_M, _TELLING_WALL_WITH_PRIOR_M = 8.0, 2.0
"""Largest confidence, and shared wall that takes away all but a third of the other doubt. Fitted to the answers on 880
generated pairs, six of whose sixteen families hold exact copies: these are nearly all that was wrong, and however much
wall is shared, two maps cannot show that there is no copy elsewhere."""


def confidence_of(covariance: Covariance, place: float = 1.0) -> float:
    """Of a transform with this covariance. place: probability of the right place; 1 for what a robot believes."""
    at_walls = covariance_at_walls(np.array(covariance)[None])[0]
    variance = max(at_walls[0, 0], at_walls[1, 1], 1e-9)
    return place * float(1.0 - math.exp(-0.5 * _RIGHT_M**2 / variance))


def place_of_two_maps(result: Registration) -> float:
    """Probability that an accepted transform of two maps alone is the right place.

    The product of three shares: length of the shared wall, 0.93 (1 - exp(-wall / 8 m)), with a prior
    0.98 (1 - exp(-wall / 2 m)); agreement, one minus five times the share of contradicted wall; uniqueness, one minus
    what the best different transform's score (relative to this one's) has beyond a third.
    """
    evidence = result.evidence
    telling = _TELLING_WALL_WITH_PRIOR_M if result.prior else _TELLING_WALL_M
    length = (_MOST_WITH_PRIOR if result.prior else _MOST) * (1.0 - math.exp(-evidence.matched / telling))
    agreement = max(0.0, 1.0 - 5.0 * evidence.conflict)
    rival = result.rival.evidence.score / evidence.score if result.rival is not None and evidence.score else 0.0
    return length * agreement * (1.0 - max(0.0, rival - 1.0 / 3.0))
