"""Small scenes for the tests of meetings: discs among walls, seen by lasers, in virtual time and without ROS."""

import math
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from map_merger.meetings.meetings import Meetings
from map_merger.meetings.values import Hypothesis, LaserScan, TrackReport
from map_merger.robot_size import USUAL_SIZE, RobotSize
from mr_grid import Pose

Way = Callable[[float], Pose]
"""Where something is at a time (s), in the world."""

BODY_M = 0.2
WIDE = math.radians(270.0)
NARROW = math.radians(57.0)


class Wall(NamedTuple):
    """From one point to another, m."""

    x0: float
    y0: float
    x1: float
    y1: float


def room(width: float, depth: float) -> List[Wall]:
    """Around the origin, with a corner cut off so that it has no symmetry."""
    x, y = 0.5 * width, 0.5 * depth
    corners = [(-x, -y), (x, -y), (x, 0.4 * y), (0.5 * x, y), (-x, y)]
    return [Wall(*first, *second) for first, second in zip(corners, corners[1:] + corners[:1])]


def standing(x: float, y: float, yaw: float = 0.0) -> Way:
    return lambda time: Pose(x, y, yaw)


def driving(
    x: float, y: float, yaw: float = 0.0, speed: float = 0.4, turn: Callable[[float], float] = lambda time: 0.0
) -> Way:
    """Stands for 2 s, then drives with the turn rate (rad/s) that `turn` gives for a time since then (s)."""
    step = 0.05
    poses = [Pose(x, y, yaw)]
    for index in range(1200):
        last = poses[-1]
        heading = last.yaw + turn(index * step) * step
        poses.append(
            Pose(last.x + speed * step * math.cos(heading), last.y + speed * step * math.sin(heading), heading)
        )
    return lambda time: poses[min(max(0, round((time - 2.0) / step)), len(poses) - 1)]


class Actor(NamedTuple):
    """A robot. view: rad. radio: whether it tells and hears anything."""

    name: str
    way: Way
    view: float = WIDE
    farthest: float = 8.0
    nearest: float = 0.0
    radio: bool = True
    boot: Tuple[int, int] = (1, 0)


