"""Records as the runner writes them, made up: for tests of what reads them, and to see what a report looks like."""

from __future__ import annotations

import base64
import json
import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np

RESOLUTION = 0.05
ROOM = (8.0, 6.0)  # m, width and height of the room that the maps show
COMPONENTS = {"world": 0.9, "slam": 3.0, "navigation": 1.2, "merging": 2.0, "exploration": 0.6, "radio": 0.4}
START_SPACING = 0.9  # m


def starts(robots: int) -> list[tuple[float, float, float]]:
    """True start poses, one above the other near the left wall, the second one turned."""
    return [(1.0, 1.0 + START_SPACING * i, 0.5 if i == 1 else 0.0) for i in range(robots)]


def room_cells(seen: tuple[float, float]) -> np.ndarray:
    """Grey values (rows, columns), row 0 at the highest y, of the room as known from x = seen[0] to x = seen[1] (m)."""
    columns, rows = (round(side / RESOLUTION) for side in ROOM)
    pixels = np.full((rows, columns), 254, np.uint8)
    pixels[:2], pixels[-2:], pixels[:, :2], pixels[:, -2:] = 0, 0, 0, 0
    pixels[rows // 2 :, columns // 2 : columns // 2 + 2] = 0
    left, right = (round(x / RESOLUTION) for x in seen)
    pixels[:, :left], pixels[:, right:] = 205, 205
    return pixels


def map_entry(pixels: np.ndarray, origin: tuple[float, float]) -> dict[str, Any]:
    encoded = cv2.imencode(".png", pixels)[1].tobytes()
    return {"png": base64.b64encode(encoded).decode(), "resolution": RESOLUTION, "origin": list(origin)}


def maps_of(team: list[tuple[float, float, float]]) -> dict[str, Any]:
    """Perfect maps of the room; those of turned robots are left out because their lattice would be turned, too."""
    width = ROOM[0] / len(team)
    maps = {}
    for index, (x, y, yaw) in enumerate(team):
        if yaw == 0.0:
            own = room_cells((max(0.0, index * width - 0.5), min(ROOM[0], (index + 1) * width + 0.5)))
            maps[f"robot_{index}"] = {
                "global": map_entry(room_cells((0.0, ROOM[0])), (-x, -y)),
                "local": map_entry(own, (-x, -y)),
            }
    return maps


def robot_entry(
    index: int, team: int, finished_at: float | None, distance: float, error: float | None
) -> dict[str, Any]:
    start = starts(team)[index]
    merges = [
        {"with": f"robot_{other}", "at": 10.0 + 5.0 * abs(index - other), "transform": [0.0, 0.0, 0.0], "offset": 0.02,
         "turn": 0.001, "right": True}
        for other in range(team) if other != index
    ]  # fmt: skip
    return {
        "start": list(start),
        "finished_at": finished_at,
        "distance": distance,
        "moving": 0.8,
        "collisions": {"walls": 0, "robots": 0},
        "map": {"free_cells": 18000, "error": error, "coverage": 0.99, "wrong_walls": 0.0},
        "radio": {"frames_sent": 1000, "bytes_sent": 200_000, "packets_sent": 300, "packets_failed": 3},
        "counters": {"bids": 5, "goals": 9, "goals_reached": 8, "goals_failed": 1},
        "goals": [],
        "merges": merges,
        "auctions": [],
        "series": {"time": [0.0], "x": [start[0]], "y": [start[1]], "yaw": [start[2]]},
    }


def progress(until: float, area: float, rate: float, coverage: float = 0.99) -> dict[str, list[float]]:
    """Series of the team: an area (m^2) that fills exponentially with `rate` per s and is complete at the end."""
    time = np.arange(0.0, math.floor(until) + 1.0)
    share = 0.1 + 0.9 * (1.0 - np.exp(-rate * time)) / (1.0 - math.exp(-rate * time[-1])) if len(time) > 1 else time + 1
    return {
        "time": time.tolist(),
        "explored": (area * share).round(3).tolist(),
        "coverage": (coverage * share).round(4).tolist(),
    }


def make_record(
    robots: int = 2,
    seed: int = 1,
    *,
    times: list[float | None] | None = None,
    distances: list[float] | None = None,
    errors: list[float | None] | None = None,
    status: str = "finished",
    reason: str = "",
    world: str = "small8x8",
    scenario: str = "paper",
    strategy: int = 7,
    limit: float = 300.0,
    area: float = 44.0,
    overlap: float = 0.2,
    with_maps: bool = True,
) -> dict[str, Any]:
    """A record; `times`, `distances` and `errors` have one entry per robot."""
    times = times or [100.0 + 10.0 * i for i in range(robots)]
    distances = distances or [30.0 + 2.0 * i for i in range(robots)]
    errors = errors or [0.5] * robots
    done = [time for time in times if time is not None]
    end = max(done) if len(done) == robots else limit
    team = [robot_entry(i, robots, times[i], distances[i], errors[i]) for i in range(robots)]
    return {
        "format": 1,
        "trial": {"world": world, "robots": robots, "seed": seed, "scenario": scenario, "strategy": strategy,
                  "limit": limit, "fast": False},
        "versions": {"mr_experiments": "0.1.0", "python": "3.11.2"},
        "outcome": {"status": status, "reason": reason, "time": end},
        "team": {
            "exploration_time": end if status == "finished" else None,
            "overlap": overlap if robots > 1 else 0.0,
            "series": progress(end, area, 0.012 * math.sqrt(robots)),
            "trace": "0" * 16,
        },
        "robots": {f"robot_{i}": entry for i, entry in enumerate(team)},
        "maps": maps_of(starts(robots)) if with_maps else {},
        "measured": {"wall": end / 20.0, "cpu": end / 22.0, "real_time_factor": 20.0,
                     "cpu_by_component": {name: share * end / 200.0 for name, share in COMPONENTS.items()},
                     "host": "host", "started": "2024-01-01T00:00:00"},
    }  # fmt: skip


def failed_record(robots: int, seed: int, reason: str, **trial: Any) -> dict[str, Any]:
    """A trial whose engine crashed before anything was known."""
    record = make_record(robots, seed, status="failed", reason=reason, **trial)
    record["outcome"].update(time=12.5, traceback="Traceback ...")
    return {**record, "robots": {}, "maps": {}, "team": {}}


def write_record(folder: Path, record: dict[str, Any]) -> Path:
    trial = record["trial"]
    name = f"{Path(trial['world']).stem}-r{trial['robots']}-{trial['scenario']}-{trial['strategy']}-s{trial['seed']}"
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}.json"
    path.write_text(json.dumps(record))
    return path


