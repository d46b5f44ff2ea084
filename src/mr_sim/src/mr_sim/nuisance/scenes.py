"""Scenes drawn from a seed: narrow doors, jambs, desks, slanted walls, dead ends, robots that meet head on, robots
along walls, maps of others that are drawn beside the truth."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mr_grid import Pose
from mr_sim.nuisance.reach import Reach
from mr_sim.simulated_platform import platform_of
from mr_sim.world_description import Obstacle, RobotDescription, WorldDescription

Box = tuple[float, float, float, float, float]  # m and rad: middle x, y; length, width; yaw
Point = tuple[float, float]

RESOLUTION, INTERVAL = 0.02, 0.05  # m, s of the worlds
WALL = 0.1  # m thick
HALF_LENGTH, HALF_WIDTH, RADIUS = 0.22, 0.19, 0.291  # m, of the robot that the measures below are for, a Pioneer
MAP_ERROR = 0.02  # m and, tenfold, rad; standard deviation of where the map of another robot is drawn
DRIFT = (0.15, 0.3)  # m by which it is off in the scenes about that
STANDING_ROOM = 0.015  # m around a robot at the start
GOAL_ROOM = HALF_WIDTH + 0.06  # m around a goal
HINTED = 0.7  # of the scenes with two robots are those in which they tell where they are
TRIES = 500


@dataclass(frozen=True)
class Scene:
    """`goals`: of each robot, world frame, one after the other; each can be reached from the one before."""

    kind: str
    seed: int
    world: WorldDescription
    goals: tuple[tuple[Point, ...], ...]
    map_error: Pose  # of the map of another robot that a robot knows the scene from
    hints: bool  # whether the robots tell each other where they are
    reach: Reach


@dataclass(frozen=True)
class _Larger:
    """m by which a robot needs more room than a Pioneer: ahead, to each side, and from its middle to a corner."""

    ahead: float
    beside: float
    around: float

    @classmethod
    def of(cls, robot: RobotDescription) -> "_Larger":
        body = platform_of(robot).footprint
        return cls(
            max(0.0, body.length / 2.0 - HALF_LENGTH),
            max(0.0, body.width / 2.0 - HALF_WIDTH),
            max(0.0, body.radius - RADIUS),
        )


@dataclass(frozen=True)
class _Draft:
    size: Point
    boxes: list[Box]
    starts: list[Pose]
    goals: list[list[Point]]
    map_error: Pose | None = None
    hints: bool = True


class SceneError(ValueError):
    """A seed that no scene can be drawn from."""


def draw(seed: int, robot: RobotDescription) -> Scene:
    """The scene of a seed; kinds take turns. `robot`: the model of all robots; what a larger one has to pass is wider,
    so that all have as much room to their sides."""
    kinds, larger = list(KINDS), _Larger.of(robot)
    kind = kinds[seed % len(kinds)]
    random = np.random.default_rng([seed, 7])
    for _ in range(TRIES):
        scene = _checked(kind, seed, KINDS[kind](random, larger), robot, random)
        if scene is not None:
            return scene
    raise SceneError(f"no scene of kind {kind} from seed {seed}: its robots or goals never had room")


def _checked(kind: str, seed: int, draft: _Draft, robot: RobotDescription, random: np.random.Generator) -> Scene | None:
    """None if a robot would stand in something or a goal cannot be reached."""
    world, larger = _world(draft, robot), _Larger.of(robot)
    reach = Reach(world)
    if not all(reach.stands(start, STANDING_ROOM) for start in draft.starts):
        return None
    for start, goals in zip(draft.starts, draft.goals):
        for goal in goals:
            if reach.room(goal) < GOAL_ROOM + larger.beside or not math.isfinite(reach.seconds(start, goal)):
                return None
    error = draft.map_error or Pose(*random.normal(0.0, (MAP_ERROR, MAP_ERROR, 0.1 * MAP_ERROR)).tolist())
    return Scene(kind, seed, world, tuple(tuple(goals) for goals in draft.goals), error, draft.hints, reach)


def _world(draft: _Draft, robot: RobotDescription) -> WorldDescription:
    robots = tuple(
        replace(robot, name=f"robot_{index}", start=start, localization_origin=start)
        for index, start in enumerate(draft.starts)
    )
    obstacles = tuple(_obstacle(box) for box in [*_frame(draft.size), *draft.boxes])
    return WorldDescription(Path("nuisance.world"), RESOLUTION, INTERVAL, 0.0, None, obstacles, robots)


def _obstacle(box: Box) -> Obstacle:
    x, y, length, width, yaw = box
    a, b = length / 2.0, width / 2.0
    return Obstacle(
        Pose(x, y, yaw), (length, width), (((-a, -b), (a, -b), (a, b), (-a, b)),), None, False, True, True
    )  # fmt: skip


def _frame(size: Point) -> list[Box]:
    width, height = size
    return [
        (width / 2.0, WALL / 2.0, width, WALL, 0.0),
        (width / 2.0, height - WALL / 2.0, width, WALL, 0.0),
        (WALL / 2.0, height / 2.0, WALL, height, 0.0),
        (width - WALL / 2.0, height / 2.0, WALL, height, 0.0),
    ]


def _pierced(middle: Pose, gap: float, thickness: float = WALL, length: float = 12.0) -> list[Box]:
    """A wall along the x axis of `middle` with a gap there."""
    offset = (gap + length) / 2.0
    boxes = []
    for side in (-offset, offset):
        x, y, yaw = middle.compose(Pose(side, 0.0, 0.0))
        boxes.append((x, y, length, thickness, yaw))
    return boxes


def _uniform(random: np.random.Generator, low: float, high: float) -> float:
    return float(random.uniform(low, high))


def _gap(random: np.random.Generator, low: float, high: float, larger: _Larger) -> float:
    """m between walls."""
    return _uniform(random, low, high) + 2.0 * larger.beside


def _within(random: np.random.Generator, left: float, bottom: float, right: float, top: float) -> Point:
    return _uniform(random, left, right), _uniform(random, bottom, top)


def _heading(random: np.random.Generator) -> float:
    return _uniform(random, -math.pi, math.pi)


def _there_and_back(random: np.random.Generator) -> list[Point]:
    """Goals in the right and then in the left third of a room of 7 m x 5 m."""
    return [_within(random, 5.0, 0.5, 6.5, 4.5), _within(random, 0.5, 0.5, 2.0, 4.5)]


def _narrow_door(random: np.random.Generator, larger: _Larger) -> _Draft:
    middle = Pose(3.5, _uniform(random, 0.8, 4.2), math.pi / 2.0)
    boxes = _pierced(middle, _gap(random, 0.6, 0.9, larger), _uniform(random, 0.1, 0.4))
    start = Pose(*_within(random, 0.5, 0.5, 2.5, 4.5), _heading(random))
    return _Draft((7.0, 5.0), boxes, [start], [_there_and_back(random)])


def _jamb(random: np.random.Generator, larger: _Larger) -> _Draft:
    """A robot stands close to the jamb of the door that it has to pass."""
    middle, gap = Pose(3.5, _uniform(random, 1.2, 3.8), math.pi / 2.0), _gap(random, 0.65, 0.9, larger)
    side = float(random.choice([-1.0, 1.0]))
    start = Pose(
        3.5 - _uniform(random, 0.24 + larger.beside, 0.36 + larger.around),
        middle.y + side * (gap / 2.0 + _uniform(random, -0.1, 0.4)),
        _heading(random),
    )
    return _Draft((7.0, 5.0), _pierced(middle, gap), [start], [_there_and_back(random)])


def _desks(random: np.random.Generator, larger: _Larger) -> _Draft:
    boxes = []
    for _ in range(int(random.integers(6, 10))):
        length, width = ((1.4, 0.7), (1.0, 0.6), (0.5, 0.5))[int(random.integers(3))]
        boxes.append((*_within(random, 0.5, 0.3, 5.5, 4.7), length, width, _heading(random)))
    start = Pose(*_within(random, 0.3, 0.3, 5.7, 4.7), _heading(random))
    goals = [_within(random, 0.3, 0.3, 5.7, 4.7) for _ in range(3)]
    return _Draft((6.0, 5.0), boxes, [start], [goals])


def _slanted(random: np.random.Generator, larger: _Larger) -> _Draft:
    """A passage between two slanted walls."""
    angle = math.pi / 2.0 + float(random.choice([-1.0, 1.0])) * _uniform(random, 0.15, 0.6)
    gap, depth = _gap(random, 0.65, 0.9, larger), _uniform(random, 0.1, 1.2)
    boxes = _pierced(Pose(3.5, _uniform(random, 1.5, 3.5), angle), gap, depth)
    start = Pose(*_within(random, 0.3, 0.3, 2.5, 4.7), _heading(random))
    return _Draft((7.0, 5.0), boxes, [start], [_there_and_back(random)])


def _dead_end(random: np.random.Generator, larger: _Larger) -> _Draft:
    """In and out of a blind corridor that may be too narrow to turn."""
    width, y, end = _gap(random, 0.52, 0.7, larger), _uniform(random, 1.0, 4.0), _uniform(random, 4.0, 6.0)
    boxes = [
        ((3.0 + end) / 2.0, (y + width / 2.0 + 5.0) / 2.0, end - 3.0, 5.0 - y - width / 2.0, 0.0),
        ((3.0 + end) / 2.0, (y - width / 2.0) / 2.0, end - 3.0, y - width / 2.0, 0.0),
        (end + 0.05, 2.5, 0.1, 5.0, 0.0),
    ]
    start = Pose(*_within(random, 0.5, 0.5, 2.5, 4.5), _heading(random))
    goals = [(end - 0.3 - larger.ahead, y), _within(random, 0.5, 0.5, 2.5, 4.5)]
    return _Draft((7.0, 5.0), boxes, [start], [goals])


def _head_on(random: np.random.Generator, larger: _Larger) -> _Draft:
    """Two robots change places through a corridor in which most of them cannot pass each other, some not even turn."""
    width, y, length = _gap(random, 0.6, 1.4, larger), _uniform(random, 1.0, 4.0), _uniform(random, 0.2, 3.5)
    boxes = _pierced(Pose(4.0, y, math.pi / 2.0), width, length)
    left = Pose(*_within(random, 0.5, 0.6, 1.7, 4.4), _heading(random))
    right = Pose(*_within(random, 6.3, 0.6, 7.5, 4.4), _heading(random))
    goals = [[_within(random, 6.3, 0.6, 7.5, 4.4)], [_within(random, 0.5, 0.6, 1.7, 4.4)]]
    return _Draft((8.0, 5.0), boxes, [left, right], goals, hints=bool(random.random() < HINTED))


def _along_wall(random: np.random.Generator, larger: _Larger) -> _Draft:
    """A robot stands along a wall, too near to turn."""
    heading = float(random.choice([0.0, math.pi])) + _uniform(random, -0.02, 0.02)
    start = Pose(_uniform(random, 1.0, 6.0), WALL + _uniform(random, 0.205, 0.26) + larger.beside, heading)
    goals = [_within(random, 0.5, 2.0, 6.5, 4.5), _within(random, 0.5, 0.5, 6.5, 4.5)]
    return _Draft((7.0, 5.0), [], [start], [goals])


def _drift(random: np.random.Generator, larger: _Larger) -> _Draft:
    """The map of another robot shows the walls beside where they are."""
    middle = Pose(3.5, _uniform(random, 1.0, 4.0), math.pi / 2.0)
    boxes = _pierced(middle, _gap(random, 0.8, 1.0, larger))
    boxes.append((*_within(random, 1.0, 1.0, 2.5, 4.0), 1.2, 0.6, _heading(random)))
    start = Pose(*_within(random, 0.5, 0.5, 2.5, 4.5), _heading(random))
    off, bearing = _uniform(random, *DRIFT), _heading(random)
    error = Pose(off * math.cos(bearing), off * math.sin(bearing), _uniform(random, -0.02, 0.02))
    return _Draft((7.0, 5.0), boxes, [start], [_there_and_back(random)], error)


KINDS: dict[str, Callable[[np.random.Generator, _Larger], _Draft]] = {
    "narrow door": _narrow_door,
    "jamb": _jamb,
    "desks": _desks,
    "slanted walls": _slanted,
    "dead end": _dead_end,
    "head on": _head_on,
    "along a wall": _along_wall,
    "drifted map": _drift,
}
