"""Worlds by name: those of the project, files, and worlds that are drawn when asked for."""

import contextlib
import hashlib
import math
import os
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from mr_grid import Pose
from mr_measures.reference import reference_path
from mr_plans.names import FORM, ROBOT_FILE, WorldName, is_generated, parse_name
from mr_plans.world_files import WorldFiles, world_files
from mr_robot.platforms.parameters import largest_radius
from mr_robot.platforms.platform import PlatformError
from mr_sim.map_world import is_map, map_world_files
from mr_sim.simulated_platform import platform_of
from mr_sim.world_description import RobotDescription, WorldDescription
from mr_sim.world_file import WorldFileError
from mr_sim.world_folders import world_folders
from mr_sim.world_model import load_world
from mr_sim.world_words import nearest

GENERATED = Path("out/worlds")
"""Where generated worlds are written unless another folder is given."""
LARGEST = "pioneer"
"""Of the models of generated worlds, the one that needs most room."""


class WorldNotFoundError(ValueError):
    """No world of that name, or none that can be drawn."""


class StartsError(ValueError):
    """Start poses that are none."""


def find_world(name: str, folder: Path = GENERATED, starts: Sequence[Pose] = ()) -> Path:
    """Path of a world: `name` is a path, the name of one of the project's worlds with or without `.world`, that of a
    generated one or the `.yaml` file of a map; the files of the last two are then written to `folder`. `starts`: of the
    robots in a map, world frame, else there is one. Raises WorldNotFoundError, OSError if they cannot be written."""
    path = Path(name)
    if os.path.isfile(path):  # that, unlike Path.is_file, also of names that are too long to be one
        return _from_map(name, folder, starts) if is_map(name) else path
    if is_generated(name):
        return _generated(name, folder)
    names = [name] if name.endswith(".world") else [name, f"{name}.world"]
    for place in world_folders():
        for candidate in names:
            if "/" not in name and os.path.isfile(place / candidate):
                return place / candidate
    if is_map(name) or "/" in name:
        raise WorldNotFoundError(
            f'no world "{name}": {"that is a folder" if os.path.isdir(path) else "there is no such file"}'
        )
    known = sorted({world.stem for place in world_folders() for world in place.glob("*.world")})
    meant = nearest(name.removesuffix(".world"), known)
    if meant:
        raise WorldNotFoundError(f'no world "{name}", did you mean "{meant}"?')
    ways = f"give the path of a .world file or of a map's .yaml file, {FORM}, or one of: {', '.join(known)}"
    raise WorldNotFoundError(f'no world "{name}": {ways}')


def warning_of(name: str, description: WorldDescription) -> str:
    """One line that names what the world, given as to `find_world`, says without effect; empty if there is nothing or
    the world is one of the project's, which lose nothing that matters."""
    if not description.warning or is_generated(name) or is_map(name) or description.path.parent in world_folders():
        return ""
    return f"{description.path}: {description.warning}"


def label_of(name: str) -> str:
    """A short name for a world given as to `find_world`, fit for the name of a file. Raises WorldNotFoundError."""
    if not is_generated(name):
        return Path(name).stem
    try:
        return parse_name(name).stem
    except ValueError as error:
        raise WorldNotFoundError(str(error)) from None


def with_starts(description: WorldDescription, starts: Sequence[Pose]) -> WorldDescription:
    """Robots robot_0, ... at other poses (world frame); those beyond the ones of the world are like its last one.
    Raises StartsError for a world without any."""
    models = description.robots
    if not models:
        raise StartsError(f"{description.path} has no robot that could stand at a start pose: add a position model")
    robots = tuple(
        replace(models[min(i, len(models) - 1)], name=f"robot_{i}", start=start, localization_origin=start)
        for i, start in enumerate(starts)
    )
    return replace(description, robots=robots)


def starts_of(numbers: Sequence[float]) -> tuple[Pose, ...]:
    """Start poses from x and y in m and the heading in degrees of each robot in turn. Raises StartsError."""
    if len(numbers) % 3:
        raise StartsError(f"--starts takes X Y DEGREES for each robot, not {len(numbers)} numbers")
    if not all(map(math.isfinite, numbers)):
        raise StartsError("--starts takes finite numbers, X Y DEGREES for each robot")
    triples = zip(numbers[::3], numbers[1::3], numbers[2::3], strict=True)
    return tuple(Pose(x, y, math.radians(degrees)) for x, y, degrees in triples)


def _from_map(name: str, folder: Path, starts: Sequence[Pose]) -> Path:
    try:
        return _write(map_world_files(name, starts), folder)
    except ValueError as error:
        raise WorldNotFoundError(str(error)) from None


