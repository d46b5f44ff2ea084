"""Meaning of Stage's world files: the tree of blocks becomes a typed description of walls and robots.

SI units throughout: metres, radians (the files say degrees), seconds (the files say milliseconds).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from mr_grid import IDENTITY, Pose
from mr_sim.bodies import Polygon, bitmap_of, moved, part_polygons, polygons_of, size_of
from mr_sim.world_file import Block, WorldFile, WorldFileError, parse_world_file
from mr_sim.world_reader import Context, PassedOver, Reader, refuse_misspelling, units_of
from mr_sim.world_words import (
    GRIPPER_WORDS,
    MODEL_WORDS,
    PART_WORDS,
    PASSED_OVER_MODELS,
    POSITION_WORDS,
    RANGER_WORDS,
    SENSOR_WORDS,
    WORLD_WORDS,
)

MAX_CELLS = 100_000_000  # of a world
MAX_SAMPLES = 20_000  # beams of a ranger: a sweep must fit into one packet of the world socket
MAX_RANGERS = 255  # sensors of a robot: the world socket numbers them by a byte
DRIVES = ("diff", "omni")

STAGE_FOV = 0.1  # rad, of a sensor that says nothing
SONAR_RANGE = (0.0, 5.0)  # m, of a ring that says nothing


@dataclass(frozen=True)
class RangerDescription:
    """A laser range finder: first and last beam lie at the ends of its field of view, counter-clockwise."""

    mount: Pose  # in the robot's frame
    range_min: float
    range_max: float
    field_of_view: float
    samples: int
    update_interval: float
    noise_variance: float  # m^2; Stage uses the first number of `noise` as a variance
    noise_share: float = 0.0  # of the range: the second number, by which a reading errs at most, evenly spread
    noise_bearing: float = 0.0  # the third in rad: a share of the angle between beams, half of which a beam may err

    @property
    def angle_increment(self) -> float:
        return self.field_of_view / (self.samples - 1) if self.samples > 1 else 0.0

    @property
    def angle_min(self) -> float:
        return -self.field_of_view / 2.0 if self.samples > 1 else 0.0


@dataclass(frozen=True)
class RobotDescription:
    """A `position` model with its rangers."""

    name: str
    start: Pose  # world frame
    footprint: tuple[Polygon, ...]  # robot's frame
    linear_bounds: tuple[float, float]
    lateral_bounds: tuple[float, float]  # to the left; both 0 but for drive "omni"
    angular_bounds: tuple[float, float]
    exact_localization: bool  # localization "gps"
    localization_origin: Pose  # world frame
    odom_error: tuple[float, float, float, float]  # shares along x, y, z and of the turn
    update_interval: float
    visible: bool
    solid: bool
    rangers: tuple[RangerDescription, ...]

    @property
    def main_ranger(self) -> int:
        """Index of the ranger with most beams, the first of them: that by which the robot finds its way."""
        return max(range(len(self.rangers)), key=lambda index: self.rangers[index].samples, default=0)


@dataclass(frozen=True)
class Obstacle:
    """A thing that does not move: polygons or a bitmap, fitted into the rectangle `size` centred at `pose`."""

    pose: Pose  # world frame, of the body's centre
    size: tuple[float, float]
    polygons: tuple[Polygon, ...]  # in the body's frame
    bitmap: Path | None
    boundary: bool
    visible: bool
    solid: bool

    def spans(self, x: float, y: float) -> bool:
        """Whether its rectangle holds that place of the world."""
        x, y = self.pose.inverse().apply_point(x, y)
        return abs(x) <= self.size[0] / 2.0 and abs(y) <= self.size[1] / 2.0


@dataclass(frozen=True)
class WorldDescription:
    """All that a world file says and the simulator uses."""

    path: Path
    resolution: float
    interval: float  # simulated seconds per step
    speedup: float  # real-time factor; <= 0: as fast as possible
    quit_time: float | None  # simulated seconds
    obstacles: tuple[Obstacle, ...]
    robots: tuple[RobotDescription, ...]
    warning: str = ""  # one line: what the file says without effect here


def bounds_of(obstacles: Sequence[Obstacle]) -> tuple[float, float, float, float]:
    """Least x and y, greatest x and y in m."""
    points: list[tuple[float, float]] = [(0.0, 0.0)] if not obstacles else []
    for obstacle in obstacles:
        half_x, half_y = obstacle.size[0] / 2.0, obstacle.size[1] / 2.0
        for corner in ((-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y)):
            points.append(obstacle.pose.apply_point(*corner))
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    return min(xs), min(ys), max(xs), max(ys)


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
                refuse_misspelling(word, entry, block, known)
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
        rangers = self._rangers(block)
        if not rangers and any(child.kind == "camera" for child in block.children):
            raise WorldFileError(
                block.place,
                f'a camera is the only sensor of "{name or unnamed}", and it is not simulated: add a ranger',
            )
        footprint = (*moved(part_polygons(reader, self._world), reader.origin()), *self._parts(block, IDENTITY))
        self.robots.append(
            RobotDescription(
                name=name,
                start=start,
                footprint=footprint,
                linear_bounds=(bounds[0], bounds[1]),
                lateral_bounds=(bounds[2], bounds[3]) if drive == "omni" else (0.0, 0.0),
                angular_bounds=(bounds[6], bounds[7]),
                exact_localization=localization == "gps",
                localization_origin=reader.pose("localization_origin") if reader.has("localization_origin") else start,
                odom_error=(error[0], error[1], error[2], error[3]),
                update_interval=reader.interval("update_interval", 100.0),
                visible=reader.visible() and bool(footprint),
                solid=reader.flag("obstacle_return", True) and bool(footprint),
                rangers=rangers,
            )
        )

    def _parts(self, block: Block, pose: Pose) -> tuple[Polygon, ...]:
        """Bodies, in the robot's frame, of what a robot's model holds at `pose`."""
        polygons: list[Polygon] = []
        for child in block.children:
            if child.kind == "position":
                raise WorldFileError(child.place, f'"{child.word}" inside a position model is not supported')
            if child.kind == "window":
                self._context.passed_over.models.add("window")
            elif child.kind not in ("block", "sensor"):
                reader = self._reader(child, PART_WORDS)
                here = pose.compose(reader.pose())
                if not reader.flag("obstacle_return", True):
                    self._context.passed_over.models.add("part of a robot with obstacle_return 0")
                else:
                    polygons.extend(moved(part_polygons(reader, self._world), here.compose(reader.origin())))
                if any(inner.kind in ("ranger", "laser") for inner in child.children):
                    self._context.passed_over.models.add("ranger that is not mounted on the robot itself")
                polygons.extend(self._parts(child, here))
        return tuple(polygons)

    def _rangers(self, block: Block) -> tuple[RangerDescription, ...]:
        """All sensors of a robot. The first ones of its rangers have the numbers that stageros gives them, the others,
        which it leaves out, follow."""
        models = [_sensors(child, self._context) for child in block.children if child.kind in ("ranger", "laser")]
        rangers = [sensors[0] for sensors in models if sensors]
        rangers += [sensor for sensors in models for sensor in sensors[1:]]
        if len(rangers) > MAX_RANGERS:
            raise WorldFileError(block.place, f"has {len(rangers)} range sensors, more than {MAX_RANGERS}")
        return tuple(rangers)


def _sensors(block: Block, context: Context) -> list[RangerDescription]:
    """One description per `sensor` block; without one, the older words of a sonar ring or of a laser."""
    reader = Reader(block, RANGER_WORDS, context)
    sensors = [child for child in block.children if child.kind == "sensor"]
    if not sensors:
        return _ring(reader) if reader.has("scount") else [_sensor(reader, reader, _mount(reader))]
    context.passed_over.words.update(
        word for word in ("range", "range_min", "range_max", "fov", "samples", "scount") if reader.has(word)
    )
    found = []
    for sensor in sensors:
        for child in sensor.children:
            raise WorldFileError(child.place, f'"{child.word}" inside a sensor is not supported')
        inner = Reader(sensor, SENSOR_WORDS, context)
        found.append(_sensor(inner, reader, _mount(reader).compose(inner.pose())))
    return found


def _mount(ranger: Reader) -> Pose:
    return ranger.pose().compose(ranger.origin())


def _ring(ranger: Reader) -> list[RangerDescription]:
    """Of sonars, as Stage before version 4 has it."""
    count = ranger.number("scount", 0.0, minimum=1.0)
    if count != int(count) or count > MAX_RANGERS:
        raise ranger.fail("scount", f"must be a whole number up to {MAX_RANGERS}, not {count:g}")
    nearest, farthest, view = ranger.numbers("sview", (*SONAR_RANGE, math.pi / count), "lla")
    poses = [ranger.numbers(f"spose[{index}]", (0.0, 0.0, 0.0), "lla") for index in range(int(count))]
    return [_description(ranger, ranger, _mount(ranger).compose(Pose(x, y, yaw)), "sview", (nearest, farthest), view, 1)
            for x, y, yaw in poses]  # fmt: skip


def _sensor(reader: Reader, ranger: Reader, mount: Pose) -> RangerDescription:
    nearest, farthest = reader.numbers("range", (0.0, 5.0), "ll")
    nearest = reader.length("range_min", nearest, minimum=0.0)
    farthest = reader.length("range_max", farthest)
    view = reader.numbers("fov", (STAGE_FOV,), "a")[0]
    samples = reader.number("samples", 1.0, minimum=1.0)
    if samples != int(samples) or samples > MAX_SAMPLES:
        raise reader.fail("samples", f"must be a whole number up to {MAX_SAMPLES}, not {samples:g}")
    word = "range" if reader.has("range") else "range_max"
    return _description(reader, ranger, mount, word, (nearest, farthest), view, int(samples))


def _description(
    reader: Reader, ranger: Reader, mount: Pose, range_word: str, limits: tuple[float, float], view: float, samples: int
) -> RangerDescription:
    """`limits` of the range in m; `view` in rad."""
    if limits[0] < 0.0 or limits[1] <= limits[0]:
        bounds = f"{limits[0]:g} to {limits[1]:g}"
        raise reader.fail(range_word, f"must go from a minimum >= 0 to a larger maximum, not {bounds}")
    if not (0.0 < view <= 2.0 * math.pi + 1e-9 or (view == 0.0 and samples == 1)):
        raise reader.fail("fov", f"must be above 0 and at most 360 degrees, not {math.degrees(view):g}")
    noisy = reader if reader.has("noise") else ranger
    noise = noisy.numbers("noise", (0.0, 0.0, 0.0), "lfa")
    if min(noise) < 0.0:
        raise noisy.fail("noise", "must not be negative")
    if noise[1] > 1.0:
        raise noisy.fail("noise", f"has a second number that is a share of the range, at most 1, not {noise[1]:g}")
    return RangerDescription(
        mount=mount,
        range_min=limits[0],
        range_max=limits[1],
        field_of_view=view,
        samples=samples,
        update_interval=ranger.interval("update_interval", 100.0),
        noise_variance=noise[0],
        noise_share=noise[1],
        noise_bearing=noise[2],
    )


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
    fitting = _fitting_resolution(builder.obstacles, resolution)
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


def _fitting_resolution(obstacles: Sequence[Obstacle], resolution: float) -> float:
    """m; a coarser one where the world would have more than MAX_CELLS, in tenths of its order of magnitude."""
    left, low, right, high = bounds_of(obstacles)
    area = (right - left) * (high - low)
    if not math.isfinite(area) or area <= 0.8 * MAX_CELLS * resolution**2:
        return resolution
    least = math.sqrt(area / (0.8 * MAX_CELLS))
    unit = 10.0 ** (math.floor(math.log10(least)) - 1)
    return round(math.ceil(least / unit) * unit, 9)
