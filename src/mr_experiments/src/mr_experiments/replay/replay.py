"""A replay of a recorded mission: one HTML file without any external resource.

Everything that needs geometry happens here and in `replay_data` and `replay_maps`; the page only draws, with the
renderer of the status page (`mr_page`).
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mr_experiments.replay import replay_data
from mr_experiments.replay.replay_data import ReplayError
from mr_experiments.replay.replay_maps import (
    Eye,
    Lookout,
    Picture,
    Surroundings,
    class_uri,
    corners_in_world,
    decode_map,
    known_since,
    load_surroundings,
    paced,
    picture_to_world,
    snapshot_frame,
    timed_uri,
    wall_picture,
    walls_of_maps,
)
from mr_grid import Pose
from mr_measures.record.files import STACK_RECORD, RecordError, read_record
from mr_measures.record.mission_record import MissionRecord, RobotMaps
from mr_page.document import self_contained
from mr_sim.raster import Grid
from mr_sim.world_names import told_here

MAX_SNAPSHOT_CHARACTERS = 16_000_000  # in one page; with more, snapshots are left out evenly
REVEAL_STEP = 0.5  # s, least step in which a reconstructed map grows
MARGIN = 0.5  # m around everything that is shown
HERE = Pose()  # pose of the world frame in itself

SNAPSHOTS, RECONSTRUCTED, SEEN = "snapshots", "reconstructed", "seen"  # where the maps of a page come from


def load_record(path: Path) -> MissionRecord:
    """The record in a file. Raises ReplayError naming what is wrong with it."""
    if path.is_dir():
        records = [path / STACK_RECORD] if (path / STACK_RECORD).exists() else sorted(path.glob("*.json"))
        hint = f", as {records[0]}" if records else ", which ends in .json"
        raise ReplayError(f"{path} is a folder: give one of the records in it{hint}")
    try:
        record = read_record(path)
    except RecordError as error:
        raise ReplayError(
            f"{error}; give a record that `rosrun mr_experiments run` or `mr_launch team` wrote"
        ) from None
    if not record.robots:
        failure = f"the trial failed at {record.outcome.time:g} s: {record.outcome.reason}"
        raise ReplayError(f"{path} holds no robots, so there is nothing to show: {failure}")
    return record


def make_page(record: MissionRecord) -> str:
    """The HTML page of a record with robots. Raises ReplayError for maps that cannot be read."""
    data = page_data(record)
    return self_contained("replay", data["title"], data)


def page_data(record: MissionRecord) -> dict[str, Any]:
    """All that the page draws, ready for JSON; positions in the world frame. Raises ReplayError."""
    robots = replay_data.robots_of(record)
    end = replay_data.end_of(record)
    surroundings = load_surroundings(record.asked.world)
    merges = replay_data.merges(record.robots)
    events = replay_data.events(robots, merges, end) + replay_data.warnings(record, end)
    maps = _Maps(record, robots, merges, surroundings, end).build()
    data = {
        **_head(record),
        "end": end,
        "states": replay_data.STATES,
        "robots": robots,
        "team": replay_data.series_of(record.team.series, replay_data.TEAM_DIGITS),
        "merges": merges,
        "links": replay_data.links(record.robots, end),
        "events": sorted(events, key=lambda event: event["at"]),
        "footprints": [_footprint(robot["name"], surroundings) for robot in robots],
        "walls": None if surroundings is None else _walls(surroundings.walls),
        **maps,
    }
    data["bounds"] = bounds(data)
    data["notes"] = [*maps["notes"], *missing_parts(data)]
    return data


def _head(record: MissionRecord) -> dict[str, Any]:
    """Title, plain values of the trial, and how it came out."""
    asked, outcome = record.asked, record.outcome
    count = len(record.robots)
    title = f"{told_here(asked.world)}, {count} robot{'s' if count != 1 else ''}, {asked.scenario}, seed {asked.seed}"
    return {
        "title": title,
        "trial": {name: value for name, value in asked.settings.items() if isinstance(value, (str, int, float))},
        "outcome": {"status": outcome.status, "reason": outcome.reason, "traceback": outcome.traceback},
        "exploration_time": record.team.exploration_time,
    }


def _walls(walls: Grid) -> dict[str, Any]:
    """The true walls as a class picture in the world frame."""
    resolution = max(0.04, walls.resolution, walls.resolution * math.sqrt(walls.cells.size / 1e6))
    picture = wall_picture(walls, resolution)
    rows, columns = picture.classes.shape
    matrix = picture_to_world(HERE, resolution, walls.origin, rows)
    return {"png": class_uri(picture), "matrix": matrix, "corners": corners_in_world(matrix, rows, columns).tolist()}


def _footprint(name: str, surroundings: Surroundings | None) -> list[list[list[float]]]:
    """Polygons of a robot's body in its own frame, m; none when the world does not tell."""
    polygons = surroundings.footprints.get(name, ()) if surroundings else ()
    return [[[round(x, 3), round(y, 3)] for x, y in polygon] for polygon in polygons]


