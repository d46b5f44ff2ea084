"""Pictures of frontiers and decisions."""

from typing import Any, Mapping, Optional, Sequence

import matplotlib
import numpy as np

matplotlib.use("Agg")

from matplotlib import pyplot

from explorer.clusters import Cluster
from explorer.decision import Decision
from explorer.geometry import Position
from explorer.grid import OccupancyMap
from explorer.survey import Survey

LONGEST_EDGE = 10.0  # inches
MARGIN = 1.0  # m around what is known
UNKNOWN = 0.8  # brightness
FEW = 40  # clusters that get their numbers


def draw_survey(path: str, seen: Survey, title: str) -> None:
    """Writes a picture of what `python3 -m explorer frontiers` lists."""
    figure, axes = _on_map(seen.occupancy)
    _draw_clusters(axes, seen.clusters, seen.reasons)
    for stretch in seen.stretches:
        if stretch.reason:
            axes.plot(*stretch.cells.T, ".", color="black", markersize=2)
            axes.annotate(stretch.reason, stretch.place, fontsize=6, xytext=(3, 3), textcoords="offset points")
    axes.plot(*seen.start, "^", color="black", markersize=8, label="robot")
    _finish(path, figure, axes, title)


def draw_decision(path: str, decision: Decision, choice: Optional[int], by_point: bool, title: str) -> None:
    """Writes a picture of a decision. `choice`: number of a cluster, or of a frontier point if `by_point`."""
    scene = decision.scene
    figure, axes = _on_map(scene.ways.occupancy)
    _draw_clusters(axes, scene.clusters, decision.reasons)
    for robot, place in scene.positions.items():
        axes.plot(*place, "s", color="tab:red", markersize=7)
        axes.annotate(robot, place, fontsize=7, color="tab:red", xytext=(4, 4), textcoords="offset points")
    for robot, claim in scene.claims.items():
        if len(claim.places):
            axes.plot(*claim.places.T, "x", color="tab:red", markersize=5)
            axes.annotate(f"claim of {robot}", claim.places.mean(axis=0), fontsize=6, color="tab:red")
    goal = _goal(decision, choice, by_point)
    if goal is not None:
        way = np.array([scene.place, *_path(decision, goal), goal])
        axes.plot(*way.T, "-", color="black", linewidth=1)
        axes.plot(*goal, "*", color="gold", markeredgecolor="black", markersize=14, label="goal")
    marker = (3, 0, np.degrees(scene.pose.yaw) - 90.0)
    axes.plot(*scene.place, marker=marker, color="black", markersize=10, label=decision.robot)
    _finish(path, figure, axes, title)


def _goal(decision: Decision, choice: Optional[int], by_point: bool) -> Optional[Position]:
    if by_point:
        view = None if choice is None else decision.scene.views.get(choice)
        return None if view is None else (view[0], view[1])
    cluster = decision.scene.cluster(choice)
    return None if cluster is None else cluster.place


def _path(decision: Decision, goal: Position) -> Sequence[Position]:
    return decision.scene.ways.grid.field_from(*decision.scene.place).path_to(*goal)


def _on_map(occupancy: OccupancyMap) -> Any:
    """A figure with the map, cut to what is known of it."""
    info = occupancy.info
    shades = np.full(occupancy.cells.shape, UNKNOWN)
    shades[occupancy.cells >= 0] = 0.5
    shades[occupancy.free] = 1.0
    shades[occupancy.occupied] = 0.0
    known = np.argwhere(~occupancy.unknown)
    low, high = (known.min(axis=0), known.max(axis=0)) if len(known) else (np.zeros(2), np.array(shades.shape))
    (left, bottom), (right, top) = info.centres_of(np.array([low, high]))
    size = np.array([right - left + 2 * MARGIN, top - bottom + 2 * MARGIN])
    figure, axes = pyplot.subplots(figsize=tuple(size * LONGEST_EDGE / size.max() + (1.0, 1.0)))
    right_edge, top_edge = info.origin.x + info.width * info.resolution, info.origin.y + info.height * info.resolution
    extent = (info.origin.x, right_edge, info.origin.y, top_edge)
    axes.imshow(shades, cmap="gray", vmin=0.0, vmax=1.0, origin="lower", extent=extent, interpolation="nearest")
    axes.set_xlim(left - MARGIN, right + MARGIN)
    axes.set_ylim(bottom - MARGIN, top + MARGIN)
    axes.set_facecolor(str(UNKNOWN))
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    return figure, axes


def _draw_clusters(axes: Any, clusters: Sequence[Cluster], reasons: Mapping[int, str]) -> None:
    """Points of a cluster in one colour, hollow those that are no goals, with the reason that most of them have."""
    colours = pyplot.get_cmap("tab10")
    for cluster in clusters:
        colour = colours(cluster.number % 10)
        goals = np.array([member.number not in reasons for member in cluster.members])
        axes.plot(*cluster.points[goals].T, "o", color=colour, markersize=4)
        axes.plot(*cluster.points[~goals].T, "o", color=colour, markersize=4, fillstyle="none")
        told = [reasons[member.number] for member in cluster.members if member.number in reasons]
        label = str(cluster.number) if goals.any() else f"{cluster.number}: {max(sorted(set(told)), key=told.count)}"
        if len(clusters) <= FEW:
            axes.annotate(label, cluster.centre, fontsize=7, color=colour, xytext=(5, -8), textcoords="offset points")


def _finish(path: str, figure: Any, axes: Any, title: str) -> None:
    axes.set_title(title, fontsize=9)
    axes.legend(loc="upper right", fontsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=120)
    pyplot.close(figure)
