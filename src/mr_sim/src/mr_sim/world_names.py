"""One name for each world, however it is given: by name, by a path from here or from the root, through a link."""

import os
from dataclasses import replace
from pathlib import Path

from mr_plans.names import ROBOT_FILE, is_generated
from mr_sim.map_world import is_map, map_world_files
from mr_sim.world_description import WorldDescription
from mr_sim.world_file import WorldFileError
from mr_sim.world_folders import world_folders
from mr_sim.world_model import load_world


def name_of(world: str) -> str:
    """What a world, given as to `find_world`, is called in records: one of the project's by its name without `.world`,
    another file by its whole path, without links; so is the robot's file of a generated one. What is no file here
    stays as it is."""
    drawn, colon, last = world.rpartition(":")
    if is_generated(world) and last.endswith(ROBOT_FILE) and os.path.isfile(last):
        return f"{drawn}{colon}{Path(last).resolve()}"
    named = _of_project(world)
    path = Path(world) if named is None else named
    if not os.path.isfile(path):
        return world
    file = _without_links(path)
    own = _of_project(file.stem)
    return file.stem if own is not None and own.resolve() == file else str(file)


def told_here(name: str) -> str:
    """The name of a world in few words: below the current folder as one gives it there, else as it is."""
    try:
        return str(Path(name).relative_to(os.getcwd()))
    except ValueError:
        return name


def _of_project(name: str) -> Path | None:
    """As `find_world` finds it: what lies in the current folder comes first."""
    if "/" in name or os.path.isfile(name):
        return None
    file = f"{name.removesuffix('.world')}.world"
    return next((folder / file for folder in world_folders() if os.path.isfile(folder / file)), None)


def _without_links(path: Path) -> Path:
    """The file that a link names, unless it would be another world there: a world names files beside it."""
    beside = path.parent.resolve() / path.name
    target = path.resolve()
    if target == beside:
        return target
    here, there = _read(beside), _read(target)
    return beside if here is not None and here != there else target


def _read(path: Path) -> WorldDescription | bytes | None:
    """What a world says, equal for equal ones; None for one that cannot be read."""
    try:
        if is_map(str(path)):
            return map_world_files(path).picture
        description = load_world(path)
    except (WorldFileError, ValueError, OSError):
        return None
    obstacles = tuple(
        replace(obstacle, bitmap=None if obstacle.bitmap is None else obstacle.bitmap.resolve())
        for obstacle in description.obstacles
    )
    return replace(description, path=path.resolve(), obstacles=obstacles, warning="")