def bounds(data: Mapping[str, Any]) -> list[float]:
    """Left, bottom, right, top (m, world frame) of the true walls and all poses and goals, or of the maps if there are
    no walls."""
    points = [[robot["start"][:2] for robot in data["robots"]]]
    for robot in data["robots"]:
        points.append([[goal["x"], goal["y"]] for goal in robot["goals"]])
        points.append(list(zip(robot["series"].get("x", ()), robot["series"].get("y", ()), strict=True)))
    points += [picture["corners"] for picture in ([data["walls"]] if data["walls"] else data["layers"])]
    array = np.array([point for group in points for point in group], dtype=float).reshape(-1, 2)
    if len(array) == 0:
        return [-1.0, -1.0, 1.0, 1.0]
    low, high = array.min(axis=0) - MARGIN, array.max(axis=0) + MARGIN
    return [round(float(value), 3) for value in (*low, *high)]


def missing_parts(data: Mapping[str, Any]) -> list[str]:
    """One sentence for each part that a replay usually has and this record lacks."""
    robots = data["robots"]
    result = []
    if data["walls"] is None:
        result.append(f"The world {data['trial'].get('world', '')} is not at hand: no true walls.".replace("  ", " "))
    lost = [robot["name"] for robot in robots if "x" not in robot["series"]]
    if lost:
        result.append(f"No poses recorded: {', '.join(lost)}.")
    if not data["team"].get("explored"):
        result.append("No explored area of the team recorded.")
    if len(robots) > 1 and not data["links"]:
        result.append("No radio links recorded.")
    if not any(robot["goals"] for robot in robots):
        result.append("No goals recorded.")
    return result


