"""Picture of one map drawn over another. Imports matplotlib, which nothing else here needs."""

import numpy as np
from matplotlib.figure import Figure

from mr_grid import GridInfo, Pose

from ..grid import free_cells, occupied_cells
from ..registration import Registration
from ..surface import Landmarks

FIRST, SECOND = "#0072b2", "#d55e00"
"""Blue and vermilion: told apart with any colour vision."""


def draw(path: str, target: Landmarks, source: Landmarks, result: Registration, reason: str) -> None:
    """Writes the picture: A in blue, B in orange at its transform, even if that was not accepted (then the title says
    so). OSError if the file cannot be written."""
    transform = result.transform if result.transform is not None else Pose()
    figure = Figure(figsize=(10.0, 8.0))
    axes = figure.subplots()
    # Smaller dots for B, so that walls in both maps show both colours.
    for name, landmarks, motion, colour, size in (
        ("A", target, Pose(), FIRST, 6.0),
        ("B", source, transform, SECOND, 1.5),
    ):
        free = motion.apply(_cells(landmarks.info, free_cells(landmarks.grid)))
        walls = motion.apply(_cells(landmarks.info, occupied_cells(landmarks.grid)))
        axes.scatter(*free.T, s=1.0, color=colour, alpha=0.1, linewidths=0.0, rasterized=True)
        axes.scatter(*walls.T, s=size, color=colour, linewidths=0.0, label=f"walls of {name}")
    axes.set_aspect("equal")
    axes.set(xlabel="x in m", ylabel="y in m")
    axes.set_title(("B in the frame of A: " if result.accepted else "not accepted: ") + reason)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), markerscale=3.0)
    figure.savefig(path, dpi=120, bbox_inches="tight")


def _cells(info: GridInfo, mask: np.ndarray) -> np.ndarray:
    rows, columns = np.nonzero(mask)
    return info.centres(rows, columns)