def write_random_set(folder: Path, trials: int = 8, generator_seed: int = 1, slower: float = 1.0, **trial: Any) -> None:
    """Trials for R = 1, 2, 3, 4 with scatter; one for R = 4 is unfinished, one for R = 3 failed."""
    generator = np.random.default_rng(generator_seed)
    for robots in (1, 2, 3, 4):
        for seed in range(1, trials + 1):
            if robots == 3 and seed == 2:
                write_record(folder, failed_record(robots, seed, "map_merger: IndexError at 12.5 s", **trial))
                continue
            stuck = robots == 4 and seed == 3
            write_record(folder, _random_record(generator, robots, seed, slower, stuck, trial))


def _random_record(
    generator: np.random.Generator, robots: int, seed: int, slower: float, stuck: bool, trial: dict[str, Any]
) -> dict[str, Any]:
    mean = slower * (60.0 + 200.0 / robots)
    times: list[float | None] = [float(t) for t in (mean * generator.uniform(0.8, 1.2, robots)).round(1)]
    if stuck:
        times[-1] = None
    return make_record(
        robots,
        seed,
        times=times,
        distances=[float(d) for d in (slower * 90.0 / robots**0.7 * generator.uniform(0.8, 1.2, robots)).round(2)],
        errors=[float(e) for e in generator.normal(0.3 * robots, 0.4 * robots, robots).round(3)],
        status="unfinished" if stuck else "finished",
        reason="the limit of 300 s was reached; robot_3 was still exploring" if stuck else "",
        overlap=0.1 * robots,
        **trial,
    )