def _generated(name: str, folder: Path) -> Path:
    """Drawn anew by each process, so that files of former code are replaced."""
    try:
        file = parse_name(name).robot_file
        robot = b"" if file is None else _read_robot(file)
        files = _drawn(name, robot)
    except ValueError as error:
        raise WorldNotFoundError(f"{name}: {error}") from None
    return _write(files, folder, robot)


def _read_robot(file: Path) -> bytes:
    """Raises WorldNotFoundError."""
    try:
        return file.read_bytes()
    except OSError as error:
        raise WorldNotFoundError(f"{file}, which describes its robots, cannot be read: {error.strerror}") from None


def _write(files: WorldFiles, folder: Path, robot: bytes = b"") -> Path:
    """`robot`: what the last of its models is, where it is none of ours."""
    folder.mkdir(parents=True, exist_ok=True)
    world = folder / f"{files.stem}.world"
    for model in files.models:
        own = bool(robot) and model == files.models[-1]
        _keep(folder / f"{model}{ROBOT_FILE}", robot if own else _model(model))
    if _keep(world.with_suffix(".png"), files.picture):
        reference_path(world).unlink(missing_ok=True)  # of another plan
    _keep(world, files.text.encode())
    return world


def files_of(world: Path) -> list[Path]:
    """The file of a generated world and all that belong to it. Raises OSError."""
    text = world.read_text(encoding="utf-8")
    included = [file for file in sorted(world.parent.glob(f"*{ROBOT_FILE}")) if f'include "{file.name}"' in text]
    return [world, *included, *filter(Path.is_file, (world.with_suffix(".png"), reference_path(world)))]


@lru_cache(maxsize=8)
def _drawn(name: str, robot: bytes) -> WorldFiles:
    world = parse_name(name)
    return world_files(world, radius_for(world), hashlib.sha256(robot).hexdigest()[:8] if robot else "")


def radius_for(world: WorldName) -> float:
    """m, of the largest robot of a generated world, as its model says; no less than a Pioneer's, so that robots of any
    kind start at the same places as far as there is room. ValueError for a robot's file that cannot be used."""
    if world.robot_file is None:
        return _pioneer_radius()
    return max(_pioneer_radius(), _radius_of(world.robot_file))


@lru_cache(maxsize=1)
def _pioneer_radius() -> float:
    return _radius_of(_model_file(LARGEST))


def _radius_of(file: Path) -> float:
    return largest_radius([platform_of(_robot_of(file))])


def robot_named(name: str) -> RobotDescription:
    """A robot of a model of the project, `pioneer`, or of the file of one, `FOLDER/NAME.inc`. Raises WorldNotFoundError
    for one that there is not or that cannot be used."""
    file = Path(name)
    try:
        if not name.endswith(ROBOT_FILE):
            return _robot_of(_model_file(name))
        _read_robot(file)
        return _robot_of(file)
    except ValueError as error:
        raise WorldNotFoundError(str(error)) from None


def _robot_of(file: Path) -> RobotDescription:
    """ValueError for one that cannot be used."""
    with tempfile.TemporaryDirectory() as folder:
        world = Path(folder) / "robot.world"
        world.write_text(f'include "{file.resolve()}"\n{file.stem} ( )\n')
        try:
            robots = load_world(world).robots
        except WorldFileError as error:
            told = str(error)
            if told.startswith(f"{world}:"):
                told = f"{file} has to define {file.stem}"
            raise ValueError(told) from None
    if not robots:
        raise ValueError(f"{file} has to define {file.stem} as a position model")
    try:
        platform_of(robots[0])
    except PlatformError as error:
        raise ValueError(f"{file}: {error}") from None
    return robots[0]


def _model_file(name: str) -> Path:
    for folder in world_folders():
        if (folder / f"{name}{ROBOT_FILE}").is_file():
            return folder / f"{name}{ROBOT_FILE}"
    raise WorldNotFoundError(f"{name}{ROBOT_FILE}, which describes a kind of robot, is not among the worlds")


def _model(name: str) -> bytes:
    return _model_file(name).read_bytes()


def _keep(path: Path, content: bytes) -> bool:
    """The file has this content, whole at every moment, because other processes may read or write the same; whether it
    had to be written."""
    with contextlib.suppress(FileNotFoundError):
        if path.read_bytes() == content:
            return False
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=path.name, delete=False) as partial:
        partial.write(content)
    os.chmod(partial.name, 0o644)
    os.replace(partial.name, path)
    return True
