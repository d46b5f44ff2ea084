"""A registration method of one's own: transforms from AKAZE features. map_merger verifies them and decides."""

from typing import List

from map_merger.features import akaze, estimates
from mr_grid import OccupancyGrid, Pose

MOST = 4  # transforms, each from the matches that the earlier ones left over


def candidates(target: OccupancyGrid, source: OccupancyGrid) -> List[Pose]:
    """Transforms of the source's map frame into the target's that may be right."""
    return estimates(target, source, akaze(), MOST)
