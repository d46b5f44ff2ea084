"""Bodies of a world file's models: polygons in the frame of the body's centre, which is at the model's origin."""

from collections.abc import Sequence
from pathlib import Path

from mr_grid import Pose
from mr_sim.bitmap import load_bitmap, rectangles
from mr_sim.world_file import Block, WorldFileError, find_file
from mr_sim.world_reader import Reader
from mr_sim.world_words import BLOCK_WORDS, BODILESS, DEFAULT_SIZE, DEFAULT_SIZES

Polygon = tuple[tuple[float, float], ...]  # corners [m]

BOUNDARY = 0.01  # m, thickness of the wall around a part of a robot that has a boundary
PADDLE_SIZE = (0.66, 0.1)  # of a gripper, shares of its length and width


def size_of(reader: Reader) -> tuple[float, float]:
    """Length and width in m."""
    return reader.size(DEFAULT_SIZES.get(reader.block.kind, DEFAULT_SIZE))


def bitmap_of(reader: Reader, world: Path) -> Path | None:
    """The picture of a model, None if it has none. Raises WorldFileError if it is not there."""
    name = reader.text("bitmap", "")
    if not name:
        if reader.has("bitmap"):
            raise reader.fail("bitmap", "needs a file name")
        return None
    mentioned_in = Path(reader.block.properties["bitmap"].place.file)
    path = find_file(name, world, mentioned_in)
    if path is None:
        raise reader.fail("bitmap", f'names a file that does not exist: "{mentioned_in.parent / name}"')
    if 0.0 in size_of(reader):
        raise reader.fail("size", "must be positive for a bitmap")
    return path


def polygons_of(reader: Reader) -> tuple[Polygon, ...]:
    """Of a model's blocks, or else of its kind. None of what is in it, nor of its bitmap."""
    blocks = [_block_polygon(child, reader) for child in reader.block.children if child.kind == "block"]
    size = size_of(reader)
    if blocks and 0.0 not in size:
        return _fit(blocks, size, reader.block)
    if reader.block.kind in BODILESS or reader.flag("noblocks", False):
        return ()
    if 0.0 in size:
        return ()
    if reader.block.kind == "gripper":
        return _fit(_gripper_polygons(reader), size, reader.block)
    return (_rectangle(-size[0] / 2.0, -size[1] / 2.0, size[0] / 2.0, size[1] / 2.0),)


def part_polygons(reader: Reader, world: Path) -> tuple[Polygon, ...]:
    """As `polygons_of`, with bitmap and boundary as polygons too: of what moves."""
    bitmap, size = bitmap_of(reader, world), size_of(reader)
    if bitmap is None:
        polygons = polygons_of(reader)
    else:
        corners = [tuple(map(float, rectangle)) for rectangle in rectangles(load_bitmap(bitmap))]
        polygons = _fit([_rectangle(*corner) for corner in corners], size, reader.block)
    bounded = reader.flag("boundary", False) and 0.0 not in size
    return (*polygons, *(_boundary(size) if bounded else ()))


def moved(polygons: Sequence[Polygon], pose: Pose) -> tuple[Polygon, ...]:
    return tuple(tuple(pose.apply_point(x, y) for x, y in polygon) for polygon in polygons)


def _rectangle(left: float, low: float, right: float, high: float) -> Polygon:
    return (left, low), (right, low), (right, high), (left, high)


def _boundary(size: tuple[float, float]) -> tuple[Polygon, ...]:
    x, y, width = size[0] / 2.0, size[1] / 2.0, BOUNDARY
    return (
        _rectangle(-x, -y, -x + width, y), _rectangle(x - width, -y, x, y),
        _rectangle(-x, -y, x, -y + width), _rectangle(-x, y - width, x, y),
    )  # fmt: skip


def _block_polygon(block: Block, owner: Reader) -> Polygon:
    reader = Reader(block, BLOCK_WORDS, owner.context)
    count = int(reader.number("points", 0.0, minimum=3.0))
    points = []
    for index in range(count):
        if not reader.has(f"point[{index}]"):
            raise WorldFileError(block.place, f'"block" lacks point[{index}] of {count} points')
        x, y = reader.numbers(f"point[{index}]", (0.0, 0.0), "ll")
        points.append((x, y))
    return tuple(points)


def _gripper_polygons(reader: Reader) -> list[Polygon]:
    """Base and two paddles in a square of side 1; closed paddles meet in its middle."""
    length, width = reader.numbers("paddle_size", PADDLE_SIZE, "ff")
    if not (0.0 < length < 1.0 and 0.0 < width <= 0.5):
        raise reader.fail(
            "paddle_size", f"must be shares of the gripper, below 1 and up to 0.5, not {length:g} {width:g}"
        )
    state = reader.block.properties.get("paddle_state")
    closed = state is not None and isinstance(state.value, tuple) and "closed" in state.value[:1]
    low = 0.5 - width if closed else 0.0
    base, left = 1.0 - length, _rectangle(1.0 - length, low, 1.0, low + width)
    return [_rectangle(0.0, 0.0, base, 1.0), left, _rectangle(base, 1.0 - low - width, 1.0, 1.0 - low)]


def _fit(polygons: Sequence[Polygon], size: tuple[float, float], block: Block) -> tuple[Polygon, ...]:
    """Stage scales a model's blocks so that their common bounding box fills the model's size."""
    xs = [x for polygon in polygons for x, _ in polygon]
    ys = [y for polygon in polygons for _, y in polygon]
    width, height = max(xs) - min(xs), max(ys) - min(ys)
    if width <= 0.0 or height <= 0.0:
        raise WorldFileError(block.place, '"block" has no area')
    middle_x, middle_y = (max(xs) + min(xs)) / 2.0, (max(ys) + min(ys)) / 2.0
    scale_x, scale_y = size[0] / width, size[1] / height
    return tuple(tuple(((x - middle_x) * scale_x, (y - middle_y) * scale_y) for x, y in p) for p in polygons)
