"""What the runner needs to know about a world; everything else about worlds is mr_sim's."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mr_launch.errors import UserError
from mr_launch.maps import Grid
from mr_launch.plan import Plan, RobotPlan

Pose = tuple[float, float, float]  # x, y in m, yaw in rad


def find_world(name: str) -> str:
    """Path of a world given by name or file. Raises UserError that lists the known ones."""
    from mr_sim.worlds import WorldNotFoundError
    from mr_sim.worlds import find_world as find

    try:
        return str(find(name).resolve())
    except WorldNotFoundError as error:
        raise UserError(f"--world: {error}") from None


def robots_of(world: str) -> list[tuple[str, Pose]]:
    """Names and start poses of the robots of a world file, in the file's order. Raises UserError."""
    from mr_sim.world_file import WorldFileError
    from mr_sim.world_model import load_world

    try:
        return [(robot.name, robot.start) for robot in load_world(world).robots]
    except (WorldFileError, OSError) as error:
        raise UserError(str(error)) from None


class CoverageMeter:
    """Explored share of one robot's map, while the team runs."""

    def __init__(self, world: str, start: Pose) -> None:
        self._start = start

    def coverage(self, grid: Grid) -> float | None:
        return None


class Measures:
    """Figures of final maps against the world's reference."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan

    def of(self, grid: Grid | None, robot: RobotPlan) -> dict[str, Any]:
        return {"coverage": None, "wrong_walls": None, "map_error": None}
