"""Meaning of Stage's world files: the tree of blocks becomes a typed description of walls and robots.

SI units throughout: metres, radians (the files say degrees), seconds (the files say milliseconds).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from mr_grid import IDENTITY, Pose
from mr_sim.bodies import Polygon, bitmap_of, moved, part_polygons, polygons_of, size_of
from mr_sim.world_description import (
    Obstacle,
    RangerDescription,
    RobotDescription,
    WorldDescription,
    bounds_of,
    fitting_resolution,
)
from mr_sim.world_file import Block, WorldFile, WorldFileError, parse_world_file
from mr_sim.world_rangers import MAX_RANGERS, sensors_of
from mr_sim.world_reader import Context, PassedOver, Reader, refuse_misspelling, units_of
from mr_sim.world_words import (
    GRIPPER_WORDS,
    MODEL_WORDS,
    PASSED_OVER_MODELS,
    POSITION_WORDS,
    RANGER_WORDS,
    WORLD_WORDS,
    words_of,
)

DRIVES = ("diff", "omni")
FARTHEST = 1.0e6  # m from the origin that a world may reach
LARGEST_ERROR = 100.0  # of odometry: as a share of the way, m or rad


@dataclass(frozen=True)
class _Part:
    """Of a robot's body: its model's own, or that of a model in it. `polygons`: in the robot's frame."""

    polygons: tuple[Polygon, ...]
    visible: bool
    ranger_return: float


class _Builder:
    """Walks the tree and collects obstacles and robots."""

    def __init__(self, file: WorldFile, context: Context) -> None:
        self.obstacles: list[Obstacle] = []
        self.robots: list[RobotDescription] = []
        self._world = file.path
        self._context = context

    def add(self, block: Block, parent: Pose) -> None:
        """A block that stands in the world or in a model that does not move."""
        if block.kind == "position":
            self._add_robot(block, parent)
        elif block.kind in ("sensor", "block"):
            raise WorldFileError(block.place, f'"{block.word}" cannot stand here')
        elif block.kind == "window":
            self._context.passed_over.models.add("window")
        else:
            self._add_model(block, parent)

    def _reader(self, block: Block, words: frozenset) -> Reader:
        """Of a model; notes one that does nothing here."""
        if block.kind in PASSED_OVER_MODELS:
            self._context.passed_over.models.add(block.kind)
            known = words | (GRIPPER_WORDS if block.kind == "gripper" else frozenset())
            # What else such a model says is passed over with it.
            for word, entry in block.properties.items():
                refuse_misspelling(word, entry, block, known | words_of(block.kind))
            properties = {word: entry for word, entry in block.properties.items() if word in known}
            block = Block(block.kind, block.word, block.place, properties, block.children)
            return Reader(block, known, self._context)
        return Reader(block, words | RANGER_WORDS if block.kind in ("ranger", "laser") else words, self._context)

    def _add_model(self, block: Block, parent: Pose) -> None:
        if block.kind in ("ranger", "laser"):
            self._context.passed_over.models.add(f"{block.kind} that no robot carries")
        reader = self._reader(block, MODEL_WORDS)
        pose = parent.compose(reader.pose())
        bitmap = bitmap_of(reader, self._world)
        polygons = () if bitmap else polygons_of(reader)
        if bitmap and any(child.kind == "block" for child in block.children):
            self._context.passed_over.models.add("block beside a bitmap")
        boundary = reader.flag("boundary", False) and 0.0 not in size_of(reader)
        if bitmap or polygons or boundary:
            self.obstacles.append(
                Obstacle(
                    pose=pose.compose(reader.origin()),
                    size=size_of(reader),
                    polygons=polygons,
                    bitmap=bitmap,
                    boundary=boundary,
                    visible=reader.visible(),
                    solid=reader.flag("obstacle_return", True),
                    ranger_return=reader.ranger_return(),
                )
            )
        for child in block.children:
            if child.kind not in ("block", "sensor"):
                self.add(child, pose)

    def _add_robot(self, block: Block, parent: Pose) -> None:
        reader = Reader(block, POSITION_WORDS, self._context)
        drive = reader.text("drive", "diff", DRIVES)
        localization = reader.text("localization", "gps", ("gps", "odom"))
        name, unnamed = reader.text("name", ""), f"robot_{len(self.robots)}"
        if name and any(robot.name == name for robot in self.robots):
            raise reader.fail("name", f'"{name}" is used by two robots')
        start = parent.compose(reader.pose())
        quarter = math.pi / 2.0
        bounds = reader.numbers("velocity_bounds", (-1, 1, -1, 1, -1, 1, -quarter, quarter), "llllllaa")
        if any(low > high for low, high in zip(bounds[::2], bounds[1::2], strict=True)):
            raise reader.fail("velocity_bounds", "has a minimum above its maximum")
        error = reader.numbers("odom_error", (0.03, 0.03, 0.0, 0.05), "ffff")
        if min(error) < 0.0:
            raise reader.fail("odom_error", "must not be negative")
        if max(error) > LARGEST_ERROR:
            raise reader.fail("odom_error", f"has shares of the way, at most {LARGEST_ERROR:g}, not {max(error):g}")
        rangers = self._rangers(block)
        if not rangers and _carries(block, "camera"):
            raise WorldFileError(
                block.place,
                f'a camera is the only sensor of "{name or unnamed}", and it is not simulated: add a ranger',
            )
        parts = self._parts(block, IDENTITY)
        body = _part(reader, moved(part_polygons(reader, self._world), reader.origin()))
        solid = reader.flag("obstacle_return", True)
        if not solid and any(part.polygons for part in parts):
            self._context.passed_over.models.add("body with obstacle_return 0 of a robot that has parts")
            body, solid = _part(reader, ()), True
        parts = [body, *parts]
        footprint = tuple(polygon for part in parts for polygon in part.polygons)
        seen = [(polygon, part.ranger_return) for part in parts if part.visible for polygon in part.polygons]
        self.robots.append(
            RobotDescription(
                name=name,
                start=start,
                footprint=footprint,
                seen=tuple(polygon for polygon, _ in seen),
                ranger_returns=tuple(ranger_return for _, ranger_return in seen),
                linear_bounds=(bounds[0], bounds[1]),
                lateral_bounds=(bounds[2], bounds[3]) if drive == "omni" else (0.0, 0.0),
                angular_bounds=(bounds[6], bounds[7]),
                exact_localization=localization == "gps",
                localization_origin=reader.pose("localization_origin") if reader.has("localization_origin") else start,
                odom_error=(error[0], error[1], error[2], error[3]),
                update_interval=reader.interval("update_interval", 100.0),
                solid=solid and bool(footprint),
                rangers=rangers,
            )
        )

    def _parts(self, block: Block, pose: Pose) -> list["_Part"]:
        """Bodies of what a robot's model holds at `pose`."""
        parts: list[_Part] = []
        for child in block.children:
            if child.kind == "position":
                raise WorldFileError(child.place, f'"{child.word}" inside a position model is not supported')
            if child.kind == "window":
                self._context.passed_over.models.add("window")
            elif child.kind not in ("block", "sensor"):
                reader = self._reader(child, MODEL_WORDS)
                here = pose.compose(reader.pose())
                if not reader.flag("obstacle_return", True):
                    self._context.passed_over.models.add("part of a robot with obstacle_return 0")
                else:
                    body = moved(part_polygons(reader, self._world), here.compose(reader.origin()))
                    parts.append(_part(reader, body))
                if any(inner.kind in ("ranger", "laser") for inner in child.children):
                    self._context.passed_over.models.add("ranger that is not mounted on the robot itself")
                parts.extend(self._parts(child, here))
        return parts

    def _rangers(self, block: Block) -> tuple[RangerDescription, ...]:
        """All sensors of a robot. The first ones of its rangers have the numbers that stageros gives them, the others,
        which it leaves out, follow."""
        models = [sensors_of(child, self._context) for child in block.children if child.kind in ("ranger", "laser")]
        rangers = [sensors[0] for sensors in models if sensors]
        rangers += [sensor for sensors in models for sensor in sensors[1:]]
        if len(rangers) > MAX_RANGERS:
            raise WorldFileError(block.place, f"has {len(rangers)} range sensors, more than {MAX_RANGERS}")
        return tuple(rangers)


