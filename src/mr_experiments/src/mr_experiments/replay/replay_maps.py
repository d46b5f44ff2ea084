"""Maps of a replay: pictures placed in the world, and since when each of their cells was known.

A record has the final maps and, if asked for, snapshots on the way. Without snapshots the growth of a final map is
reconstructed: a cell becomes known when it came into the view of a robot's true pose between the true walls, but not
sooner than the recorded explored area allows.

Class pictures are gray PNG files: `OCCUPIED`, `UNKNOWN` or `FREE`. Timed pictures hold the class in red and since when
the cell was known, in steps of some seconds, in green (high byte) and blue (low byte). Row 0 of a PNG is the highest y,
row 0 of an array the lowest.
"""

import base64
import binascii
import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import cv2
import numpy as np
from scipy import ndimage

from mr_experiments.replay.replay_data import ReplayError
from mr_grid import IDENTITY, Pose
from mr_measures.map_picture import Picture as StoredPicture
from mr_sim import _world
from mr_sim.bodies import Polygon
from mr_sim.raster import Grid, rasterise
from mr_sim.world_description import RobotDescription
from mr_sim.world_file import WorldFileError
from mr_sim.world_model import load_world
from mr_sim.worlds import WorldNotFoundError, find_world

OCCUPIED, UNKNOWN, FREE = 0, 128, 255  # classes of a cell, as gray values

MAX_CELLS = 600_000  # of a picture; larger ones are made coarser
LATTICE_RESOLUTION = 0.05  # m, of the lattice on which robots look around
EYE_MOVE, EYE_TURN = 0.25, 0.35  # m, rad: after either a robot looks around anew
BEAMS = 360
NEAREST_FIRST = 0.001  # s per m, so that of places seen at once the nearest come first
DEFAULT_RANGE, DEFAULT_VIEW = 30.0, 2.0 * math.pi  # m, rad: of a robot that the world file does not know

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"


@dataclass(frozen=True)
class Eye:
    """The laser of a robot: its place in the robot's frame, range (m) and field of view (rad)."""

    mount: Pose = IDENTITY
    range_max: float = DEFAULT_RANGE
    field_of_view: float = DEFAULT_VIEW


@dataclass(frozen=True)
class Surroundings:
    """What the world file tells: walls that lasers see, and lasers and footprints of the robots by name."""

    walls: Grid
    eyes: dict[str, Eye] = field(default_factory=dict)
    footprints: dict[str, tuple[Polygon, ...]] = field(default_factory=dict)


@dataclass(frozen=True)
class Picture:
    """A map: `classes` uint8 (rows, columns), row 0 at the lowest y; `origin`: lower left corner in the map frame."""

    classes: np.ndarray
    resolution: float
    origin: tuple[float, float]

    def centres(self) -> np.ndarray:
        """Centres (rows * columns, 2) of all cells, row by row, in the map frame."""
        rows, columns = self.classes.shape
        x = self.origin[0] + (np.arange(columns) + 0.5) * self.resolution
        y = self.origin[1] + (np.arange(rows) + 0.5) * self.resolution
        return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


def load_surroundings(world: str) -> Surroundings | None:
    """Walls and robots of a world by name or path; None when there is no such world here or it cannot be read."""
    try:
        description = load_world(find_world(world))
        walls = rasterise([o for o in description.obstacles if o.visible], description.resolution)
    except (WorldNotFoundError, WorldFileError, OSError, ValueError):
        return None
    eyes = {robot.name: _eye(robot) for robot in description.robots}
    return Surroundings(walls, eyes, {robot.name: robot.footprint for robot in description.robots})


def _eye(robot: RobotDescription) -> Eye:
    farthest = max(robot.rangers, key=lambda ranger: ranger.range_max, default=None)
    return Eye() if farthest is None else Eye(farthest.mount, farthest.range_max, farthest.field_of_view)


def decode_map(stored: StoredPicture, where: str) -> Picture:
    """The picture of a map of the record, cut to what is known. Raises ReplayError for one that cannot be read."""
    data = png_bytes(stored, where)
    gray = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), cv2.IMREAD_GRAYSCALE)
    if gray is None:
        raise ReplayError(f'"{where}.png" is no picture: the record is damaged, run the trial again')
    classes = np.full(gray.shape, UNKNOWN, dtype=np.uint8)
    classes[gray < 100] = OCCUPIED
    classes[gray > 230] = FREE
    if not stored.resolution > 0.0:
        raise ReplayError(f'"{where}" lacks a resolution: the record is damaged, run the trial again')
    picture = Picture(np.ascontiguousarray(np.flipud(classes)), stored.resolution, stored.origin)
    return coarser(cropped(picture), MAX_CELLS)


