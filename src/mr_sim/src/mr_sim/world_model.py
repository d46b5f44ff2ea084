"""Meaning of Stage's world files: the tree of blocks becomes a typed description of walls and robots.

SI units throughout: metres, radians (the files say degrees), seconds (the files say milliseconds).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mr_sim.pose import Pose, compose
from mr_sim.world_file import Block, Property, WorldFileError, parse_world_file

Polygon = tuple[tuple[float, float], ...]  # corners [m]

# Words with an effect, by kind of block.
WORLD_WORDS = frozenset({"resolution", "interval_sim", "speedup", "quit_time", "name"})
MODEL_WORDS = frozenset(
    {"name", "pose", "size", "origin", "bitmap", "boundary", "obstacle_return", "ranger_return", "laser_return"}
)
PART_WORDS = MODEL_WORDS - {"bitmap", "boundary"}  # of a model that is part of a robot's body
POSITION_WORDS = PART_WORDS | {
    "drive", "localization", "localization_origin", "odom_error", "velocity_bounds", "update_interval",
}  # fmt: skip
RANGER_WORDS = frozenset(
    {"name", "pose", "size", "origin", "update_interval", "noise", "range", "range_min", "range_max", "fov", "samples"}
)
SENSOR_WORDS = frozenset({"pose", "range", "fov", "samples", "noise"})

# Words of Stage that change its window, its speed or sensors that are not simulated: accepted without effect.
# acceleration_bounds is among them because Stage, too, heeds it only under acceleration control, which ROS never uses.
IGNORED_WORDS = frozenset(
    {
        "color", "color_rgba", "gui_nose", "gui_grid", "gui_movemask", "gui_outline", "gui_move", "alwayson",
        "show_clock", "show_clock_interval", "threads", "interval_real", "paused", "watts", "joules", "joules_capacity",
        "mass", "friction", "map_resolution", "stack_children", "fiducial_return", "fiducial_key", "blob_return",
        "gripper_return", "gravity_return", "acceleration_bounds", "wheelbase", "trail_length", "trail_interval",
        "background", "event_queues", "ppm",
    }
)  # fmt: skip
IGNORED_KINDS = frozenset({"window", "camera"})

OCCUPIED_BELOW = 128  # grey level of a bitmap's pixel under which it is wall
MAX_SAMPLES = 20_000  # beams of a ranger: a sweep must fit into one packet of the world socket


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
    angular_bounds: tuple[float, float]
    exact_localization: bool  # localization "gps"
    localization_origin: Pose  # world frame
    odom_error: tuple[float, float, float, float]  # shares along x, y, z and of the turn
    update_interval: float
    visible: bool
    solid: bool
    rangers: tuple[RangerDescription, ...]


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


class _Reader:
    """Typed access to the properties of one block; knows which words the block may have."""

    def __init__(self, block: Block, words: frozenset) -> None:
        for word, entry in block.properties.items():
            if word not in words and word not in IGNORED_WORDS:
                raise WorldFileError(entry.place, f'unknown word "{word}" in "{block.word}"')
        self.block = block

    def _entry(self, word: str) -> Property | None:
        return self.block.properties.get(word)

    def fail(self, word: str, message: str) -> WorldFileError:
        entry = self._entry(word)
        return WorldFileError(entry.place if entry else self.block.place, f'"{word}" {message}')

    def has(self, word: str) -> bool:
        return word in self.block.properties

    def text(self, word: str, default: str) -> str:
        entry = self._entry(word)
        if entry is None:
            return default
        if not isinstance(entry.value, str):
            raise self.fail(word, "needs a string in quotes")
        return entry.value

    def number(self, word: str, default: float, minimum: float = -math.inf, above: float = -math.inf) -> float:
        entry = self._entry(word)
        value = default if entry is None else entry.value
        if not isinstance(value, (int, float)):
            raise self.fail(word, "needs a number")
        if value < minimum or value <= above:
            bound = f"at least {minimum:g}" if value < minimum else f"greater than {above:g}"
            raise self.fail(word, f"must be {bound}, not {value:g}")
        return float(value)

    def numbers(self, word: str, default: Sequence[float]) -> tuple[float, ...]:
        """A tuple with exactly as many numbers as `default`."""
        entry = self._entry(word)
        if entry is None:
            return tuple(default)
        values = entry.value if isinstance(entry.value, tuple) else (entry.value,)
        if len(values) != len(default) or any(isinstance(value, str) for value in values):
            raise self.fail(word, f"needs {len(default)} numbers in [ ]")
        return tuple(float(value) for value in values)

    def flag(self, word: str, default: bool) -> bool:
        return self.number(word, float(default)) != 0.0

    def pose(self, word: str = "pose") -> Pose:
        x, y, _, degrees = self.numbers(word, (0.0, 0.0, 0.0, 0.0))
        return x, y, math.radians(degrees)

    def size(self, default: Sequence[float] = (0.1, 0.1, 0.1)) -> tuple[float, float]:
        x, y, _ = self.numbers("size", default)
        if x <= 0.0 or y <= 0.0:
            raise self.fail("size", "must be positive")
        return x, y

    def visible(self) -> bool:
        """Whether lasers see the model: Stage 4 hides at negative `ranger_return`, Stage 3 at `laser_return` 0."""
        return self.number("ranger_return", 1.0) >= 0.0 and self.flag("laser_return", True)

    def interval(self, word: str, default: float) -> float:
        return self.number(word, default, above=0.0) / 1000.0


def _rectangle(size: tuple[float, float]) -> Polygon:
    x, y = size[0] / 2.0, size[1] / 2.0
    return (-x, -y), (x, -y), (x, y), (-x, y)


def _block_polygon(block: Block) -> Polygon:
    count_reader = _Reader(block, frozenset({"points", "z", *(w for w in block.properties if w.startswith("point["))}))
    count = int(count_reader.number("points", 0.0, minimum=3.0))
    points = []
    for index in range(count):
        if not count_reader.has(f"point[{index}]"):
            raise WorldFileError(block.place, f'"block" lacks point[{index}] of {count} points')
        x, y = count_reader.numbers(f"point[{index}]", (0.0, 0.0))
        points.append((x, y))
    return tuple(points)


def _fit(polygons: Sequence[Polygon], size: tuple[float, float], place: object) -> tuple[Polygon, ...]:
    """Stage scales a model's blocks so that their common bounding box fills the model's size."""
    xs = [x for polygon in polygons for x, _ in polygon]
    ys = [y for polygon in polygons for _, y in polygon]
    width, height = max(xs) - min(xs), max(ys) - min(ys)
    if width <= 0.0 or height <= 0.0:
        raise WorldFileError(str(place), '"block" has no area')
    middle_x, middle_y = (max(xs) + min(xs)) / 2.0, (max(ys) + min(ys)) / 2.0
    scale_x, scale_y = size[0] / width, size[1] / height
    return tuple(tuple(((x - middle_x) * scale_x, (y - middle_y) * scale_y) for x, y in p) for p in polygons)


def _body(reader: _Reader, size: tuple[float, float]) -> tuple[Polygon, ...]:
    """Polygons of a model in the frame of its body's centre."""
    blocks = [_block_polygon(child) for child in reader.block.children if child.kind == "block"]
    return _fit(blocks, size, reader.block.place) if blocks else (_rectangle(size),)


