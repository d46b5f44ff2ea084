"""What the runner needs to know about a world. What the figures mean is defined in mr_measures."""

from __future__ import annotations

import math
import pickle
import shutil
import sys
from pathlib import Path
from typing import Any, Mapping, Sequence

import numpy as np
import yaml  # type: ignore[import-untyped]

from mr_grid import OccupancyGrid, Pose
from mr_launch.errors import UserError
from mr_launch.plan import Walls
from mr_measures.record.robot_record import MapFigures


def find_world(name: str, starts: Sequence[float] = ()) -> str:
    """Path of a world given by name or file. `starts`: x m, y m and degrees of each robot in a map. Raises UserError
    that lists the known worlds."""
    from mr_sim.map_world import is_map
    from mr_sim.world_names import name_of
    from mr_sim.worlds import StartsError, WorldNotFoundError, starts_of
    from mr_sim.worlds import find_world as find

    try:
        if starts and not is_map(name):
            raise UserError(f"--starts are for a map (.yaml); {name} says itself where its robots stand")
        found = find(name_of(name), starts=starts_of(starts))
        return str(found.parent.resolve() / found.name)
    except StartsError as error:
        raise UserError(str(error)) from None
    except (WorldNotFoundError, OSError) as error:
        raise UserError(f"--world: {error}") from None


def is_map(name: str) -> bool:
    """Whether a world is given as a map of map_server."""
    from mr_sim.map_world import is_map as found

    return found(name)


def keep_generated(world: str, folder: Path) -> str:
    """Path of a world in the folder of a mission: a copy of its files if it was drawn for it, else where it is.
    Raises UserError."""
    from mr_sim.worlds import GENERATED, files_of

    path = Path(world)
    if path.parent != GENERATED.resolve():
        return world
    try:
        folder.mkdir()
        for file in files_of(path):
            shutil.copy(file, folder)
    except OSError as error:
        raise UserError(f"cannot keep the world in {folder}: {error.strerror}") from None
    return str(folder / path.name)


def presets_of(world: str, names: Sequence[str]) -> tuple[dict[str, str], dict[str, str]]:
    """What the robots are by their models: the preset of each robot by name, and the text of each preset by name. Equal
    robots share one, which has the name of the first. Raises UserError."""
    from mr_robot.platforms.platform import PlatformError
    from mr_robot.platforms.preset import platform_from, text_of
    from mr_sim.simulated_platform import platform_of
    from mr_sim.world_model import load_world

    of_robot: dict[str, str] = {}
    texts: dict[str, str] = {}
    for robot in load_world(world).robots:
        if robot.name not in names:
            continue
        try:
            text = text_of(platform_of(robot))
            platform_from(yaml.safe_load(text))
        except PlatformError as error:
            raise UserError(f"{world}: {robot.name}: {error}") from None
        of_robot[robot.name] = next((name for name, known in texts.items() if known == text), robot.name)
        texts.setdefault(of_robot[robot.name], text)
    return of_robot, texts


def project_worlds() -> list[Path]:
    """Folders of the project's worlds."""
    from mr_sim.world_folders import world_folders

    return world_folders()


def robots_of(world: str) -> list[tuple[str, Pose]]:
    """Names and start poses of the robots of a world file, in the file's order. Raises UserError."""
    from mr_sim.world_file import WorldFileError
    from mr_sim.world_model import load_world

    try:
        return [(robot.name, robot.start) for robot in load_world(world).robots]
    except (WorldFileError, OSError) as error:
        raise UserError(str(error)) from None


def warning_of(name: str, world: str) -> str:
    """One line on what the world, by its given name and its path, says without effect; empty if there is nothing."""
    from mr_sim.world_model import load_world
    from mr_sim.worlds import warning_of as warning

    return warning(name, load_world(world))


def check_start(world: str, robots: int) -> None:
    """The robots of the team stand free. Raises UserError."""
    from mr_sim.world import World, WorldError
    from mr_sim.world_model import load_world

    try:
        World(load_world(world), robots)
    except (WorldError, ValueError, OSError) as error:
        raise UserError(str(error)) from None


