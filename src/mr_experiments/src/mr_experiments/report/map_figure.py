"""Fig. 3 of the paper: the merged map of one robot with the local maps of all laid over it, in the world frame."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import Mapping, Sequence

import cv2
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from mr_experiments.report import figure_style as style
from mr_experiments.report.figure_style import plt
from mr_experiments.report.scope import Scope
from mr_grid import GridInfo, Pose, values_at
from mr_measures.map_picture import Picture
from mr_measures.record.files import RecordError
from mr_measures.record.mission_record import MissionRecord

UNKNOWN, FREE, OCCUPIED = 205, 254, 0  # grey values of a stored map
ROBOT_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#7F7F7F")
BACKGROUND, WALL = np.array([0.90, 0.91, 0.93]), np.array([0.13, 0.15, 0.19])
TINT = 0.35  # share of a robot's colour where its local map knows a cell
MARGIN = 0.5  # m around the maps
MAXIMUM_PANELS = 4
LEGEND_GAP = 0.5  # inches between a panel and its legend, for the labels of the axis
LARGEST = 900  # cells along a side of a picture


@dataclass(frozen=True)
class StoredMap:
    """`pixels`: uint8 (rows, columns), row 0 at the lowest y; `info`: where they lie in the robot's map frame; `pose`:
    of that frame in the world."""

    pixels: np.ndarray
    info: GridInfo
    pose: Pose

    def at(self, points: np.ndarray) -> np.ndarray:
        """Grey values (N,) at points (N, 2) of the world; unknown beside the map."""
        return values_at(self.pixels, self.info, self.pose.apply_inverse(points), UNKNOWN)

    def corners(self) -> np.ndarray:
        """Corners (4, 2) in the world of what the map knows; (0, 2) if it knows nothing."""
        rows, columns = np.nonzero(self.pixels != UNKNOWN)
        if not rows.size:
            return np.empty((0, 2))
        xs = self.info.origin.x + self.info.resolution * np.array([columns.min(), columns.max() + 1])
        ys = self.info.origin.y + self.info.resolution * np.array([rows.min(), rows.max() + 1])
        return self.pose.apply(np.array([(x, y) for x in xs for y in ys]))


@dataclass(frozen=True)
class Maps:
    """Final maps of a trial."""

    owner: str  # of the global map
    merged: StoredMap
    local: Mapping[str, StoredMap]
    colours: Mapping[str, np.ndarray]  # RGB (3,) in [0, 1] by robot


def load_maps(record: MissionRecord) -> Maps | None:
    """The global map of the first robot that has one and all local maps; None without a global map."""
    starts = {name: robot.start for name, robot in record.robots.items()}
    maps = {name: record.maps[name] for name in starts if name in record.maps}
    owner, merged = next(((name, entry.merged) for name, entry in maps.items() if entry.merged), (None, None))
    if owner is None or merged is None:
        return None
    try:
        local = {name: decode_map(entry.local, starts[name]) for name, entry in maps.items() if entry.local}
        return Maps(owner, decode_map(merged, starts[owner]), local, robot_colours(list(starts)))
    except ValueError as error:
        asked = record.asked
        what = f"record of {asked.world}, {asked.scenario}, R = {asked.robots}, seed {asked.seed}"
        raise RecordError(f"{what}: maps holds an entry that is not understood ({error!r})") from None


def decode_map(picture: Picture, pose: Pose) -> StoredMap:
    """A map of a record; `pose`: true start pose of its robot."""
    data = np.frombuffer(base64.b64decode(picture.png), np.uint8)
    pixels = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE) if data.size else None
    if pixels is None:
        raise ValueError("the PNG of a map cannot be read")
    rows, columns = pixels.shape
    return StoredMap(np.flipud(pixels), GridInfo(columns, rows, picture.resolution, Pose(*picture.origin)), pose)


def overlay(maps: Maps) -> tuple[np.ndarray, tuple[float, float, float, float]]:
    """RGB picture (rows, columns, 3) in [0, 1], row 0 at the lowest y, and its extent left, right, bottom, top in m."""
    corners = np.concatenate([stored.corners() for stored in (maps.merged, *maps.local.values())])
    low, high = corners.min(axis=0) - MARGIN, corners.max(axis=0) + MARGIN
    step = maps.merged.info.resolution
    xs, ys = (np.arange(low[axis] + step / 2.0, high[axis], step) for axis in (0, 1))
    points = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    merged = maps.merged.at(points)
    picture = np.where((merged == FREE)[:, None], 1.0, BACKGROUND)
    for name, stored in maps.local.items():
        known = stored.at(points) != UNKNOWN
        # Multiplied, so that cells known to several robots show the colours of all.
        picture[known] *= 1.0 - TINT * (1.0 - maps.colours[name])
    picture[merged == OCCUPIED] = WALL
    extent = (float(low[0]), float(low[0]) + len(xs) * step, float(low[1]), float(low[1]) + len(ys) * step)
    return shrunk(picture.reshape(len(ys), len(xs), 3)), extent


def shrunk(picture: np.ndarray) -> np.ndarray:
    """A picture (rows, columns, 3) with blocks of cells joined, the darkest counting, so that thin walls of large maps
    stay."""
    block = -(-max(picture.shape) // LARGEST)
    rows, columns = (-size % block for size in picture.shape[:2])
    padded = np.pad(picture, ((0, rows), (0, columns), (0, 0)), mode="edge")
    return padded.reshape(padded.shape[0] // block, block, -1, block, 3).min(axis=(1, 3))


def robot_colours(names: Sequence[str]) -> dict[str, np.ndarray]:
    return {name: np.array(to_rgb(ROBOT_COLOURS[i % len(ROBOT_COLOURS)])) for i, name in enumerate(names)}


def typical_record(records: Sequence[MissionRecord]) -> MissionRecord | None:
    """The mission whose largest map error is the median; finished missions first. None when all have failed."""
    finished = [record for record in records if record.finished]
    others = [record for record in records if not record.failed]
    ordered = sorted(finished or others, key=_worst_error)
    return ordered[(len(ordered) - 1) // 2] if ordered else None


def _worst_error(record: MissionRecord) -> float:
    return max((abs(error) for error in record.map_errors), default=0.0)


def map_figure(scope: Scope) -> Figure | None:
    """One panel per team size, up to MAXIMUM_PANELS, one robot alone only if there is room. None without any map."""
    teams = sorted(sorted(scope.teams, key=lambda robots: (robots == 1, robots))[:MAXIMUM_PANELS])
    chosen = [record for record in (typical_record(scope.teams[robots]) for robots in teams) if record is not None]
    panels = [(record, maps) for record in chosen if (maps := load_maps(record)) is not None]
    panels = [(record, maps) for record, maps in panels if len(maps.merged.corners())]
    if not panels:
        return None
    pictures = [overlay(maps) for _, maps in panels]
    columns = min(2, len(panels))
    rows = -(-len(panels) // columns)
    shape = max(picture.shape[0] / picture.shape[1] for picture, _ in pictures)
    width = 11.0 if columns == 2 else 8.4
    with plt.rc_context({**style.STYLE, "axes.grid": False}):
        size = (width, rows * (shape * width / columns + 0.75))
        figure, grid = plt.subplots(rows, columns, figsize=size, squeeze=False)
        for axes in grid.flat[len(panels) :]:
            axes.set_axis_off()
        for axes, (record, maps), (picture, extent) in zip(grid.flat, panels, pictures):
            _draw_panel(axes, record, maps, picture, extent)
            below = -LEGEND_GAP / (shape * width / columns)
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, below), ncol=4, handletextpad=0.1, columnspacing=1.2)
    return figure


def _draw_panel(
    axes: Axes, record: MissionRecord, maps: Maps, picture: np.ndarray, extent: tuple[float, float, float, float]
) -> None:
    axes.imshow(picture, origin="lower", extent=extent, interpolation="none")
    owner = record.robots[maps.owner].map
    error = "" if owner.error is None else f", e = {owner.error:+.2f} %"
    axes.set_title(f"R = {record.asked.robots}, seed {record.asked.seed}: map of {maps.owner}{error}", loc="left")
    for name in maps.local:
        start = maps.local[name].pose
        axes.plot(
            start[0], start[1], marker=(3, 0, np.degrees(start[2]) - 90.0), markersize=8, linestyle="",
            color=tuple(maps.colours[name]), markeredgecolor="black", markeredgewidth=0.7, label=name,
        )  # fmt: skip
    axes.set_xlabel("x in m")
    axes.set_ylabel("y in m")