def _move(polygons: Sequence[Polygon], pose: Pose) -> tuple[Polygon, ...]:
    return tuple(tuple(compose(pose, (x, y, 0.0))[:2] for x, y in polygon) for polygon in polygons)


class _Builder:
    """Walks the tree and collects obstacles and robots."""

    def __init__(self) -> None:
        self.obstacles: list[Obstacle] = []
        self.robots: list[RobotDescription] = []

    def add(self, block: Block, parent: Pose) -> None:
        if block.kind == "position":
            self._add_robot(block, parent)
        elif block.kind == "model":
            self._add_model(block, parent)
        elif block.kind not in IGNORED_KINDS:
            raise WorldFileError(block.place, f'"{block.word}" cannot stand here')

    def _add_model(self, block: Block, parent: Pose) -> None:
        reader = _Reader(block, MODEL_WORDS)
        pose = compose(parent, reader.pose())
        size = reader.size()
        bitmap = self._bitmap(reader)
        self.obstacles.append(
            Obstacle(
                pose=compose(pose, reader.pose("origin")),
                size=size,
                polygons=() if bitmap else _body(reader, size),
                bitmap=bitmap,
                boundary=reader.flag("boundary", False),
                visible=reader.visible(),
                solid=reader.flag("obstacle_return", True),
            )
        )
        for child in block.children:
            if child.kind != "block":
                self.add(child, pose)

    @staticmethod
    def _bitmap(reader: _Reader) -> Path | None:
        name = reader.text("bitmap", "")
        if not name:
            if reader.has("bitmap"):
                raise reader.fail("bitmap", "needs a file name")
            return None
        path = Path(reader.block.properties["bitmap"].place.file).parent / name
        if not path.is_file():
            raise reader.fail("bitmap", f'names a file that does not exist: "{path}"')
        return path

    def _add_robot(self, block: Block, parent: Pose) -> None:
        reader = _Reader(block, POSITION_WORDS)
        if reader.text("drive", "diff") != "diff":
            raise reader.fail("drive", f'"{reader.text("drive", "")}" is not supported, only "diff"')
        localization = reader.text("localization", "gps")
        if localization not in ("gps", "odom"):
            raise reader.fail("localization", f'must be "gps" or "odom", not "{localization}"')
        name = reader.text("name", f"robot_{len(self.robots)}")
        if any(robot.name == name for robot in self.robots):
            raise reader.fail("name", f'"{name}" is used by two robots')
        start = compose(parent, reader.pose())
        bounds = reader.numbers("velocity_bounds", (-1, 1, -1, 1, -1, 1, -90, 90))
        if any(low > high for low, high in zip(bounds[::2], bounds[1::2], strict=True)):
            raise reader.fail("velocity_bounds", "has a minimum above its maximum")
        error = reader.numbers("odom_error", (0.03, 0.03, 0.0, 0.05))
        self.robots.append(
            RobotDescription(
                name=name,
                start=start,
                footprint=self._footprint(reader),
                linear_bounds=(bounds[0], bounds[1]),
                angular_bounds=(math.radians(bounds[6]), math.radians(bounds[7])),
                exact_localization=localization == "gps",
                localization_origin=reader.pose("localization_origin") if reader.has("localization_origin") else start,
                odom_error=(error[0], error[1], error[2], error[3]),
                update_interval=reader.interval("update_interval", 100.0),
                visible=reader.visible(),
                solid=reader.flag("obstacle_return", True),
                rangers=tuple(ranger for child in block.children for ranger in _rangers(child)),
            )
        )

    @staticmethod
    def _footprint(reader: _Reader) -> tuple[Polygon, ...]:
        size = reader.size((0.4, 0.4, 0.4))
        footprint = list(_move(_body(reader, size), reader.pose("origin")))
        for child in reader.block.children:
            if child.kind == "model":
                part = _Reader(child, PART_WORDS)
                _refuse_children(child, "a part of a robot's body")
                if part.flag("obstacle_return", True):
                    footprint.extend(_move(_body(part, part.size()), compose(part.pose(), part.pose("origin"))))
            elif child.kind not in ("block", "ranger", "laser", *IGNORED_KINDS):
                raise WorldFileError(child.place, f'"{child.word}" inside a position model is not supported')
        return tuple(footprint)


