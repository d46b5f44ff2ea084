"""What no team of simulated robots could beat."""

from __future__ import annotations

from mr_measures.lower_bound import LowerBound
from mr_robot.navigation.options import NavigationOptions
from mr_sim.true_world import true_world_of
from mr_sim.world import World


def bound_of(world: World) -> LowerBound:
    """For robots that are as fast as their base allows and navigation asks for. ValueError if none can move."""
    return LowerBound(true_world_of(world), NavigationOptions().max_linear_velocity)
