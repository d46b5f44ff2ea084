"""Maps as files in the format of map_server: a picture (.pgm or .png) and a .yaml file that describes it.

The first row of a picture is the one with the highest y. Everything in a file is checked before it is used.
"""

import math
import os
import re
import zlib
from typing import Any, Mapping, NamedTuple, Optional, Tuple

import numpy as np
import yaml  # type: ignore[import-untyped]

from mr_grid.grid import MAX_CELLS, OCCUPIED, UNKNOWN, GridError, GridInfo, OccupancyGrid
from mr_grid.pose import FARTHEST, Pose

OBSTACLE_GREY, FREE_GREY, UNKNOWN_GREY = 0, 254, 205
OCCUPIED_FROM = 50  # value from which on a cell is drawn as obstacle unless the caller says otherwise, free below it
MOST_YAML_BYTES = 100_000
MOST_PICTURE_BYTES = 5 * MAX_CELLS
"""The largest map as text (P2): three digits and a space per cell, and the header."""
MODES = ("trinary", "scale", "raw")
_PGM_HEADER = re.compile(rb"P[25](?:\s|#[^\n]*\n)+(\d{1,9})(?:\s|#[^\n]*\n)+(\d{1,9})(?:\s|#[^\n]*\n)+(\d{1,9})\s")
_PNG_START = b"\x89PNG\r\n\x1a\n"


class MapFileError(ValueError):
    """A file that cannot be used; the text is one line that names the file and the problem."""


class Description(NamedTuple):
    """What the .yaml file says. resolution in m per cell, origin: pose (m, rad) of the lower left corner, thresholds as
    probability."""

    image: str
    resolution: float
    origin: Pose
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str


def read_map(path: str) -> OccupancyGrid:
    """The map that a .yaml file describes. MapFileError names the file and what is wrong with it."""
    description = _description(path)
    picture = os.path.join(os.path.dirname(path), description.image)
    pixels = _pixels(picture)
    try:
        info = GridInfo(pixels.shape[1], pixels.shape[0], description.resolution, description.origin)
    except GridError as error:
        raise MapFileError(f"{path}: {error}") from error
    return OccupancyGrid(info, np.ascontiguousarray(cells_of_picture(pixels, description)[::-1]))


def write_map(
    stem: str, grid: OccupancyGrid, free_below: int = OCCUPIED_FROM, occupied_from: int = OCCUPIED_FROM
) -> Tuple[str, str]:
    """Writes `stem`.pgm and `stem`.yaml and returns both paths; OSError if that is not possible.

    Cells from `free_below` on and below `occupied_from` are written as unknown. Each file appears complete or not at
    all; the picture comes first.
    """
    picture, text = stem + ".pgm", stem + ".yaml"
    _write(picture, pgm_of(image_of(grid, free_below, occupied_from), grid.resolution))
    _write(text, yaml_of(grid, os.path.basename(picture)).encode())
    return picture, text


def save_map(path: str, grid: Optional[OccupancyGrid]) -> Tuple[str, str]:
    """`write_map` for people: absolute paths of the files. MapFileError if there is no map or it cannot be written."""
    if not path or path.endswith(os.sep) or "\0" in path:
        raise MapFileError(f"path must be that of a file without extension, not {path!r:.200}")
    if grid is None:
        raise MapFileError("there is no map yet")
    stem = os.path.abspath(os.path.expanduser(path))
    try:
        return write_map(stem, grid)
    except OSError as error:
        raise MapFileError(f"{stem} not written: {error.strerror or error}") from error


def image_of(grid: OccupancyGrid, free_below: int = OCCUPIED_FROM, occupied_from: int = OCCUPIED_FROM) -> np.ndarray:
    """Grey image, uint8, with map_server's three values: free 254, obstacle 0, unknown or in between 205; row r of the
    image is row r of the grid."""
    image = np.full(grid.info.shape, UNKNOWN_GREY, np.uint8)
    image[(grid.cells >= 0) & (grid.cells < free_below)] = FREE_GREY
    image[grid.cells >= occupied_from] = OBSTACLE_GREY
    return image


def pgm_of(image: np.ndarray, resolution: float) -> bytes:
    """An image of `image_of` as binary PGM, the highest row first."""
    rows, columns = image.shape
    return f"P5\n# {resolution:.6g} m per pixel\n{columns} {rows}\n255\n".encode() + image[::-1].tobytes()


