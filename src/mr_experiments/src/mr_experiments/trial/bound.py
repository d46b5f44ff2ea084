"""What no team of simulated robots could beat."""

from __future__ import annotations

from mr_experiments.trial.trial_world import platforms_of
from mr_measures.lower_bound import LowerBound
from mr_sim.true_world import true_world_of
from mr_sim.world import World


def bound_of(world: World) -> LowerBound:
    """For robots that are as fast as their models allow. ValueError if none can move."""
    fastest = max(platform.drive.max_linear_velocity for platform in platforms_of(world))
    return LowerBound(true_world_of(world), fastest)
