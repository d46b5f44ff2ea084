"""Measures registration on pairs of partial maps: right, imprecise, wrong, declined."""

from .families import FAMILIES, Case, Family, draw_case
from .figures import Trial, interval
from .outcome import Outcome, best_rigid_fit, classify, counts, overlap, shared_wall
from .rules import RULES, measured, rough_prior

__all__ = [
    "FAMILIES",
    "RULES",
    "Case",
    "Family",
    "Outcome",
    "Trial",
    "best_rigid_fit",
    "classify",
    "counts",
    "draw_case",
    "interval",
    "measured",
    "overlap",
    "rough_prior",
    "shared_wall",
]