def yaml_of(grid: OccupancyGrid, image: str) -> str:
    """The description that belongs to `pgm_of`."""
    origin = grid.info.origin
    return (
        f"image: {yaml.safe_dump(image, width=math.inf).splitlines()[0]}\n"
        f"resolution: {grid.info.resolution:.9f}\n"
        f"origin: [{origin.x:.9f}, {origin.y:.9f}, {origin.yaw:.9f}]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )


def cells_of_picture(pixels: np.ndarray, description: Description) -> np.ndarray:
    """Cells (int8, -1 unknown, 0 free .. 100 occupied) of pixels (uint8, (rows, columns) or with colours), by the rules
    of map_server; transparent pixels are unknown, and so are values above 100 in mode raw."""
    grey, transparent = _grey(pixels)
    values = np.arange(256)
    bright = 255 - values if description.negate else values
    table = _table(bright, description)
    # Colours have averages between the values of the table.
    cells = table[np.round(grey).astype(np.uint8)]
    cells[transparent] = UNKNOWN
    return cells


def _table(bright: np.ndarray, description: Description) -> np.ndarray:
    """Cell for each value of a pixel, given how bright it is."""
    if description.mode == "raw":
        return np.where(bright <= OCCUPIED, bright, UNKNOWN).astype(np.int8)
    occupancy = (255 - bright) / 255.0
    low, high = description.free_thresh, description.occupied_thresh
    between = 99.0 * (occupancy - low) / (high - low) if description.mode == "scale" else np.full(256, UNKNOWN)
    return np.select([occupancy > high, occupancy < low], [OCCUPIED, 0], between).astype(np.int8)


def _grey(pixels: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Mean of the colours (rows, columns), and the mask of the transparent pixels."""
    if pixels.ndim == 2:
        return pixels, np.zeros(pixels.shape, bool)
    if pixels.shape[2] == 4:
        return pixels[:, :, :3].mean(axis=2), pixels[:, :, 3] == 0
    return pixels.mean(axis=2), np.zeros(pixels.shape[:2], bool)


def _description(path: str) -> Description:
    try:
        given = yaml.safe_load(_contents(path, MOST_YAML_BYTES).decode())
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError, ValueError) as error:
        if isinstance(error, MapFileError):
            raise
        raise MapFileError(f"{path}: not YAML ({' '.join(str(error).split())[:200]})") from error
    if not isinstance(given, dict):
        raise MapFileError(f"{path}: not the description of a map (image, resolution, origin, ...)")
    try:
        return _checked(given)
    except ValueError as error:
        raise MapFileError(f"{path}: {error}") from error


def _checked(given: Mapping[Any, Any]) -> Description:
    for key in ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"):
        if key not in given:
            raise ValueError(f"{key} is missing")
    image, origin, mode = given["image"], given["origin"], given.get("mode", "trinary")
    if not isinstance(image, str) or not image or "\0" in image:
        raise ValueError(f"image must be the name of a file, not {image!r:.60}")
    if not isinstance(origin, list) or len(origin) != 3:
        raise ValueError(f"origin must be [x, y, yaw], not {origin!r:.60}")
    pose = [_number(value, "origin", -FARTHEST, FARTHEST) for value in origin]
    if given["negate"] not in (0, 1):
        raise ValueError(f"negate must be 0 or 1, not {given['negate']!r:.60}")
    if mode not in MODES:
        raise ValueError(f"mode must be one of {', '.join(MODES)}, not {mode!r:.60}")
    high, low = (_number(given[key], key, 0.0, 1.0) for key in ("occupied_thresh", "free_thresh"))
    if low >= high:
        raise ValueError(f"free_thresh must be less than occupied_thresh, not {low:g} and {high:g}")
    resolution = _number(given["resolution"], "resolution", 0.0, math.inf)
    return Description(image, resolution, Pose(*pose), bool(given["negate"]), high, low, mode)


def _number(value: Any, key: str, least: float, most: float) -> float:
    # YAML 1.1 takes numbers like 1e-3 for text.
    try:
        number = math.nan if isinstance(value, bool) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not (math.isfinite(number) and least <= number <= most):
        bounds = f"of at least {least:g}" if math.isinf(most) else f"from {least:g} to {most:g}"
        raise ValueError(f"{key} must be a number {bounds}, not {value!r:.60}")
    return number


def _pixels(path: str) -> np.ndarray:
    """The picture as uint8, (rows, columns) or (rows, columns, colours)."""
    data = _contents(path, MOST_PICTURE_BYTES)
    if data[:8] == _PNG_START and len(data) >= 24:
        # The size by the header, before memory is taken for the pixels.
        _check_size(path, int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big"))
        return _png_pixels(path, data)
    header = _PGM_HEADER.match(data[:4096])
    if header is None:
        raise MapFileError(f"{path}: not a picture in format PGM (P5 or P2) or PNG")
    width, height, levels = (int(number) for number in header.groups())
    _check_size(path, width, height)
    if levels != 255:
        raise MapFileError(f"{path}: a picture with grey values up to 255 is needed, this one says {levels}")
    text, body = data[:2] == b"P2", data[header.end() :]
    values = np.fromstring(body, np.int32, sep=" ") if text else np.frombuffer(body, np.uint8)
    if values.size < width * height:
        raise MapFileError(f"{path}: damaged or cut off, {values.size} of {width} x {height} pixels can be read")
    return values[: width * height].clip(0, 255).astype(np.uint8).reshape(height, width)


def _check_size(path: str, width: int, height: int) -> None:
    if not 0 < width * height <= MAX_CELLS:
        raise MapFileError(f"{path}: a map of {width} x {height} cells is not accepted (at most {MAX_CELLS} cells)")


def _png_pixels(path: str, data: bytes) -> np.ndarray:
    import cv2  # here, for nodes that read no pictures: see mr_grid.imaging

    pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if _sound_png(data) else None
    if pixels is None:
        raise MapFileError(f"{path}: damaged or cut off, a checksum is wrong or the end of the picture is missing")
    if pixels.dtype != np.uint8:
        raise MapFileError(f"{path}: a picture with 8 bits per colour is needed")
    return pixels


def _sound_png(data: bytes) -> bool:
    """True if all parts are there with right checksums. The decoder sees that too, but writes to the console."""
    start = len(_PNG_START)
    while start + 12 <= len(data):
        end = start + 12 + int.from_bytes(data[start : start + 4], "big")
        if zlib.crc32(data[start + 4 : end - 4]) != int.from_bytes(data[end - 4 : end], "big"):
            return False
        if data[start + 4 : start + 8] == b"IEND":
            return True
        start = end
    return False


def _contents(path: str, most: int) -> bytes:
    try:
        with open(path, "rb") as file:
            data = file.read(most + 1)
    except (OSError, ValueError) as error:
        raise MapFileError(f"{path}: {getattr(error, 'strerror', None) or error}") from error
    if len(data) > most:
        raise MapFileError(f"{path}: larger than {most} bytes")
    return data


def _write(path: str, data: bytes) -> None:
    part = path + ".part"
    with open(part, "wb") as file:
        file.write(data)
    os.replace(part, path)