class _Maps:
    """The maps of a page: "snapshots" and "layers" and which of them show what each robot and the team knew.

    A layer is a timed picture that grows. In the view of the team each robot has the layer of its own local map, in the
    view of a robot its global map; each stands in for the other where the record lacks one, and where it has neither,
    what the robot's laser would have seen between the true walls.
    """

    def __init__(
        self,
        record: MissionRecord,
        robots: Sequence[Mapping[str, Any]],
        merges: Sequence[Mapping[str, Any]],
        surroundings: Surroundings | None,
        end: float,
    ) -> None:
        self._record = record
        self._robots = robots
        self._merges = merges
        self._end = end
        self._step = max(REVEAL_STEP, end / 65000.0)
        self._eyes = surroundings.eyes if surroundings else {}
        self._pictures = self._decode()
        self._walls = surroundings.walls if surroundings else self._drawn_walls()
        self._lookout = Lookout(self._walls) if self._walls is not None else None
        self._since = [self._first_seen(robot) for robot in robots] if self._lookout else []
        self._layers: list[dict[str, Any]] = []
        self._numbers: dict[tuple[int, str], int] = {}

    def build(self) -> dict[str, Any]:
        """ "layers", "snapshots" (per robot), "views" (per robot the numbers of its layers), "step" and "notes"."""
        snapshots, notes = self._snapshots()
        shown = [not frames for frames in snapshots]  # with snapshots of its own a robot needs no reconstruction
        views = []
        for index in range(len(self._robots)):
            team = self._layer(index, ("local", "global")) if shown[index] else None
            alone = self._layer(index, ("global", "local")) if shown[index] else None
            views.append({"team": team, "alone": alone})
        return {"layers": self._layers, "snapshots": snapshots, "views": views, "step": self._step, "notes": notes}

    def _decode(self) -> dict[tuple[int, str], Picture]:
        """Final maps by robot and kind."""
        result = {}
        for index, robot in enumerate(self._robots):
            maps = self._record.maps.get(robot["name"], RobotMaps())
            for kind, stored in (("global", maps.merged), ("local", maps.local)):
                if stored is not None:
                    result[index, kind] = decode_map(stored, f"maps.{robot['name']}.{kind}")
        return result

    def _start(self, index: int) -> Pose:
        return Pose(*self._robots[index]["start"])

    def _drawn_walls(self) -> Grid | None:
        if not self._pictures:
            return None
        return walls_of_maps([(picture, self._start(index)) for (index, _), picture in self._pictures.items()])

    def _first_seen(self, robot: Mapping[str, Any]) -> np.ndarray:
        assert self._lookout is not None
        return self._lookout.first_seen(robot["series"], self._eyes.get(robot["name"], Eye()))

    def _layer(self, index: int, kinds: Sequence[str]) -> int | None:
        """Number of the layer of the first kind of map that this robot has."""
        kind = next((kind for kind in kinds if (index, kind) in self._pictures), SEEN)
        if (index, kind) not in self._numbers:
            layer = self._seen_layer(index) if kind == SEEN else self._map_layer(index, kind)
            if layer is None:
                return None
            self._numbers[index, kind] = len(self._layers)
            self._layers.append(layer)
        return self._numbers[index, kind]

    def _map_layer(self, index: int, kind: str) -> dict[str, Any]:
        assert self._lookout is not None
        picture, start = self._pictures[index, kind], self._start(index)
        points = placed_centres(picture, start)
        sharers = self._shared_from(index) if kind == "global" else {index: 0.0}
        times = self._lookout.at([self._since[other] for other in sharers], points)
        views = list(zip(times, sharers.values(), strict=True))
        since = known_since(picture, views)
        series = self._robots[index]["series"]
        area = series.get("explored" if kind == "global" else "own")
        if area:
            since = paced(picture, since, series["time"], area)
        return self._described(index, picture, start, since, RECONSTRUCTED)

    def _seen_layer(self, index: int) -> dict[str, Any] | None:
        if self._lookout is None or self._walls is None or not np.isfinite(self._since[index]).any():
            return None
        picture = self._lookout.picture(self._walls, self._since[index])
        since = known_since(picture, [(self._since[index].reshape(-1), 0.0)])
        return self._described(index, picture, HERE, since, SEEN)

    def _described(self, index: int, picture: Picture, pose: Pose, since: np.ndarray, source: str) -> dict[str, Any]:
        rows, columns = picture.classes.shape
        matrix = picture_to_world(pose, picture.resolution, picture.origin, rows)
        return {
            "robot": index,
            "source": source,
            "png": timed_uri(picture, since, self._step),
            "matrix": matrix,
            "corners": corners_in_world(matrix, rows, columns).round(3).tolist(),
        }

    def _shared_from(self, index: int) -> dict[int, float]:
        """Per robot since when this robot had its map: at once for itself, infinite for those it never merged."""
        result = {other: math.inf for other in range(len(self._robots))}
        result[index] = 0.0
        for merge in self._merges:
            if merge["by"] == index and merge["with"] is not None and merge["kind"] != "revoked":
                result[merge["with"]] = min(result[merge["with"]], merge["at"])
        return result

    def _snapshots(self) -> tuple[list[list[dict[str, Any]]], list[str]]:
        """Frames per robot in the order of time, the final map last, and a note when some had to be left out."""
        numbers = {robot["name"]: index for index, robot in enumerate(self._robots)}
        frames: list[list[dict[str, Any]]] = [[] for _ in self._robots]
        for position, entry in enumerate(self._record.snapshots):
            index = numbers.get(entry.robot)
            if index is not None:
                where = f"snapshots[{position}]"
                frames[index].append(snapshot_frame(entry.time, entry.picture, self._start(index), where))
        for index, of_robot in enumerate(frames):
            of_robot.sort(key=lambda frame: frame["time"])
            if of_robot and (index, "global") in self._pictures and of_robot[-1]["time"] < self._end:
                of_robot.append(self._final_frame(index))
        size = sum(len(frame["png"]) for of_robot in frames for frame in of_robot)
        every = math.ceil(size / MAX_SNAPSHOT_CHARACTERS)
        if every <= 1:
            return frames, []
        note = f"Every {every}. snapshot is shown, so that this file does not grow too large."
        return [thinned(of_robot, every) for of_robot in frames], [note]

    def _final_frame(self, index: int) -> dict[str, Any]:
        name = self._robots[index]["name"]
        stored = self._record.maps[name].merged
        assert stored is not None
        return snapshot_frame(self._end, stored, self._start(index), f"maps.{name}.global")


def thinned(frames: Sequence[dict[str, Any]], every: int) -> list[dict[str, Any]]:
    """Every so manyth frame, counted back from the last, which stays."""
    return list(frames[::-1][::every][::-1])


def placed_centres(picture: Picture, pose: Pose) -> np.ndarray:
    """Centres (N, 2) of all cells of a map whose frame lies at `pose`, in the world frame, row by row."""
    return pose.apply(picture.centres())