def load_world(path: str | Path) -> WorldDescription:
    """Read a world file. Raises WorldFileError with file, line and word."""
    file = parse_world_file(path)
    passed_over = PassedOver(remarks=[f"{remark.place}: {remark.text}" for remark in file.remarks])
    context = Context(*units_of(file.root), passed_over)
    reader = Reader(file.root, WORLD_WORDS, context)
    builder = _Builder(file, context)
    for block in file.root.children:
        builder.add(block, IDENTITY)
    quit_time = reader.number("quit_time", 0.0, minimum=0.0)
    resolution = reader.number("resolution", 0.02, above=0.0)
    _check_extent(file, builder.obstacles)
    _check_robots(file, builder.robots)
    fitting = fitting_resolution(builder.obstacles, resolution)
    if fitting > resolution:
        place = file.root.properties["resolution"].place if reader.has("resolution") else file.root.place
        passed_over.remarks.append(f"{place}: resolution {resolution:g} makes too many cells, {fitting:g} is used")
    return WorldDescription(
        path=Path(path),
        resolution=fitting,
        interval=reader.interval("interval_sim", 100.0),
        speedup=reader.number("speedup", 1.0),
        quit_time=quit_time or None,
        obstacles=tuple(builder.obstacles),
        robots=_named(builder.robots),
        warning=passed_over.text(),
    )


def _part(reader: Reader, polygons: tuple[Polygon, ...]) -> _Part:
    return _Part(polygons, reader.visible(), reader.ranger_return())


def _carries(block: Block, kind: str) -> bool:
    """Whether a model has one of that kind, or one of its parts does."""
    return any(child.kind == kind or _carries(child, kind) for child in block.children)


def _check_extent(file: WorldFile, obstacles: Sequence[Obstacle]) -> None:
    bounds = bounds_of(obstacles)
    if not all(abs(bound) <= FARTHEST for bound in bounds):
        farthest = max(map(abs, bounds))
        raise WorldFileError(
            str(file.path),
            f"a model reaches {farthest:g} m from the origin, more than {FARTHEST:g} m: correct its pose or size",
        )


def _check_robots(file: WorldFile, robots: Sequence[RobotDescription]) -> None:
    for index, robot in enumerate(robots):
        size = max((math.hypot(*corner) for polygon in robot.footprint for corner in polygon), default=0.0)
        farthest = size + max(abs(robot.start.x), abs(robot.start.y))
        if not farthest <= FARTHEST:
            raise WorldFileError(
                str(file.path),
                f'robot "{robot.name or f"robot_{index}"}" reaches {farthest:g} m from the origin, more than '
                f"{FARTHEST:g} m: correct its pose or size",
            )


def _named(robots: Sequence[RobotDescription]) -> tuple[RobotDescription, ...]:
    """Those without a name by their place in the file, or the next one that is free."""
    taken, named = {robot.name for robot in robots}, []
    for index, robot in enumerate(robots):
        number = index
        while not robot.name and f"robot_{number}" in taken:
            number += 1
        named.append(robot if robot.name else replace(robot, name=f"robot_{number}"))
        taken.add(named[-1].name)
    return tuple(named)