def png_bytes(stored: StoredPicture, where: str) -> bytes:
    """The PNG file of a map of the record. Raises ReplayError when it is none."""
    try:
        data = base64.b64decode(stored.png, validate=True)
    except (binascii.Error, ValueError):
        data = b""
    if not data.startswith(PNG_SIGNATURE) or len(data) < 24:
        raise ReplayError(f'"{where}.png" is no picture: the record is damaged, run the trial again')
    return data


def cropped(picture: Picture) -> Picture:
    """The part of a map that is known; one unknown cell when nothing is."""
    rows, columns = np.nonzero(picture.classes != UNKNOWN)
    if rows.size == 0:
        return Picture(np.full((1, 1), UNKNOWN, dtype=np.uint8), picture.resolution, picture.origin)
    bottom, left = int(rows.min()), int(columns.min())
    part = picture.classes[bottom : rows.max() + 1, left : columns.max() + 1]
    x, y = picture.origin
    return Picture(part, picture.resolution, (x + left * picture.resolution, y + bottom * picture.resolution))


def coarser(picture: Picture, most: int) -> Picture:
    """The map with at most about so many cells: a wall in any cell stays a wall, else free stays free."""
    factor = math.ceil(math.sqrt(picture.classes.size / most))
    if factor <= 1:
        return picture
    rows, columns = picture.classes.shape
    pad = ((0, -rows % factor), (0, -columns % factor))
    blocks = np.pad(picture.classes, pad, constant_values=UNKNOWN)
    blocks = blocks.reshape(blocks.shape[0] // factor, factor, -1, factor)
    lowest, highest = blocks.min(axis=(1, 3)), blocks.max(axis=(1, 3))
    return Picture(np.where(lowest == OCCUPIED, lowest, highest), picture.resolution * factor, picture.origin)


def picture_to_world(pose: Pose, resolution: float, origin: Sequence[float], rows: int) -> list[float]:
    """Six numbers [a, b, c, d, e, f] that place a PNG in the world: the corner at `column`, `row` (row 0 on top) is at
    x = a column + c row + e, y = b column + d row + f, in the order of a canvas' transform.

    `pose`: of the map frame in the world frame; `origin`: lower left corner of the map in the map frame, m.
    """
    cosine, sine = math.cos(pose[2]) * resolution, math.sin(pose[2]) * resolution
    x, y = pose.apply(np.array([[origin[0], origin[1] + rows * resolution]]))[0]
    return [round(float(value), 6) for value in (cosine, sine, sine, -cosine, x, y)]


def corners_in_world(matrix: Sequence[float], rows: int, columns: int) -> np.ndarray:
    """Corners (4, 2) in the world frame of a PNG that `picture_to_world` placed."""
    a, b, c, d, e, f = matrix
    return np.array([(a * u + c * v + e, b * u + d * v + f) for u in (0, columns) for v in (0, rows)])


class Lookout:
    """Since when each place of the world was in a robot's view.

    Args:
        walls: what blocks the view.
    """

    def __init__(self, walls: Grid) -> None:
        rows, columns = walls.cells.shape
        scale = max(1.0, LATTICE_RESOLUTION / walls.resolution, math.sqrt(walls.cells.size / MAX_CELLS))
        self.resolution = walls.resolution * scale
        self.origin = np.asarray(walls.origin, dtype=float)
        self.shape = math.ceil(rows / scale), math.ceil(columns / scale)
        self._raster = _world.Raster(walls.cells, walls.resolution, walls.origin)

    def first_seen(self, series: dict[str, list], eye: Eye) -> np.ndarray:
        """Time float32 (rows, columns) of the lattice at which a robot first saw each cell, infinite where never.

        Args:
            series: "time" and true poses "x", "y", "yaw" in the world frame, lists of one length.
            eye: the robot's laser.
        """
        since = np.full(self.shape, np.inf, dtype=np.float32)
        if "x" not in series:
            return since
        poses = np.array([series["x"], series["y"], series["yaw"]], dtype=float).T
        for index in viewpoints(poses):
            self._look(since, poses[index], eye, float(series["time"][index]))
        return since

    def _look(self, since: np.ndarray, pose: np.ndarray, eye: Eye, time: float) -> None:
        """Lower `since` to `time` in the area in view from a pose; times must come in rising order."""
        place = Pose(pose[0], pose[1], pose[2]).apply(np.array([eye.mount[:2]]))[0]
        half = eye.field_of_view / 2.0
        angles = pose[2] + eye.mount[2] + np.linspace(-half, half, BEAMS)
        ranges = self._raster.cast((place[0], place[1]), angles, eye.range_max)
        ends = place + np.stack([np.cos(angles), np.sin(angles)], axis=1) * ranges[:, None]
        pixels = np.floor((np.vstack([place, ends]) - self.origin) / self.resolution).astype(np.int32)
        low = np.clip(pixels.min(axis=0), 0, self.shape[::-1])
        high = np.clip(pixels.max(axis=0) + 1, 0, self.shape[::-1])
        if (high <= low).any():
            return
        seen = np.zeros((high[1] - low[1], high[0] - low[0]), dtype=np.uint8)
        cv2.fillPoly(seen, [pixels - low.astype(np.int32)], 1)
        window = since[low[1] : high[1], low[0] : high[0]]
        rows, columns = np.nonzero((seen != 0) & np.isinf(window))
        cell = (np.stack([columns, rows], axis=-1) + low + 0.5) * self.resolution + self.origin
        window[rows, columns] = time + NEAREST_FIRST * np.hypot(*(cell - place).T)

    def at(self, lattices: Sequence[np.ndarray], points: np.ndarray) -> list[np.ndarray]:
        """Values (N,) of each lattice at points (N, 2) of the world frame, infinite outside of it."""
        index = np.floor((points - self.origin) / self.resolution).astype(np.int64)
        inside = ((index >= 0) & (index < self.shape[::-1])).all(axis=1)
        cells = index[inside, 1] * self.shape[1] + index[inside, 0]
        result = []
        for lattice in lattices:
            values = np.full(len(points), np.inf, dtype=np.float32)
            values[inside] = lattice.reshape(-1)[cells]
            result.append(values)
        return result

    def picture(self, walls: Grid, since: np.ndarray) -> Picture:
        """A map of what was seen, in the world frame, with the true walls beside it."""
        classes = np.full(self.shape, UNKNOWN, dtype=np.uint8)
        classes[np.isfinite(since)] = FREE
        near = ndimage.binary_dilation(np.isfinite(since), structure=np.ones((3, 3), dtype=bool))
        wall = wall_picture(walls, self.resolution).classes == OCCUPIED
        classes[near & wall] = OCCUPIED
        return Picture(classes, self.resolution, (float(self.origin[0]), float(self.origin[1])))


def viewpoints(poses: np.ndarray) -> list[int]:
    """Numbers of the poses (N, 3) at which the robot had moved or turned enough since the last of them."""
    result: list[int] = []
    last = np.full(3, np.inf)
    for index, pose in enumerate(poses):
        turn = abs(math.remainder(pose[2] - last[2], 2.0 * math.pi)) if result else np.inf
        if not result or turn > EYE_TURN or math.hypot(pose[0] - last[0], pose[1] - last[1]) > EYE_MOVE:
            result.append(index)
            last = pose
    return result


def wall_picture(walls: Grid, resolution: float) -> Picture:
    """The walls on a coarser lattice of the same origin; a cell is wall when any part of it is."""
    rows, columns = (math.ceil(n * walls.resolution / resolution - 1e-6) for n in walls.cells.shape)
    classes = np.full((rows, columns), UNKNOWN, dtype=np.uint8)
    index = np.floor((np.argwhere(walls.cells != 0) + 0.5) * (walls.resolution / resolution)).astype(np.int64)
    classes[np.minimum(index[:, 0], rows - 1), np.minimum(index[:, 1], columns - 1)] = OCCUPIED
    return Picture(classes, resolution, walls.origin)


def walls_of_maps(maps: Sequence[tuple[Picture, Pose]]) -> Grid:
    """Walls in the world frame from maps and the poses of their frames, for records whose world is not at hand."""
    points = [pose.apply(p.centres()[p.classes.reshape(-1) == OCCUPIED]) for p, pose in maps]
    known = np.vstack([pose.apply(p.centres()[p.classes.reshape(-1) != UNKNOWN]) for p, pose in maps])
    low, high = known.min(axis=0) - LATTICE_RESOLUTION, known.max(axis=0) + LATTICE_RESOLUTION
    columns, rows = (int(n) for n in np.ceil((high - low) / LATTICE_RESOLUTION))
    cells = np.zeros((rows, columns), dtype=np.uint8)
    index = np.floor((np.vstack(points) - low) / LATTICE_RESOLUTION).astype(np.int64)
    cells[index[:, 1], index[:, 0]] = 1
    return Grid(cells, LATTICE_RESOLUTION, (float(low[0]), float(low[1])))


def known_since(picture: Picture, views: Sequence[tuple[np.ndarray, float]]) -> np.ndarray:
    """Time (rows, columns) since which each cell of a map was known.

    Args:
        picture: the final map.
        views: per robot the times (rows * columns,) at which it saw the cells, and from when on the owner of the map
            had that robot's map (0 for itself, infinite for never).

    A cell that none of them saw has the time of the nearest one that was seen; all are 0 when nothing was.
    """
    shared = np.min([np.maximum(times, begin) for times, begin in views], axis=0)
    seen = np.min([times for times, _ in views], axis=0)
    since = np.where(np.isfinite(shared), shared, seen).reshape(picture.classes.shape)
    unseen = ~np.isfinite(since)
    if unseen.all():
        return np.zeros(since.shape)
    if unseen.any():
        nearest = ndimage.distance_transform_edt(unseen, return_distances=False, return_indices=True)
        since = since[tuple(nearest)]
    return since


def paced(picture: Picture, since: np.ndarray, time: Sequence[float], area: Sequence[float | None]) -> np.ndarray:
    """`since` (rows, columns), delayed where more free cells would be known than the recorded area tells.

    Args:
        picture: the final map.
        since: of `known_since`.
        time: of the samples of `area`, rising, s.
        area: explored area; only its course matters, not its unit.
    """
    known = [(t, a) for t, a in zip(time, area, strict=True) if a is not None]
    most = max((a for _, a in known), default=0.0)
    order = np.argsort(since, axis=None, kind="stable")
    free = picture.classes.reshape(-1)[order] == FREE
    if not most > 0.0 or not free.any():
        return since
    share = np.maximum.accumulate([a / most for _, a in known])
    allowed = np.searchsorted(share, np.cumsum(free) / free.sum() - 1e-9)
    delayed = since.reshape(-1).copy()
    times = np.array([t for t, _ in known])
    delayed[order] = np.maximum(delayed[order], times[np.minimum(allowed, len(times) - 1)])
    return delayed.reshape(since.shape)


def data_uri(png: bytes) -> str:
    return "data:image/png;base64," + base64.b64encode(png).decode("ascii")


def class_uri(picture: Picture) -> str:
    """The map as a gray PNG."""
    return data_uri(_encode(np.flipud(picture.classes)))


def timed_uri(picture: Picture, since: np.ndarray, step: float) -> str:
    """The map as a timed picture (see the module); `since` (rows, columns) in s, `step`: s per count."""
    counts = np.clip(np.ceil(since / step - 1e-6), 0, 65535).astype(np.uint16)
    counts[picture.classes == UNKNOWN] = 0
    blue_green_red = np.stack([counts & 255, counts >> 8, picture.classes], axis=-1).astype(np.uint8)
    return data_uri(_encode(np.flipud(blue_green_red)))


def _encode(pixels: np.ndarray) -> bytes:
    done, data = cv2.imencode(".png", pixels, [cv2.IMWRITE_PNG_COMPRESSION, 7])
    if not done:
        raise RuntimeError("OpenCV could not write a PNG")
    return data.tobytes()


def snapshot_frame(time: float, stored: StoredPicture, start: Pose, where: str) -> dict[str, Any]:
    """A global map at `time` (s) as "time", "png" (data URI) and "matrix" (see `picture_to_world`)."""
    data = png_bytes(stored, where)
    rows = struct.unpack(">I", data[20:24])[0]
    matrix = picture_to_world(start, stored.resolution, stored.origin, rows)
    return {"time": round(time, 2), "png": data_uri(data), "matrix": matrix}
