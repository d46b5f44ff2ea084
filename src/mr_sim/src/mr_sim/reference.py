"""P_ref of a world: how many free cells one robot alone explores there, kept beside the world.

The file `<world>.reference.json` holds the values with the seeds of their missions. It counts only for maps of the same
resolution made by the same SLAM.
"""

import json
import os
import statistics
from dataclasses import dataclass
from pathlib import Path

from mr_sim.measures import OccupancyMap, map_error

MINIMUM_MISSIONS = 10


class MapReferenceError(ValueError):
    """A reference file that cannot be used."""


@dataclass(frozen=True)
class Reference:
    """`free_cells`: explored free cells of the robot's final map by seed of the mission."""

    world: str
    resolution: float
    slam: str
    free_cells: dict[int, int]

    @property
    def is_sufficient(self) -> bool:
        return len(self.free_cells) >= MINIMUM_MISSIONS

    @property
    def median(self) -> float:
        return float(statistics.median(self.free_cells.values()))


def reference_path(world: str | Path) -> Path:
    """Where the reference of a world file is kept."""
    return Path(world).with_suffix(".reference.json")


def load_reference(world: str | Path) -> Reference | None:
    """The reference of a world file; None when there is none yet. Raises MapReferenceError for a broken one."""
    path = reference_path(world)
    if not path.exists():
        return None
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        missions = {int(mission["seed"]): int(mission["free_cells"]) for mission in document["missions"]}
        reference = Reference(document["world"], float(document["resolution"]), document["slam"], missions)
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise MapReferenceError(f"{path} is not a reference of map sizes: {error}") from error
    if not missions or any(cells <= 0 for cells in missions.values()):
        raise MapReferenceError(f"{path} holds no missions or one without free cells")
    return reference


def add_to_reference(world: str | Path, seed: int, free_cells: int, resolution: float, slam: str) -> Reference:
    """Add the outcome of a finished one-robot mission, replacing one of the same seed, and write the file.

    Raises MapReferenceError when resolution or SLAM differ from the missions that are there already.
    """
    if free_cells <= 0:
        raise MapReferenceError(f"a finished mission explores more than {free_cells} free cells")
    known = load_reference(world)
    if known and (known.resolution != resolution or known.slam != slam):
        raise MapReferenceError(
            f"{reference_path(world)} holds missions with {known.slam} at {known.resolution:g} m; "
            f"one with {slam} at {resolution:g} m cannot be compared: start a new file"
        )
    missions = dict(sorted({**(known.free_cells if known else {}), seed: free_cells}.items()))
    reference = Reference(Path(world).stem, resolution, slam, missions)
    document = {
        "world": reference.world,
        "what": "explored free cells of the final map of one robot alone, by seed of the mission",
        "resolution": resolution,
        "slam": slam,
        "median": reference.median,
        "missions": [{"seed": s, "free_cells": cells} for s, cells in missions.items()],
    }
    path = reference_path(world)
    partial = path.with_suffix(".partial")
    partial.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    os.replace(partial, path)
    return reference


def error_of_map(world: str | Path, occupancy: OccupancyMap, slam: str) -> tuple[float | None, str]:
    """e of a robot's final map in percent, or None and the reason why there is none. Raises MapReferenceError."""
    reference = load_reference(world)
    if reference is None:
        return None, "the world has no stored one-robot missions to compare with"
    if not reference.is_sufficient:
        return None, f"only {len(reference.free_cells)} of {MINIMUM_MISSIONS} one-robot missions are stored"
    if reference.slam != slam or reference.resolution != round(occupancy.resolution, 6):
        return None, f"the stored missions are with {reference.slam} at {reference.resolution:g} m per cell"
    return map_error(occupancy.explored_free_cells, reference.median), ""
