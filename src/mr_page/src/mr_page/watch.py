"""What is told of one robot over time becomes what its page shows: values, trail, events, choices. Knows no ROS."""

from __future__ import annotations

import math
from typing import Any, Mapping, Sequence

import numpy as np

from mr_grid import OccupancyGrid, Pose
from mr_page.numbers import is_finite
from mr_page.state import PageState

TRAIL_STEP = 0.1  # m between two points of the trail
AREA_PERIOD = 2.0  # s between two samples of the known area
NEW_GOAL = 0.5  # m; a goal that moves less follows its frontier
LOG_LINES = 10  # a second at most
SAME_LINE = 20.0  # s in which a line of a node is not told again
REFUSED = "Exception thrown while processing service call: "  # roscpp's words before a refusal, which is no fault
TEXT = 400  # characters of a line that is shown
POINTS = 1000  # of a kind that are shown

Values = Mapping[str, Any]


class RobotWatch:
    """Fills the state of one robot. Times `now` in s on the robot's clock, lengths in m in its map frame."""

    def __init__(self, state: PageState, robot: str) -> None:
        self._state = state
        self._robot = robot
        self._trail: tuple[float, float] | None = None
        self._driven = 0.0
        self._area_at = -math.inf
        self._choice: tuple[float, float] | None = None
        self._auction: int | None = None  # number of the one that was told last
        self._placed: dict[str, bool] = {}
        self._neighbors: set[str] | None = None
        self._traffic: tuple[float, int, int] | None = None
        self._logged: tuple[int, int] = (0, 0)  # second, and lines in it
        self._lines: dict[tuple[str, str], float] = {}  # node and text: when it was told
        self._stage: str | None = None
        self._answers: dict[str, int] = {}  # robot: number of the order that it has answered last

    def about(self, **values: Any) -> None:
        """What does not change: `start` (its map frame in the world, if known), `base` (a base station), ..."""
        self._state.put(self._robot, "about", values)

    def time(self, now: float) -> None:
        self._state.put(self._robot, "time", round(now, 1))
        if self._state.get(self._robot, "begin") is None:
            self._state.put(self._robot, "begin", round(now, 1))

    def pose(self, pose: Pose | None) -> None:
        """None: it is not known at the moment."""
        if pose is None or not is_finite(*pose):
            self._state.put(self._robot, "pose", None)
            return
        self._state.put(self._robot, "pose", [round(pose.x, 2), round(pose.y, 2), round(pose.yaw, 2)])
        step = math.inf if self._trail is None else math.dist(self._trail, pose[:2])
        if step >= TRAIL_STEP:
            self._driven += step if self._trail is not None else 0.0
            self._trail = (pose.x, pose.y)
            self._state.append(self._robot, "trail", [round(pose.x, 2), round(pose.y, 2)])
            self._state.put(self._robot, "driven", round(self._driven, 1))

    def exploration(self, values: Values, now: float) -> None:
        """Of explorer/ExplorationState."""
        self._state.put(self._robot, "state", dict(values))
        stage = str(values["state"])
        if self._stage not in (None, stage):
            self._event(now, stage, f"{self._robot}: {stage}")
        if stage == "starting":
            self._state.put(self._robot, "begin", round(now, 1))
        self._stage = stage

    def decision(self, values: Values, now: float) -> None:
        """Of explorer/ExplorationStatus: what the robot explores and why, and all bids of its last auction, which is
        news once."""
        told = dict(values)
        number, offers = told.pop("auction_id"), told.pop("auction")
        if offers and number != self._auction:
            self._auction = number
            self._state.append(self._robot, "auctions", [round(now, 1), number, values["unit"], offers])
        self._state.put(self._robot, "decision", told)
        if not 0.0 <= now - self._area_at < AREA_PERIOD:  # also when the clock was set back
            self._area_at = now
            self._state.append(self._robot, "area", [round(now, 1), values["area"]])
        goal = values["goal"]
        if goal is None:
            self._choice = None
        elif self._choice is None or math.dist(self._choice, goal) > NEW_GOAL:
            self._choice = (goal[0], goal[1])
            self._state.append(
                self._robot, "choices", [round(now, 1), *goal, values["reason"][:TEXT], values["bids"], values["unit"]]
            )

    def merger(self, values: Values, now: float) -> None:
        """Of map_merger/MergerStatus: which robots are placed, or why they are not."""
        self._state.put(self._robot, "merger", dict(values))
        for other in values["robots"]:
            name, placed = other["robot"], other["placed"]
            if name != self._robot and placed != self._placed.get(name, False):
                kind, verb = ("placed", "placed") if placed else ("revoked", "gave up the place of")
                self._event(now, kind, f"{self._robot} {verb} {name}: {other['why']}", name)
            self._placed[name] = placed

    def network(self, values: Values, now: float) -> None:
        """Of adhoc_communication/NetworkState."""
        self._state.put(self._robot, "network", dict(values))
        self._note_traffic(values, now)
        neighbors = {link["robot"] for link in values["links"] if link["two_way"] and link["robot"]}
        for name in sorted(neighbors ^ (self._neighbors if self._neighbors is not None else neighbors)):
            text = f"hears {name}" if name in neighbors else f"does not hear {name} any more"
            self._event(now, "link", f"{self._robot} {text}", name)
        self._neighbors = neighbors

    def _note_traffic(self, values: Values, now: float) -> None:
        sent, received = values["bytes_sent"], values["bytes_received"]
        if self._traffic is not None and now > self._traffic[0]:
            length = now - self._traffic[0]
            grown = (sent - self._traffic[1], received - self._traffic[2])  # negative when the radio has begun anew
            rates = [max(0, round(count / length)) for count in grown]
            self._state.append(self._robot, "traffic", [round(now, 1), *rates])
        self._traffic = (now, sent, received)

    def points(self, name: str, points: Sequence[Sequence[float]]) -> None:
        """Places, such as "frontiers", "plan" or "peers"; more than POINTS of them are thinned evenly."""
        thinned = points[:: -(-len(points) // POINTS) or 1]
        self._state.put(self._robot, name, [[round(x, 2), round(y, 2)] for x, y in thinned if is_finite(x, y)])

    def team(self, values: Values, now: float) -> None:
        """Of explorer/TeamOverview: what the others have told over the radio."""
        self._state.put(self._robot, "team", dict(values))
        for name, member in values["robots"].items():
            if member["answered"] and member["number"] != self._answers.get(name, member["number"]):
                self._event(now, "command", f"{name}: {member['order']}: {member['answer']}", name)
            self._answers[name] = member["number"]

    def peers(self, places: Mapping[str, tuple[float, float]]) -> None:
        """Where other robots are."""
        known = {name: place for name, place in places.items() if is_finite(*place)}
        self._state.put(self._robot, "peers", {name: [round(x, 2), round(y, 2)] for name, (x, y) in known.items()})

    def cluster(self, number: int, points: Sequence[Sequence[float]]) -> None:
        clusters = list(self._state.get(self._robot, "clusters", []))
        clusters += [[] for _ in range(number + 1 - len(clusters))]
        clusters[number] = [[round(x, 1), round(y, 1)] for x, y in points[:200] if is_finite(x, y)]
        self._state.put(self._robot, "clusters", clusters)

    def services(self, offered: Mapping[str, bool]) -> None:
        """Which commands there are services for."""
        self._state.put(self._robot, "services", dict(offered))

    def map(self, kind: str, grid: OccupancyGrid) -> None:
        tiled = self._state.map(self._robot, kind)
        tiled.take(grid)
        self._state.put(self._robot, f"clipped {kind}", tiled.clipped)

    def patch(self, kind: str, row: int, column: int, cells: np.ndarray) -> None:
        """A changed part of the last map; without effect where it does not fit, since the next whole map tells all."""
        try:
            self._state.map(self._robot, kind).patch(row, column, cells)
        except ValueError:
            return

    def log(self, level: str, node: str, text: str, now: float) -> None:
        """A line of a node's log; at most LOG_LINES a second, the others are left out, and none again at once."""
        self._lines = {line: at for line, at in self._lines.items() if 0.0 <= now - at < SAME_LINE}
        text = text.removeprefix(REFUSED)
        second, count = self._logged
        count = count if int(now) == second else 0
        if (node, text) in self._lines or count >= LOG_LINES:
            return
        self._lines[node, text] = now
        self._logged = (int(now), count + 1)
        self._state.append(self._robot, "log", [round(now, 1), level, node.strip("/"), text[:TEXT]])

    def answered(self, command: str, done: bool, text: str, now: float) -> None:
        """How a command from the page went."""
        told = text or ("done" if done else "refused")
        self._event(now, "command" if done else "failed", f"{self._robot}: {command}: {told}")

    def _event(self, now: float, kind: str, text: str, other: str = "") -> None:
        self._state.append(self._robot, "events", [round(now, 1), kind, text[:TEXT], other])
