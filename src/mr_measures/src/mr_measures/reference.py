"""P_ref of a world: how many free cells one robot alone explores there, kept beside the world.

The file `<world>.reference.json` holds the values with the seeds of their missions. It counts only for maps of the same
resolution made by the same SLAM, in missions of the same host: who starts the nodes and when shows in the maps.
"""

import json
import os
import statistics
from dataclasses import dataclass
from pathlib import Path

from mr_grid import OccupancyGrid
from mr_measures.figures import explored_free_cells, map_error

MINIMUM_MISSIONS = 10
VIRTUAL_TIME = "mr_experiments"  # the host of the references in `worlds/`


class MapReferenceError(ValueError):
    """A reference file that cannot be used."""


@dataclass(frozen=True)
class Reference:
    """`free_cells`: explored free cells of the robot's final map by seed of the mission; `host`: who ran the missions;
    `code`: the host's name for the code that did."""

    world: str
    resolution: float  # m
    slam: str
    host: str
    code: str
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
        reference = Reference(
            document["world"], float(document["resolution"]), document["slam"], document["host"], document["code"],
            missions,
        )  # fmt: skip
    except (OSError, KeyError, TypeError, ValueError) as error:
        told = f"{error} is missing" if isinstance(error, KeyError) else str(error)
        raise MapReferenceError(f"{path} is not a reference of map sizes: {told}") from error
    if not missions or any(cells <= 0 for cells in missions.values()):
        raise MapReferenceError(f"{path} holds no missions or one without free cells")
    return reference


def write_reference(world: str | Path, reference: Reference) -> Path:
    """Writes the reference of a world file, in place of one that is there, and returns its path."""
    document = {
        "world": reference.world,
        "what": "explored free cells of the final map of one robot alone, by seed of the mission",
        "resolution": reference.resolution,
        "slam": reference.slam,
        "host": reference.host,
        "code": reference.code,
        "median": reference.median,
        "missions": [{"seed": seed, "free_cells": cells} for seed, cells in sorted(reference.free_cells.items())],
    }
    path = reference_path(world)
    partial = path.with_suffix(".partial")
    partial.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    os.replace(partial, path)
    return path


def error_of_map(world: str | Path, occupancy: OccupancyGrid, slam: str, host: str) -> tuple[float | None, str]:
    """e of a robot's final map in percent against the missions of `host`, or None and the reason why there is none.
    Raises MapReferenceError for a broken file."""
    reference = load_reference(world)
    if reference is None:
        return None, "the world has no stored one-robot missions to compare with"
    if not reference.is_sufficient:
        return None, f"only {len(reference.free_cells)} of {MINIMUM_MISSIONS} one-robot missions are stored"
    if reference.host != host:
        return None, f"the stored missions are of another host: {reference.host}, not {host}"
    if reference.slam != slam or reference.resolution != round(occupancy.resolution, 6):
        return None, f"the stored missions are with {reference.slam} at {reference.resolution:g} m per cell"
    return map_error(explored_free_cells(occupancy), reference.median), ""
