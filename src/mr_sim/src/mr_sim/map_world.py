"""A map of map_server as a world: what is not known to be free is wall, and Pioneers stand where they are told to."""

import contextlib
import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml  # type: ignore[import-untyped]

from mr_grid import Pose
from mr_plans.world_files import WorldFiles
from mr_sim.bitmap import read_image, why_no_image

SUFFIXES = (".yaml", ".yml")

_WORLD = """# Drawn from {source}: free where that map is free, wall where it is occupied or unknown.
# World frame: that of the map.

include "pioneer.inc"

# That of the map: a pixel is a cell.
resolution {resolution:.9g}
interval_sim 50

floorplan
(
  name "{stem}"
  bitmap "{stem}.png"
  size [ {length:.9g} {depth:.9g} 0.8 ]
  pose [ {x:.9g} {y:.9g} 0.0 {degrees:.9g} ]
)

{robots}
"""


class MapError(ValueError):
    """A map that cannot be a world: names the file and what is wrong in it."""


@dataclass(frozen=True)
class _Map:
    """`free`: bool (rows, columns), row 0 at the bottom; `origin`: pose of its lower left corner; resolution in m."""

    free: np.ndarray
    resolution: float
    origin: Pose


def is_map(name: str) -> bool:
    """Whether a world is given as a map of map_server."""
    return name.endswith(SUFFIXES)


def map_world_files(path: str | Path, starts: Sequence[Pose] = ()) -> WorldFiles:
    """Picture and world file of a map: robots robot_0, ... at `starts` (map frame), or one where there is most room.
    The name tells different contents apart. Raises MapError, OSError."""
    import cv2  # here and below, for who needs no picture: it is slow to import

    map_ = _cropped(_load(Path(path)))
    done, data = cv2.imencode(".png", np.where(np.flipud(map_.free), 255, 0).astype(np.uint8))
    if not done:
        raise MapError(f"{path}: cannot be drawn as a picture")
    picture = bytes(data)
    robots = [_ROBOT.format(i, *pose[:2], math.degrees(pose[2])) for i, pose in enumerate(starts or [_roomiest(map_)])]
    rows, columns = map_.free.shape
    length, depth = columns * map_.resolution, rows * map_.resolution
    x, y, yaw = map_.origin.compose(Pose(length / 2.0, depth / 2.0, 0.0))
    digest = hashlib.sha256(repr((picture, map_.resolution, tuple(map_.origin), robots)).encode()).hexdigest()[:8]
    stem = f"{Path(path).stem}-{digest}"
    text = _WORLD.format(
        source=Path(path).name, stem=stem, resolution=map_.resolution, length=length, depth=depth, x=x, y=y,
        degrees=math.degrees(yaw), robots="\n".join(robots),
    )  # fmt: skip
    return WorldFiles(stem, picture, text)


_ROBOT = 'pioneer ( name "robot_{}" pose [ {:.9g} {:.9g} 0 {:.9g} ] )'


def _load(path: Path) -> _Map:
    try:
        values = yaml.safe_load(path.read_text(encoding="utf-8"))
    except yaml.MarkedYAMLError as error:
        where = f", line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise MapError(f"{path}{where}: is no YAML: {error.problem}") from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise MapError(f"{path}: is no YAML: {' '.join(str(error).split())}") from None
    if not isinstance(values, dict) or not {"image", "resolution", "origin"} <= values.keys():
        raise MapError(f"{path}: a map of map_server has the keys image, resolution and origin")
    if values.get("mode", "trinary") not in ("trinary", "scale"):
        raise MapError(f'{path}: "mode" must be trinary or scale, not {values["mode"]!r}')
    resolution = _number(path, values, "resolution")
    if resolution <= 0.0:
        raise MapError(f'{path}: "resolution" must be positive, not {resolution:g}')
    free_below = _number(path, {"free_thresh": 0.196, **values}, "free_thresh")
    picture = path.parent / str(values["image"])
    image = read_image(picture)
    if image is None:
        raise MapError(f'{path}: "image", {picture}, {why_no_image(picture)}')
    brightness = image.mean(axis=2)
    darkness = (brightness if _negated(path, values.get("negate", 0)) else 255.0 - brightness) / 255.0
    free = np.flipud(darkness < free_below)
    if not free.any():
        raise MapError(f"{path}: nothing in the map is free")
    return _Map(free, resolution, _origin(path, values["origin"]))


def _number(path: Path, values: dict[str, Any], key: str) -> float:
    value = values[key]
    if isinstance(value, str):
        with contextlib.suppress(ValueError):  # YAML 1.1 takes 5e-2 for a text
            value = float(value)
    with contextlib.suppress(OverflowError):  # of a whole number
        if not isinstance(value, bool) and isinstance(value, (int, float)) and math.isfinite(value):
            return float(value)
    raise MapError(f'{path}: "{key}" must be a number, not {value!r:.40}')


def _negated(path: Path, value: Any) -> bool:
    """A text is none: "0" would be true."""
    if not isinstance(value, (bool, int, float)) or value not in (0, 1):
        raise MapError(f'{path}: "negate" must be 0 or 1, not {value!r:.40}')
    return bool(value)


def _origin(path: Path, value: Any) -> Pose:
    if not isinstance(value, list) or len(value) != 3:
        raise MapError(f'{path}: "origin" must be [x, y, yaw], not {value!r}')
    x, y, yaw = (_number(path, {"origin": number}, "origin") for number in value)
    return Pose(x, y, yaw)


def _cropped(map_: _Map) -> _Map:
    """To what is free, with a wall of one cell around it: nobody sees or gets farther."""
    rows, columns = np.flatnonzero(map_.free.any(axis=1)), np.flatnonzero(map_.free.any(axis=0))
    free = np.pad(map_.free[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1], 1)
    corner = Pose(float(columns[0] - 1) * map_.resolution, float(rows[0] - 1) * map_.resolution)
    return _Map(free, map_.resolution, map_.origin.compose(corner))


def _roomiest(map_: _Map) -> Pose:
    import cv2

    distance = cv2.distanceTransform(map_.free.astype(np.uint8), cv2.DIST_L2, 5)
    row, column = np.unravel_index(int(distance.argmax()), distance.shape)
    x, y = map_.origin.apply_point(float(column + 0.5) * map_.resolution, float(row + 0.5) * map_.resolution)
    return Pose(x, y, 0.0)