def write_walls(world: str, file: str) -> Walls:
    """Write the floor plan, as lasers see it, for the radio."""
    from mr_sim.raster import rasterise, write_image
    from mr_sim.world_model import load_world

    description = load_world(world)
    grid = rasterise([obstacle for obstacle in description.obstacles if obstacle.visible], description.resolution)
    write_image(grid, file)
    return Walls(file, grid.resolution, grid.origin)


def write_truth(world: str, robots: int, path: Path) -> None:
    """Compute what maps of this world are compared with (seconds of work) and store it for ``load_truth``."""
    from mr_measures.truth import Truth
    from mr_sim.true_world import true_world_of
    from mr_sim.world import World
    from mr_sim.world_model import load_world

    truth = Truth.of_world(true_world_of(World(load_world(world), robots)))
    partial = path.with_suffix(".partial")
    partial.write_bytes(pickle.dumps(truth))
    partial.rename(path)


def load_truth(path: Path) -> Any | None:
    """The stored mr_measures.truth.Truth, None while it is not there. The file comes from this team's own process."""
    try:
        return pickle.loads(path.read_bytes())
    except OSError:
        return None


class Meter:
    """What one robot's maps know while the team runs. Until the reference has been computed there is nothing to say."""

    def __init__(self, truth_file: str, start: Pose) -> None:
        """`start`: true, world frame."""
        self._file = Path(truth_file)
        self._start = start
        self._truth: Any | None = None
        self._knowledge: Any | None = None
        self._looked_at = -math.inf

    def coverage(self, grid: OccupancyGrid) -> float | None:
        """Share of the reference cells that the map knows."""
        from mr_measures.figures import coverage

        self._truth = self._truth or load_truth(self._file)
        return None if self._truth is None else coverage(self._truth, grid, self._start)

    def look(self, own: OccupancyGrid, now: float) -> None:
        """Notes what the robot's own map knows at simulation time ``now`` (s)."""
        from mr_measures.knowledge import Knowledge

        self._truth = self._truth or load_truth(self._file)
        if self._truth is not None:
            self._knowledge = self._knowledge or Knowledge(self._truth, self._start)
            self._knowledge.look(own, now)
            self._looked_at = now

    def is_due(self, now: float) -> bool:
        """Whether it is time for another look."""
        from mr_measures.knowledge import PERIOD

        return now - self._looked_at >= PERIOD

    def save(self, path: Path) -> None:
        """Since when the own map has known each reference cell, s of simulation time, for the runner."""
        if self._knowledge is not None:
            np.save(known_file(path), self._knowledge.since)


def known_file(map_file: Path) -> Path:
    """Beside the file of a robot's final map."""
    return map_file.with_suffix(".known.npy")


def own_map_file(map_file: Path) -> Path:
    """Of the robot's own map, beside the file of its final global map."""
    return map_file.with_suffix(".own.npz")


def load_known(map_files: Mapping[str, Path]) -> dict[str, np.ndarray]:
    """What each robot's meter has saved; none where it has not."""
    files = {name: known_file(path) for name, path in map_files.items()}
    return {name: np.load(path) for name, path in files.items() if path.exists()}


class Measures:
    """Figures of final maps, by mr_measures."""

    def __init__(self, world: str, slam: str, truth_file: Path) -> None:
        self._world = world
        self._slam = slam
        self._truth = load_truth(truth_file)

    @property
    def reference(self) -> np.ndarray | None:
        """(N, 2) the reference cells, m, world frame; None if nobody has computed them."""
        return None if self._truth is None else self._truth.reference

    def of(self, grid: OccupancyGrid | None, start: Pose) -> MapFigures:
        """Of one robot's final map. Its error is against missions in virtual time: those of a host in real time would
        take an hour for each world."""
        if grid is None:
            return MapFigures(error_reason="the robot gave no map")
        from mr_measures.record.parts import error_or_reason, map_figures_of
        from mr_measures.reference import VIRTUAL_TIME

        return map_figures_of(grid, self._truth, start, *error_or_reason(self._world, grid, self._slam, VIRTUAL_TIME))


if __name__ == "__main__":
    write_truth(sys.argv[1], int(sys.argv[2]), Path(sys.argv[3]))