def _refuse_children(block: Block, where: str, known: Sequence[str] = ()) -> None:
    """A block that would have no effect is a mistake that its author should hear of."""
    for child in block.children:
        if child.kind not in ("block", *known, *IGNORED_KINDS):
            raise WorldFileError(child.place, f'"{child.word}" inside {where} is not supported')


def _rangers(block: Block) -> list[RangerDescription]:
    """One description per `sensor` block; without one, Stage's older words in the ranger itself.

    Blocks of other kinds have none.
    """
    if block.kind not in ("ranger", "laser"):
        return []
    reader = _Reader(block, RANGER_WORDS)
    sensors = [child for child in block.children if child.kind == "sensor"]
    _refuse_children(block, "a ranger", ("sensor",))
    for sensor in sensors:
        _refuse_children(sensor, "a sensor")
    if not sensors:
        return [_sensor(reader, reader, reader.pose())]
    for word in ("range", "range_min", "range_max", "fov", "samples"):
        if reader.has(word):
            raise reader.fail(word, "stands outside the sensor block")
    return [_sensor(inner, reader, compose(reader.pose(), inner.pose())) for inner in
            (_Reader(child, SENSOR_WORDS | {"size"}) for child in sensors)]  # fmt: skip


def _sensor(reader: _Reader, ranger: _Reader, mount: Pose) -> RangerDescription:
    range_min, range_max = reader.numbers("range", (0.0, 5.0))
    range_word = "range" if reader.has("range") else "range_max"
    range_min = reader.number("range_min", range_min, minimum=0.0)
    range_max = reader.number("range_max", range_max)
    if range_min < 0.0 or range_max <= range_min:
        bounds = f"{range_min:g} to {range_max:g}"
        raise reader.fail(range_word, f"must go from a minimum >= 0 to a larger maximum, not {bounds}")
    samples = reader.number("samples", 1.0, minimum=1.0)
    if samples != int(samples) or samples > MAX_SAMPLES:
        raise reader.fail("samples", f"must be a whole number up to {MAX_SAMPLES}, not {samples:g}")
    field_of_view = reader.number("fov", math.degrees(0.1), above=0.0)
    if field_of_view > 360.0:
        raise reader.fail("fov", f"must be at most 360 degrees, not {field_of_view:g}")
    noisy = reader if reader.has("noise") else ranger
    noise = noisy.numbers("noise", (0.0, 0.0, 0.0))
    if min(noise) < 0.0:
        raise noisy.fail("noise", "must not be negative")
    if noise[1] > 1.0:
        raise noisy.fail("noise", f"has a second number that is a share of the range, at most 1, not {noise[1]:g}")
    if noise[2]:
        raise noisy.fail("noise", "knows no error of the bearing: its third number must be 0")
    return RangerDescription(
        mount=mount,
        range_min=range_min,
        range_max=range_max,
        field_of_view=math.radians(field_of_view),
        samples=int(samples),
        update_interval=ranger.interval("update_interval", 100.0),
        noise_variance=noise[0],
        noise_share=noise[1],
    )


def load_world(path: str | Path) -> WorldDescription:
    """Read a world file. Raises WorldFileError with file, line and word."""
    root = parse_world_file(path)
    reader = _Reader(root, WORLD_WORDS)
    builder = _Builder()
    for block in root.children:
        builder.add(block, (0.0, 0.0, 0.0))
    return WorldDescription(
        path=Path(path),
        resolution=reader.number("resolution", 0.02, above=0.0),
        interval=reader.interval("interval_sim", 100.0),
        speedup=reader.number("speedup", 1.0),
        quit_time=reader.number("quit_time", 0.0, above=0.0) if reader.has("quit_time") else None,
        obstacles=tuple(builder.obstacles),
        robots=tuple(builder.robots),
    )
