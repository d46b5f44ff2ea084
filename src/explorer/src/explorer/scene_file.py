"""Decisions as JSON text. The file holds what a `Scene` was made of; what its ways keep is computed anew."""

import base64
import json
import math
import zlib
from typing import Any, Dict, List, Mapping

import numpy as np

from explorer.clusters import Cluster
from explorer.decision import Decision
from explorer.errors import ExplorerError, SceneError
from explorer.frontiers import Frontier
from explorer.grid import OccupancyMap
from explorer.recognition import Listed
from explorer.scene import Scene
from explorer.ways import Ways
from mr_grid import GridInfo, Pose

FORMAT = "explorer decision 1"
MOST_CELLS = 100_000_000
UNTOLD_LARGEST = 0.29  # m, radius of the largest robot of the teams that made files which do not tell it

Json = Dict[str, Any]


def text_of(decision: Decision) -> str:
    """The decision as one JSON object (RFC 8259: infinite costs are null)."""
    content = {
        "format": FORMAT,
        "robot": decision.robot,
        "strategy": decision.strategy,
        "choice": decision.choice,
        "bids": {robot: _numbered(bids) for robot, bids in decision.bids.items()},
        "random": decision.random,
        "reasons": _numbered(decision.reasons),
        "scene": _from_scene(decision.scene),
    }
    return json.dumps(content, allow_nan=False)


def decision_of(text: str) -> Decision:
    """Raises `SceneError` with one line if the text is no recorded decision."""
    try:
        given = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise SceneError(f"not JSON: {error}") from error
    if not isinstance(given, dict) or given.get("format") != FORMAT:
        raise SceneError(f"not a recorded decision: 'format' must be {FORMAT!r}")
    try:
        return _to_decision(given)
    except KeyError as error:
        raise SceneError(f"{error.args[0]!r} is missing") from error
    except (TypeError, ValueError, AttributeError, OverflowError, ExplorerError, zlib.error) as error:
        raise SceneError(f"damaged: {error}") from error


def _to_decision(given: Json) -> Decision:
    choice = given["choice"]
    decision = Decision(
        robot=str(given["robot"]),
        strategy=str(given["strategy"]),
        scene=_to_scene(given["scene"]),
        bids={robot: {int(n): float(bid) for n, bid in bids.items()} for robot, bids in given["bids"].items()},
        choice=None if choice is None else int(choice),
        random=dict(given["random"]),
        reasons={int(number): str(reason) for number, reason in given["reasons"].items()},
    )
    members = {member.number for cluster in decision.scene.clusters for member in cluster.members}
    unknown = (set(decision.scene.views) | decision.scene.ready) - members
    if unknown:
        raise SceneError(f"frontier point {min(unknown)} is in no cluster")
    return decision


def _from_scene(scene: Scene) -> Json:
    return {
        "now": scene.now,
        "pose": [scene.pose.x, scene.pose.y, scene.pose.yaw],
        "ways": _from_ways(scene.ways),
        "clusters": [_from_cluster(cluster) for cluster in scene.clusters],
        "ready": sorted(scene.ready),
        "awaits_map": scene.awaits_map,
        "own": scene.own,
        "positions": {robot: list(place) for robot, place in scene.positions.items()},
        "competitors": list(scene.competitors),
        "claims": {
            robot: {"own": sorted(claim.own), "places": claim.places.tolist()} for robot, claim in scene.claims.items()
        },
        "name": scene.name,
        "team": list(scene.team),
        "start": list(scene.start),
    }


def _to_scene(given: Json) -> Scene:
    return Scene(
        now=float(given["now"]),
        pose=Pose(*_floats(given["pose"], 3)),
        ways=_to_ways(given["ways"]),
        clusters=tuple(_to_cluster(cluster) for cluster in given["clusters"]),
        ready=frozenset(int(number) for number in given["ready"]),
        awaits_map=bool(given["awaits_map"]),
        own=None if given["own"] is None else int(given["own"]),
        positions={robot: _place(place) for robot, place in given["positions"].items()},
        competitors=tuple(str(robot) for robot in given["competitors"]),
        claims={robot: _to_claim(claim) for robot, claim in given["claims"].items()},
        name=str(given["name"]),
        team=tuple(str(robot) for robot in given["team"]),
        start=_place(given["start"]),
    )


