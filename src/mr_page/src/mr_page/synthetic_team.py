"""A team that explores a made-up floor, for tests and measurements of pages: robots go from room to room, know what is
near them, hear those within reach, and tell all of it as robots do. From a seed, in virtual time."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mr_grid import OccupancyGrid, Pose
from mr_page.commands import PASS_ON, SET_LIMITS, Answer, Order
from mr_page.state import PageState
from mr_page.watch import RobotWatch

CELLS = 2000  # a side of the floor
RESOLUTION = 0.05  # m
ROOM = 200  # cells a side
DOOR = 24  # cells
SIGHT = 5.0  # m
REACH = 40.0  # m of the radio
SPEED = 0.5  # m/s
STEP = 0.1  # s
MAP_PERIOD = 2.0  # s
AUCTION_PERIOD = 4.0  # s between two auctions of a robot
COMMANDS = ("start", "pause", "resume", "stop", "go_home", SET_LIMITS)
CONTROL = (
    "team_pause",
    "pass_on_start",
    "pass_on_pause",
    "pass_on_resume",
    PASS_ON + SET_LIMITS,
)  # offered by the first robot


def floor() -> np.ndarray:
    """Rooms with a door to each neighbour, int8 (CELLS, CELLS), 0 free, 100 wall."""
    cells = np.zeros((CELLS, CELLS), dtype=np.int8)
    for edge in range(0, CELLS + 1, ROOM):
        low, high = max(0, edge - 2), min(CELLS, edge + 2)
        cells[low:high, :] = cells[:, low:high] = 100
    for edge in range(ROOM, CELLS, ROOM):
        for middle in range(ROOM // 2, CELLS, ROOM):
            door = slice(middle - DOOR // 2, middle + DOOR // 2)
            cells[edge - 2 : edge + 2, door] = cells[door, edge - 2 : edge + 2] = 0
    rng = np.random.default_rng(5)
    for _ in range(500):  # furniture
        row, column = rng.integers(10, CELLS - 30, 2)
        if 30 < row % ROOM < 80 and 30 < column % ROOM < 170:
            cells[row : row + rng.integers(6, 20), column : column + rng.integers(6, 20)] = 100
    return cells


class SyntheticRobot:
    """`place`: its start in the world, with a heading of whole quarter turns. `known`: cells that it has seen."""

    def __init__(self, name: str, number: int, rng: np.random.Generator) -> None:
        self.name = name
        self.state = PageState()
        self.watch = RobotWatch(self.state, name)
        self.room = (4 + number // 4, 3 + number % 4)
        x, y = self.centre(self.room)
        self.place = Pose(x, y, number % 4 * math.pi / 2.0)
        self.quarters = number % 4
        self.position = (x, y)
        self.heading = 0.0
        self.known = np.zeros((CELLS, CELLS), dtype=bool)
        self.goals: list[tuple[int, int]] = []
        self.bytes_sent = 0
        self.paused = False
        self.limits = [0.0, 0.0]
        self.map_due = 0.3 * number
        self._rng = rng
        self.watch.about(start=[round(value, 4) for value in self.place], base=False)
        self.watch.services({
            **{command: number > 0 or command != "go_home" for command in COMMANDS},
            **{command: number == 0 for command in CONTROL},
        })  # fmt: skip
        self.orders: list[str] = []  # that were passed on to it

    @staticmethod
    def centre(room: tuple[int, int]) -> tuple[float, float]:
        return (room[1] + 0.5) * ROOM * RESOLUTION, (room[0] + 0.5) * ROOM * RESOLUTION

    def drive(self, seconds: float, now: float) -> None:
        if self.paused:
            return
        if not self.goals:
            self._choose()
        x, y = self.centre(self.goals[0])
        dx, dy = x - self.position[0], y - self.position[1]
        way = math.hypot(dx, dy)
        if way < SPEED * seconds:
            self.position, self.room = (x, y), self.goals.pop(0)
            return
        self.heading = math.atan2(dy, dx)
        share = SPEED * seconds / way
        self.position = (self.position[0] + share * dx, self.position[1] + share * dy)

    def _choose(self) -> None:
        moves = [(0, 1), (1, 0), (0, -1), (-1, 0)]
        rooms = [(self.room[0] + r, self.room[1] + c) for r, c in moves]
        inside = [room for room in rooms if min(room) >= 0 and max(room) < CELLS // ROOM]
        fresh = [room for room in inside if not self.known[room[0] * ROOM + 100, room[1] * ROOM + 100]]
        choice = fresh or inside
        self.goals = [choice[int(self._rng.integers(len(choice)))]]

    def look(self, cells: np.ndarray) -> None:
        """See what is in the room and near."""
        row, column = int(self.position[1] / RESOLUTION), int(self.position[0] / RESOLUTION)
        reach = int(SIGHT / RESOLUTION)
        top, bottom = max(row - reach, row // ROOM * ROOM - 2, 0), min(row + reach, row // ROOM * ROOM + ROOM + 2)
        left, right = (
            max(column - reach, column // ROOM * ROOM - 2, 0),
            min(column + reach, column // ROOM * ROOM + ROOM + 2),
        )
        rows, columns = np.ogrid[top:bottom, left:right]
        near = (rows - row) ** 2 + (columns - column) ** 2 < reach**2
        self.known[top:bottom, left:right] |= near[: cells.shape[0] - top, : cells.shape[1] - left]

    def local(self, x: float, y: float) -> tuple[float, float]:
        """A point of the world in the map frame of the robot."""
        inverse = self.place.inverse()
        return inverse.apply_point(x, y)

    def grid(self, cells: np.ndarray, known: np.ndarray) -> OccupancyGrid:
        """What is known, in the map frame of the robot, cut to a multiple of 32 cells around it."""
        rows, columns = np.nonzero(known.any(axis=1))[0], np.nonzero(known.any(axis=0))[0]
        top, bottom = rows[0] // 32 * 32, min(CELLS, (rows[-1] // 32 + 1) * 32)
        left, right = columns[0] // 32 * 32, min(CELLS, (columns[-1] // 32 + 1) * 32)
        part = np.where(known[top:bottom, left:right], cells[top:bottom, left:right], -1).astype(np.int8)
        turned = np.ascontiguousarray(np.rot90(part, self.quarters))
        corners = [self.local(RESOLUTION * x, RESOLUTION * y) for x in (left, right) for y in (top, bottom)]
        origin = Pose(min(x for x, _ in corners), min(y for _, y in corners))
        return OccupancyGrid.of(turned, RESOLUTION, origin)


class SyntheticTeam:
    """`robots` of them after `explored` s of exploration; advance it by calls of `step`, each STEP s long."""

    def __init__(self, robots: int = 8, seed: int = 1, explored: float = 0.0) -> None:
        self.now = 100.0
        self._cells = floor()
        rng = np.random.default_rng(seed)
        self.robots = [SyntheticRobot(f"robot_{index}", index, rng) for index in range(robots)]
        self._rng = rng
        self._told_at = -math.inf
        self._tell_slowly()
        while self.now < 100.0 + explored:
            self._move(2.0)
            self._tell_slowly()
        for robot in self.robots:
            self._tell_maps(robot)

    def step(self) -> None:
        self._move(STEP)
        self._tell_slowly()
        for robot in self.robots:
            if self.now >= robot.map_due:
                robot.map_due = self.now + MAP_PERIOD
                self._tell_maps(robot)

    def obey(self, robot: SyntheticRobot, order: Order) -> Answer:
        """Synthetic robots can pause, go on and take limits; the first one passes the former on."""
        command = order.command.removeprefix(PASS_ON)
        if command == SET_LIMITS:
            for other in self.robots:
                if other.name == (order.to or robot.name):
                    other.limits = list(order.limits)
            return Answer(True, f"ends after {order.limits[0]:g} s or {order.limits[1]:g} m")
        if command not in ("pause", "resume"):
            return Answer(False, f"{command} is not made up")
        for other in self.robots if order.to else [robot]:
            if order.to in ("", other.name):
                other.paused = command == "pause"
                other.orders += [command] if order.to else []
        return Answer(True, f"{command}: sent to {order.to}" if order.to else "paused" if robot.paused else "goes on")

    def _move(self, seconds: float) -> None:
        self.now += seconds
        for robot in self.robots:
            robot.drive(seconds, self.now)
            robot.look(self._cells)
            x, y = robot.local(*robot.position)
            robot.watch.time(self.now)
            robot.watch.pose(Pose(x, y, math.remainder(robot.heading - robot.place.yaw, 2.0 * math.pi)))

    def _tell_maps(self, robot: SyntheticRobot) -> None:
        robot.watch.map("local", robot.grid(self._cells, robot.known))
        united = np.logical_or.reduce([other.known for other in self.robots])
        robot.watch.map("global", robot.grid(self._cells, united))

    def _tell_slowly(self) -> None:
        """What robots tell once a second."""
        if self.now - self._told_at < 1.0:
            return
        self._told_at = self.now
        for robot in self.robots:
            self._tell_exploration(robot)
            robot.watch.merger(self._merger(robot), self.now)
            robot.watch.network(self._network(robot), self.now)
        self.robots[0].watch.team(self._overview(), self.now)

    def _tell_exploration(self, robot: SyntheticRobot) -> None:
        begun = self.now > 100.0
        goal = robot.goals[0] if robot.goals else robot.room
        place = [round(value, 2) for value in robot.local(*robot.centre(goal))]
        frontiers = [robot.local(*self._beside(robot, angle)) for angle in np.linspace(0.0, 2.0 * math.pi, 40)]
        other = self.robots[(self.robots.index(robot) + 1) % len(self.robots)]
        bids = {robot.name: 7.2, other.name: 9.1}
        robot.watch.exploration(
            {
                "state": "exploring" if begun else "starting", "text": "drives to a frontier", "finished": False,
                "time": round(self.now - 100.0), "frontiers": 120, "clusters": 4, "unreachable": 1,
                "goals_reached": int(self.now / 20), "auctions_completed": 12, "auctions_uncompleted": 1,
            },
            self.now,
        )  # fmt: skip
        robot.watch.decision(
            {
                "paused": robot.paused, "ended_by": "", "goal": place if begun else None,
                "reason": f"bid 7.2 m, the lowest of 4 clusters; {other.name} bids 9.1 m", "strategy": "tours",
                "bids": bids, "unit": 7, "shares": {robot.name: place}, "left": [], "team_finished": [],
                "auction_id": int((self.now - 100.0) / AUCTION_PERIOD),
                "auction": self._auction(robot, other, place, bids) if begun else [],
                "area": round(float(np.count_nonzero(robot.known)) * RESOLUTION**2, 1), "rest": 300,
                "limits": robot.limits, "way": round(SPEED * max(0.0, self.now - 100.0)),
            },
            self.now,
        )  # fmt: skip
        robot.watch.points("frontiers", frontiers)
        robot.watch.cluster(0, frontiers[:8])
        robot.watch.cluster(1, frontiers[20:26])
        robot.watch.points("plan", [robot.local(*robot.position), place])

    def _auction(
        self, robot: SyntheticRobot, other: SyntheticRobot, place: list[float], bids: dict[str, float]
    ) -> list[list[Any]]:
        """What two of the robots explore, a cluster that only one knows, and three for which all bid in vain."""
        there = [round(value, 2) for value in robot.local(*robot.centre(other.goals[0] if other.goals else other.room))]
        lost = {robot.name: 12.4, other.name: 3.3}
        offers = [[*place, bids, robot.name], [*there, lost, other.name], [1.0, 2.0, {robot.name: 20.5}, ""]]
        for room in ((2, 2), (2, 7), (7, 7)):
            x, y = robot.centre(room)
            told = {one.name: round(math.dist(one.position, (x, y)), 2) for one in self.robots}
            offers.append([*(round(value, 2) for value in robot.local(x, y)), told, ""])
        return offers

    def _overview(self) -> dict[str, Any]:
        members = {
            robot.name: {
                "state": "exploring", "text": "drives to a frontier", "merging": "", "area": 100, "in_reach": True,
                "age": 0, "order": (robot.orders or [""])[-1], "answered": True, "answer": "done",
                "number": len(robot.orders),
            }
            for robot in self.robots[1:]
        }  # fmt: skip
        return {"text": "", "robots": members}

    @staticmethod
    def _beside(robot: SyntheticRobot, angle: float) -> tuple[float, float]:
        """A point at the edge of what a robot sees."""
        return robot.position[0] + SIGHT * math.cos(angle), robot.position[1] + SIGHT * math.sin(angle)

    def _merger(self, robot: SyntheticRobot) -> dict[str, Any]:
        """The last robot of the team is placed by nobody."""
        entries = []
        for other in self.robots:
            if other is robot:
                continue
            placed = self.robots[-1] not in (robot, other) and self.now > 102.0
            pose = robot.place.between(other.place) if placed else Pose()
            why = "31.4 m of wall agree, 0.03 m off" if placed else "no wall in common yet: 0.8 m of 4 m"
            entries.append(
                {
                    "robot": other.name, "placed": placed, "why": why, "via": "", "pose": [round(v, 4) for v in pose],
                    "confidence": 0.97 if placed else 0.1, "shared_wall": 31.4, "age": 0, "bytes": 120000,
                }
            )  # fmt: skip
        return {"topology": "distributed", "base_station": "", "robots": entries, "wants_to_meet": []}

    def _network(self, robot: SyntheticRobot) -> dict[str, Any]:
        links, routes = [], []
        for other in self.robots:
            way = math.dist(robot.position, other.position)
            if other is robot:
                continue
            if way < REACH:
                loss = round(min(0.9, (way / REACH) ** 4 + 0.02 * float(self._rng.random())), 2)
                links.append({"robot": other.name, "two_way": True, "loss": loss, "waiting": 0})
            routes.append({"to": other.name, "via": other.name, "hops": 1 if way < REACH else 2, "cost": 1.2})
        robot.bytes_sent += int(4000 + 3000 * self._rng.random())
        return {
            "interface": "radio0", "up": True, "sealed": True, "robots": [other.name for other in self.robots],
            "links": links, "routes": routes, "relays": 0, "waiting": 2, "doubted": 0, "hops": [100, 20],
            "groups": [{"group": f"mc_{robot.name}", "root": True, "member": True, "connected": True, "uplink": "",
                        "downlinks": [link["robot"] for link in links[:2]]}],
            "frames_sent": 1000, "bytes_sent": robot.bytes_sent, "frames_received": 3000,
            "bytes_received": 3 * robot.bytes_sent, "packets_sent": 500, "packets_failed": 3,
        }  # fmt: skip
