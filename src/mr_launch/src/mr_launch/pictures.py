"""The picture of a mission: the merged map with the paths of all robots, in the world frame."""

from __future__ import annotations

from pathlib import Path
from typing import Mapping

import matplotlib

matplotlib.use("Agg")  # no display needed

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.transforms import Affine2D

from mr_grid import OccupancyGrid, Pose
from mr_launch.maps import free_cells, occupied_cells
from mr_launch.truth import Track

COLOURS = ("#d62728", "#1f77b4", "#2ca02c", "#ff9f1c", "#9467bd", "#17becf", "#8c564b", "#e377c2")
ROBOT = np.array([(-0.5, -0.5), (0.27, -0.5), (0.5, 0.0), (0.27, 0.5), (-0.5, 0.5)])  # of length and width, nose ahead
UNKNOWN, FREE, OCCUPIED = (0.90, 0.91, 0.93, 1.0), (1.0, 1.0, 1.0, 1.0), (0.13, 0.15, 0.19, 1.0)


def map_colours(grid: OccupancyGrid) -> np.ndarray:
    """RGBA image (rows, columns, 4), row 0 at the lowest y."""
    image = np.empty((*grid.cells.shape, 4))
    image[...] = UNKNOWN
    image[free_cells(grid)] = FREE
    image[occupied_cells(grid)] = OCCUPIED
    return image


def bounds(grid: OccupancyGrid, pose: Pose) -> tuple[float, float, float, float]:
    """Left, right, bottom, top (m, world frame) of the known part of a map whose frame lies at ``pose``."""
    rows, columns = np.nonzero(grid.cells >= 0)
    if rows.size == 0:
        return pose[0] - 1, pose[0] + 1, pose[1] - 1, pose[1] + 1
    xs = grid.origin[0] + grid.resolution * np.array([columns.min(), columns.max() + 1])
    ys = grid.origin[1] + grid.resolution * np.array([rows.min(), rows.max() + 1])
    corners = np.array([(x, y) for x in xs for y in ys])
    world = pose.apply(corners)
    return world[:, 0].min(), world[:, 0].max(), world[:, 1].min(), world[:, 1].max()


def draw_mission(
    grid: OccupancyGrid,
    pose: Pose,
    tracks: Mapping[str, Track],
    title: str,
    path: Path,
    sizes: Mapping[str, tuple[float, float]],
    start: float = 0.0,
) -> None:
    """Write a PNG.

    Args:
        grid: the map to show.
        pose: x, y, yaw (m, rad) of the map's frame in the world frame, that is the robot's true start pose.
        tracks: true path of each robot; the part after the simulation time ``start`` (s) is drawn.
        title: one line above the picture.
        path: file to write.
        sizes: length and width of each robot, m.
    """
    left, right, bottom, top = bounds(grid, pose)
    width, height = right - left, top - bottom
    figure, axes = plt.subplots(figsize=(12, max(3.0, 12 * height / width) + 0.8), dpi=110)
    to_world = Affine2D().rotate(pose[2]).translate(pose[0], pose[1])
    rows, columns = grid.cells.shape
    x, y, _ = grid.origin
    axes.imshow(
        map_colours(grid),
        origin="lower",
        interpolation="nearest",
        extent=(x, x + columns * grid.resolution, y, y + rows * grid.resolution),
        transform=to_world + axes.transData,
    )
    for index, (name, track) in enumerate(tracks.items()):
        draw_track(axes, name, track, start, COLOURS[index % len(COLOURS)], sizes[name])
    axes.set_xlim(left - 0.3, right + 0.3)
    axes.set_ylim(bottom - 0.3, top + 0.3)
    axes.set_aspect("equal")
    axes.set_facecolor(UNKNOWN)
    axes.set_xlabel("x / m")
    axes.set_ylabel("y / m")
    axes.set_title(title, fontsize=11)
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.06), ncol=max(1, len(tracks)), frameon=False)
    figure.savefig(path, bbox_inches="tight")
    plt.close(figure)


def draw_track(axes: plt.Axes, name: str, track: Track, start: float, colour: str, size: tuple[float, float]) -> None:
    """Path, start (circle) and end (robot outline) of one robot."""
    records = track.records(start)
    if not records.size:
        return
    x, y, yaw = records["x"], records["y"], records["yaw"]
    axes.plot(x, y, color="white", linewidth=3.2, alpha=0.8, zorder=3)
    axes.plot(x, y, color=colour, linewidth=1.6, zorder=4, label=name)
    axes.plot(
        x[0], y[0], "o", markersize=9, markerfacecolor="white", markeredgecolor=colour, markeredgewidth=2, zorder=5
    )
    outline = Pose(x[-1], y[-1], yaw[-1]).apply(ROBOT * size)
    axes.fill(*outline.T, facecolor=colour, edgecolor="black", linewidth=0.8, zorder=6)