def _to_claim(given: Json) -> Listed:
    places = np.array([_place(place) for place in given["places"]], dtype=float).reshape(-1, 2)
    return Listed(frozenset(int(number) for number in given["own"]), places)


def _from_ways(ways: Ways) -> Json:
    info = ways.occupancy.info
    cells = zlib.compress(np.ascontiguousarray(ways.occupancy.cells, dtype=np.int8).tobytes())
    return {
        "resolution": info.resolution,
        "width": info.width,
        "height": info.height,
        "origin": [info.origin.x, info.origin.y],
        "cells": base64.b64encode(cells).decode("ascii"),
        "radius": ways.radius,
        "largest": ways.largest,
        "robots": [list(place) for place in ways.robots],
    }


def _to_ways(given: Json) -> Ways:
    width, height = int(given["width"]), int(given["height"])
    if not 0 < width * height <= MOST_CELLS:
        raise SceneError(f"a map of {width} x {height} cells is not accepted")
    info = GridInfo(width, height, float(given["resolution"]), Pose(*_place(given["origin"])))
    packed = base64.b64decode(given["cells"], validate=True)
    octets = zlib.decompressobj().decompress(packed, width * height + 1)
    if len(octets) != width * height:
        raise SceneError(f"the map is not of {width} x {height} cells")
    cells = np.frombuffer(octets, dtype=np.int8).reshape(height, width)
    robots = [_place(place) for place in given["robots"]]
    return Ways(OccupancyMap(info, cells), float(given["radius"]), robots, float(given.get("largest", UNTOLD_LARGEST)))


def _from_cluster(cluster: Cluster) -> Json:
    return {
        "number": cluster.number,
        "members": [[member.number, member.x, member.y] for member in cluster.members],
        "cost": cluster.cost if math.isfinite(cluster.cost) else None,
        "viewpoint": None if cluster.viewpoint is None else list(cluster.viewpoint),
        "target": cluster.target,
        "gain": cluster.gain,
        "views": _numbered({number: list(view) for number, view in cluster.views.items()}),
    }


def _to_cluster(given: Json) -> Cluster:
    if not given["members"]:
        raise SceneError(f"cluster {given['number']} has no members")
    return Cluster(
        number=int(given["number"]),
        members=tuple(Frontier(int(number), float(x), float(y)) for number, x, y in given["members"]),
        cost=math.inf if given["cost"] is None else float(given["cost"]),
        viewpoint=None if given["viewpoint"] is None else _place(given["viewpoint"]),
        target=None if given["target"] is None else int(given["target"]),
        gain=float(given["gain"]),
        views={int(number): _view(view) for number, view in given["views"].items()},
    )


def _view(given: Any) -> Any:
    x, y, cost = _floats(given, 3)
    return (x, y, cost)


def _place(given: Any) -> Any:
    x, y = _floats(given, 2)
    return (x, y)


def _floats(given: Any, count: int) -> List[float]:
    values = [float(value) for value in given]
    if len(values) != count or not all(map(math.isfinite, values)):
        raise SceneError(f"{count} finite numbers are needed, not {given!r:.60}")
    return values


def _numbered(values: Mapping[int, Any]) -> Dict[str, Any]:
    """JSON has names only."""
    return {str(number): value for number, value in values.items()}


def read(path: str) -> Decision:
    """`SceneError` names the file and what is wrong with it."""
    try:
        with open(path, encoding="utf-8") as file:
            return decision_of(file.read())
    except OSError as error:
        raise SceneError(f"{path}: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise SceneError(f"{path}: not JSON text") from error
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from error