class Scene:
    """Robots, discs that are no robots, and walls. Each robot's map frame is its pose at the start."""

    def __init__(
        self,
        robots: Sequence[Actor],
        walls: Sequence[Wall] = (),
        others: Sequence[Way] = (),
        seed: int = 1,
        loss: float = 0.1,
        late: float = 0.3,
        worlds: Optional[Dict[str, int]] = None,
        jumps: Optional[Dict[str, Tuple[float, Pose]]] = None,
    ) -> None:
        """late: s, the longest delay of a report. worlds: robots in different ones do not see one another. jumps: when
        the SLAM of a robot moves it, and by what in its map frame."""
        self.robots, self.walls, self.others = list(robots), list(walls), list(others)
        self.random = np.random.default_rng(seed)
        self.loss, self.late, self.worlds = loss, late, worlds or {}
        self.meetings = {
            robot.name: Meetings(robot.name, RobotSize(BODY_M, USUAL_SIZE.largest_radius), robot.boot)
            for robot in robots
        }
        self.jumps = jumps or {}
        self.waiting: List[Tuple[float, int, str, TrackReport]] = []
        self.reports: List[Tuple[float, TrackReport]] = []
        self.time = 0.0

    def frame(self, robot: Actor) -> Pose:
        return robot.way(0.0)

    def truth(self, source: str, target: str) -> Pose:
        """Transform of the source's frame to the target's."""
        by_name = {robot.name: robot for robot in self.robots}
        return self.frame(by_name[target]).inverse().compose(self.frame(by_name[source]))

    def believed(self, robot: Actor) -> Pose:
        """Where its SLAM says that it is, in its map frame."""
        pose = self.frame(robot).inverse().compose(robot.way(self.time))
        since, jump = self.jumps.get(robot.name, (math.inf, Pose()))
        return jump.compose(pose) if self.time >= since else pose

    def run(self, until: float) -> "Scene":
        """In steps of 0.1 s."""
        while self.time < until - 1e-9:
            self.step()
        return self

    def step(self) -> None:
        self.time += 0.1
        self._deliver()
        for robot in self.robots:
            meetings = self.meetings[robot.name]
            names = {other.name for other in self.robots if other.radio and other is not robot}
            meetings.on_team(names if robot.radio else (), {})
            pose = self.believed(robot)
            meetings.on_scan(self.scan(robot), pose, self.time)
            report = meetings.report(self.time) if robot.radio else None
            if report is not None:
                self.reports.append((self.time, report))
                self._send(robot, report)

    def _send(self, robot: Actor, report: TrackReport) -> None:
        for other in self.robots:
            if other is robot or not other.radio or self.random.random() < self.loss:
                continue
            delay = 0.02 if self.random.random() < 0.5 else self.random.uniform(0.02, self.late)
            self.waiting.append((self.time + delay, len(self.reports), other.name, report))

    def _deliver(self) -> None:
        due = sorted(item for item in self.waiting if item[0] <= self.time)
        self.waiting = [item for item in self.waiting if item[0] > self.time]
        for _, _, name, report in due:
            self.meetings[name].on_report(report, self.time)

    def scan(self, robot: Actor) -> LaserScan:
        """With 1 cm of noise, half a degree between beams."""
        pose = robot.way(self.time)
        count = round(robot.view / math.radians(0.5)) + 1
        angles = np.linspace(-0.5 * robot.view, 0.5 * robot.view, count)
        beams = np.exp(1j * (angles + pose.yaw))
        ranges = np.full(count, robot.farthest)
        eye = complex(pose.x, pose.y)
        for way in [other.way for other in self.robots if self._sees(robot, other)] + self.others:
            place = way(self.time)
            ranges = np.minimum(ranges, _disc(eye, beams, complex(place.x, place.y)))
        for wall in self.walls:
            ranges = np.minimum(ranges, _segment(eye, beams, wall))
        ranges = ranges + self.random.normal(0.0, 0.01, count) * (ranges < robot.farthest)
        ranges[ranges < robot.nearest] = np.nan
        return LaserScan(ranges, -0.5 * robot.view, angles[1] - angles[0], robot.nearest, robot.farthest)

    def _sees(self, robot: Actor, other: Actor) -> bool:
        return other is not robot and self.worlds.get(robot.name, 0) == self.worlds.get(other.name, 0)

    def hypotheses(self, own: str, robot: str) -> Tuple[Hypothesis, ...]:
        return self.meetings[own].hypotheses(robot, self.time)

    def settled(self, own: str, robot: str) -> Optional[Pose]:
        """The best transform if the sightings leave no doubt."""
        found = self.hypotheses(own, robot)
        return found[0].transform if found and found[0].settled else None


def _disc(eye: complex, beams: np.ndarray, centre: complex) -> np.ndarray:
    along = ((centre - eye) * beams.conjugate()).real
    beside = ((centre - eye) * beams.conjugate()).imag
    inside = (np.abs(beside) < BODY_M) & (along > 0.0)
    return np.where(inside, along - np.sqrt(np.maximum(BODY_M**2 - beside**2, 0.0)), np.inf)


def _segment(eye: complex, beams: np.ndarray, wall: Wall) -> np.ndarray:
    start, edge = complex(wall.x0, wall.y0) - eye, complex(wall.x1 - wall.x0, wall.y1 - wall.y0)
    cross = (beams.conjugate() * edge).imag
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = (start.conjugate() * edge).imag / cross
        share = (start.conjugate() * beams).imag / cross
    hit = (distance > 0.0) & (share >= 0.0) & (share <= 1.0)
    return np.where(hit, distance, np.inf)
