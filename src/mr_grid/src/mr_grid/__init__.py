"""Poses in the plane and occupancy grids: values that the packages of the stack share.

`map_files` reads and writes them as files of map_server; `ros` converts them from and to messages, for nodes only.
"""

from mr_grid.grid import FREE, OCCUPIED, UNKNOWN, GridError, GridInfo, OccupancyGrid, empty_grid, grid_of, values_at
from mr_grid.pose import FARTHEST, IDENTITY, Pose, is_place, normalized, pose_of

__all__ = [
    "FARTHEST",
    "FREE",
    "IDENTITY",
    "OCCUPIED",
    "UNKNOWN",
    "GridError",
    "GridInfo",
    "OccupancyGrid",
    "Pose",
    "empty_grid",
    "grid_of",
    "is_place",
    "normalized",
    "pose_of",
    "values_at",
]
