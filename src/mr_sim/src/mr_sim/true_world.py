"""A simulated world in the form that `mr_measures` takes."""

import math

import numpy as np

from mr_grid import OCCUPIED, OccupancyGrid, Pose
from mr_measures.true_world import TrueRobot, TrueWorld
from mr_sim import _world
from mr_sim.raster import Grid
from mr_sim.world import World
from mr_sim.world_description import RobotDescription


def true_world_of(world: World) -> TrueWorld:
    """The true walls and the robots of a world."""
    visible, robots = world.visible, tuple(_robot(robot) for robot in world.robots)
    cast = _world.Raster(visible.cells, visible.resolution, visible.origin).cast
    return TrueWorld(occupancy_of(visible), occupancy_of(world.obstacles), cast, robots)


def occupancy_of(walls: Grid) -> OccupancyGrid:
    """Walls as a grid of free and occupied cells."""
    return OccupancyGrid.of(
        np.where(walls.cells > 0, OCCUPIED, 0).astype(np.int8), walls.resolution, Pose(*walls.origin)
    )


def _robot(robot: RobotDescription) -> TrueRobot:
    return TrueRobot(
        robot.start,
        robot.footprint,
        max((ranger.range_max for ranger in robot.rangers), default=0.0),
        max((math.hypot(*ranger.mount[:2]) for ranger in robot.rangers), default=0.0),
        max(abs(bound) for bound in robot.linear_bounds),
    )
