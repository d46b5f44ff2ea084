"""A record made by hand for tests of the replay: robots on circles, maps cut from the true walls of a world."""

import base64
import math
from typing import Any

import cv2
import numpy as np

from mr_grid import Pose
from mr_sim.raster import Grid, rasterise
from mr_sim.world_model import load_world
from mr_sim.worlds import find_world

RESOLUTION = 0.1  # m, of the maps


def world_walls(world: str) -> Grid:
    description = load_world(find_world(world))
    return rasterise(description.obstacles, description.resolution)


def png_of(gray: np.ndarray) -> str:
    """Base64 of a PNG of `gray` uint8 (rows, columns), row 0 at the lowest y."""
    done, data = cv2.imencode(".png", np.flipud(gray))
    assert done
    return base64.b64encode(data.tobytes()).decode("ascii")


def map_around(walls: Grid, start: Pose, reach: float) -> dict[str, Any]:
    """True map in the frame of a robot that started at `start`, of the square of half side `reach` m around it."""
    count = round(2.0 * reach / RESOLUTION)
    axis = -reach + (np.arange(count) + 0.5) * RESOLUTION
    points = start.apply(np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2))
    index = np.floor((points - walls.origin) / walls.resolution).astype(int)
    inside = ((index >= 0) & (index < walls.cells.shape[::-1])).all(axis=1)
    gray = np.full(count * count, 205, dtype=np.uint8)
    gray[inside] = np.where(walls.cells[index[inside, 1], index[inside, 0]] != 0, 0, 254)
    return {"png": png_of(gray.reshape(count, count)), "resolution": RESOLUTION, "origin": [-reach, -reach]}


def sample_robot(index: int, names: list[str], start: Pose, end: int) -> dict[str, Any]:
    """A robot that drives a circle of 0.5 m to its left once in `end` seconds."""
    times = list(range(end + 1))
    poses = [start.compose(_on_circle(2.0 * math.pi * t / end)) for t in times]
    other = names[(index + 1) % len(names)]
    linked = [[other] if len(names) > 1 and 10 <= t < 30 else [] for t in times]
    merge = {"with": other, "at": 12.0, "transform": [0.1, 0.2, 0.3], "offset": 0.05, "turn": 0.01, "right": index != 1}
    return {
        "start": list(start),
        "finished_at": end - 5.0 - index * 0.1,
        "distance": math.pi,
        "moving": 0.9,
        "goals": [
            {"set": 1.0, "x": 1.0, "y": 0.5, "end": 20.0, "outcome": "reached", "text": ""},
            {"set": 20.0, "x": 0.0, "y": -1.0, "end": 25.0, "outcome": "failed", "text": "no path </script>"},
            {"set": 40.0, "x": 0.5, "y": 0.0, "end": None, "outcome": "", "text": ""},
        ],
        "merges": [merge] if len(names) > 1 else [],
        "auctions": [
            {
                "at": 5.0 + index,
                "id": 7,
                "clusters": 2,
                "unit": 7,
                "offers": [
                    {"x": 1.0, "y": 0.5, "bids": {name: 3.0 for name in names}, "explored_by": names[0]},
                    {"x": 2.0, "y": 0.5, "bids": {names[-1]: 8.0}},
                ],
                "answered": {name: 5.5 + index for name in names if name != names[index]},
                "decided": 6.0 + index,
            },
            {"at": 30.0 + index, "id": 8, "clusters": 1},
        ],
        "series": {
            "time": times,
            "x": [p[0] for p in poses],
            "y": [p[1] for p in poses],
            "yaw": [p[2] for p in poses],
            "explored": [min(30.0, 2.0 + t) for t in times],
            "own": [min(20.0, 2.0 + 0.5 * t) for t in times],
            "distance": [math.pi * t / end for t in times],
            "bytes": [1500 * t for t in times],
            "frames": [t for t in times],
            "state": [0 if t == 0 else 4 if t > end - 5 else 1 for t in times],
            "neighbors": linked,
        },
    }


def _on_circle(angle: float) -> Pose:
    return Pose(0.5 * math.sin(angle), 0.5 - 0.5 * math.cos(angle), angle)


def sample_record(robots: int = 2, end: int = 60) -> dict[str, Any]:
    """A record of a finished mission in the small world with all parts, without snapshots."""
    walls = world_walls("small8x8")
    names = [f"robot_{index}" for index in range(robots)]
    starts = {name: Pose(1.5 + 0.4 * index, 2.0, math.pi / 2.0 + 0.3 * index) for index, name in enumerate(names)}
    times = list(range(end + 1))
    return {
        "format": 1,
        "trial": {"world": "small8x8", "robots": robots, "seed": 17, "scenario": "paper", "strategy": 7, "fast": False},
        "versions": {"mr_experiments": "0.1.0"},
        "outcome": {"status": "finished", "reason": "", "time": float(end)},
        "team": {
            "exploration_time": end - 5.0,
            "series": {
                "time": times,
                "explored": [min(40.0, 3.0 + t) for t in times],
                "coverage": [t / end for t in times],
            },
        },
        "robots": {name: sample_robot(i, names, starts[name], end) for i, name in enumerate(names)},
        "maps": {
            name: {"global": map_around(walls, starts[name], 4.0), "local": map_around(walls, starts[name], 2.0)}
            for name in names
        },
    }


def add_snapshots(record: dict[str, Any], every: int = 10) -> dict[str, Any]:
    """The record with growing maps of all robots, every so many seconds."""
    walls = world_walls("small8x8")
    end = int(record["outcome"]["time"])
    record["snapshots"] = [
        {"time": float(time), "robot": name, **map_around(walls, Pose(*robot["start"]), 1.0 + 3.0 * time / end)}
        for time in range(0, end + 1, every)
        for name, robot in record["robots"].items()
    ]
    return record
