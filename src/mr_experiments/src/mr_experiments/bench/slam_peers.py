"""MRPT's map builders as engines of SLAM, to compare with ours: `make bench-slam-peers` builds what they need."""

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
PARTICLES, SEED = 15, 1  # MRPT's own example takes as many

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
LF_stdHit = 0.05
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
thresholdAng_DEG = 5
ALFA = 0.8
smallestThresholdDist = 0.05
onlyUniqueRobust = true
corresponding_points_decimation = 5
[MappingApplication]
localizationLinDistance = 0.04
localizationAngDistance = 2
insertionLinDistance = 0.1
insertionAngDistance = 5
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
insertionLinDistance = 0.5
insertionAngDistance_deg = 20
localizeLinDistance = 0.2
localizeAngDistance_deg = 10
PF_algorithm = 2
adaptiveSampleSize = 0
resamplingMethod = 0
sampleSize = {particles}
BETA = 0.50
powFactor = 0.01
pfAuxFilterOptimal_MaximumSearchSamples = 250
occupancyGrid_count = 1
pointsMap_count = 0
likelihoodMapSelection = 0
pfOptimalProposal_mapSelection = 0
ICPGlobalAlign_MinQuality = 0.70
maxIterations = 60
thresholdDist = 0.3
thresholdAng_DEG = 5
ALFA = 0.50
smallestThresholdDist = 0.05
"""


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
    range_max = float(log.geometry[3])
    return (text + _GRID).format(resolution=RESOLUTION, range_max=range_max, particles=PARTICLES)
