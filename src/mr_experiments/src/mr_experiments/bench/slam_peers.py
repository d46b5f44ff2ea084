"""MRPT's map builders as engines of SLAM, to compare with ours: `make bench-slam-peers` builds what they need.

Their settings were tuned, one after the other, on logs of seed 401, which no table is made from. What counts most is
the angle by which thresholds of matches grow with distance (MRPT's default, not the 5 degrees of its examples), that
scans enter the map 0.5 m apart, and that RBPF aligns particles with points, not with the grid, and takes the covariance
of the linear fit (finite differences make poses infinite, and maps with them).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mr_experiments.common.command_line import CallError
from mr_grid import OccupancyGrid, Pose
from mr_robot.slam.engine import LaserScan, SlamUpdate
from mr_sim.scan_log import ScanLog
from mr_sim.slam_evaluation import Engine

RESOLUTION = 0.05  # m, as ours
SEED = 1

_GRID = """
[MappingApplication_occupancyGrid_00_creationOpts]
resolution = {resolution}
[MappingApplication_occupancyGrid_00_insertOpts]
maxDistanceInsertion = {range_max}
maxOccupancyUpdateCertainty = 0.60
considerInvalidRangesAsFreeSpace = 1
[MappingApplication_occupancyGrid_00_likelihoodOpts]
likelihoodMethod = 4
LF_decimation = 5
LF_stdHit = {deviation}
LF_maxCorrsDistance = 0.30
LF_zHit = 0.999
LF_zRandom = 0.001
LF_maxRange = 30
LF_alternateAverageMethod = 0
enableLikelihoodCache = 1
"""
_ICP = """
[ICP]
maxIterations = 80
minAbsStep_trans = 1e-6
minAbsStep_rot = 1e-6
thresholdDist = 0.3
thresholdAng_DEG = 0.15
ALFA = 0.8
smallestThresholdDist = 0.05
onlyUniqueRobust = true
corresponding_points_decimation = 5
[MappingApplication]
localizationLinDistance = 0.04
localizationAngDistance = 2
insertionLinDistance = 0.5
insertionAngDistance = 20
minICPgoodnessToAccept = 0.40
matchAgainstTheGrid = 0
occupancyGrid_count = 1
pointsMap_count = 1
[MappingApplication_pointsMap_00_insertOpts]
minDistBetweenLaserPoints = 0.05
fuseWithExisting = 0
isPlanarMap = 1
"""
_RBPF = """
[MappingApplication]
insertionLinDistance = {insertion}
insertionAngDistance_deg = {insertion_turn}
localizeLinDistance = {localization}
localizeAngDistance_deg = {localization_turn}
PF_algorithm = {proposal}
adaptiveSampleSize = 0
resamplingMethod = 0
sampleSize = {particles}
BETA = 0.50
powFactor = {power}
pfAuxFilterOptimal_MaximumSearchSamples = 250
occupancyGrid_count = 1
pointsMap_count = 1
likelihoodMapSelection = 0
pfOptimalProposal_mapSelection = 3
ICPGlobalAlign_MinQuality = 0.5
ICP_covariance_method = icpCovLinealMSE
maxIterations = 60
thresholdDist = 0.3
thresholdAng_DEG = 0.15
ALFA = 0.50
smallestThresholdDist = 0.05
[MappingApplication_pointsMap_00_insertOpts]
minDistBetweenLaserPoints = 0.05
fuseWithExisting = 0
isPlanarMap = 1
"""
ALIGNED = {
    "proposal": 2, "particles": 10, "power": 0.01, "deviation": 0.05,
    "localization": 0.2, "localization_turn": 10, "insertion": 0.5, "insertion_turn": 20,
}  # fmt: skip
DRAWN = {
    "proposal": 0, "particles": 60, "power": 0.05, "deviation": 0.1,
    "localization": 0.1, "localization_turn": 3, "insertion": 0.3, "insertion_turn": 10,
}  # fmt: skip
"""Particles aligned with the map; and drawn from odometry and weighed, for a narrow view is aligned in wrong places."""
NARROW = 2.0  # rad of view


class Peer:
    """A map builder of MRPT."""

    def __init__(self, core: Any) -> None:
        self._core = core

    def process(self, scan: LaserScan, odometry: Pose, time: float) -> SlamUpdate:
        """MRPT does not tell what it matched."""
        ranges = np.ascontiguousarray(scan.ranges, dtype=np.float32)
        pose = self._core.process(
            ranges, odometry, scan.mount, scan.angle_min, scan.angle_increment, scan.range_min, scan.range_max, time
        )
        return SlamUpdate(Pose(*pose), True, True, 1.0)

    def map(self) -> OccupancyGrid:
        cells, x, y, resolution = self._core.occupancy()
        return OccupancyGrid.of(cells, resolution, Pose(x, y))


def peers() -> Mapping[str, Callable[[ScanLog], Engine]]:
    """By name, what makes the engine for a log. Raises CallError where MRPT's map builders are not built."""
    try:
        import _slam_peers as core
    except ImportError as error:
        raise CallError(
            f"MRPT's map builders are not built; `make bench-slam-peers` builds and runs them: {error}"
        ) from None
    return {
        "MRPT ICP": lambda log: Peer(core.icp(_settings(_ICP, log))),
        "MRPT RBPF": lambda log: Peer(core.rbpf(_settings(_RBPF, log), SEED)),
    }


def _settings(text: str, log: ScanLog) -> str:
    """As in MRPT's configuration files."""
    view = float(log.geometry[1]) * (log.ranges.shape[1] - 1)
    tuned = DRAWN if view < NARROW else ALIGNED
    return (text + _GRID).format(resolution=RESOLUTION, range_max=float(log.geometry[3]), **tuned)
