"""Makes the missions of one robot: the first one, and a new one when the clock is set back or the map frame is another
one."""

from typing import Any, Callable, Mapping, Optional

import numpy as np

from explorer.auction import first_auction_id
from explorer.decision import Decision, telling
from explorer.exploration import Exploration
from explorer.foreign import ForeignFrontiers
from explorer.leftovers import reasons
from explorer.messages import Effect
from explorer.options import Options
from explorer.orders import ORDERED, STOPPED
from explorer.perception import Perception
from explorer.scene import Scene
from explorer.senses import Senses
from explorer.strategies import strategy_of
from explorer.strategies.strategy import Bids, Strategy

OnDecision = Callable[[Decision], None]


class Missions:
    """Senses, perception and foreign frontiers outlive a mission, and so does the robot's chance."""

    def __init__(
        self, options: Options, senses: Senses, perception: Perception, foreign: ForeignFrontiers,
        emit: Callable[[Effect], None], on_decision: Optional[OnDecision],
    ) -> None:  # fmt: skip
        """`emit` takes effects; `on_decision` takes each decision of the strategy at the moment when it is made."""
        self._options = options
        self._senses, self._perception, self._foreign = senses, perception, foreign
        self._emit, self._on_decision = emit, on_decision
        self._random = np.random.default_rng(options.seed)

    def first(self) -> Exploration:
        options = self._options
        return self._make(0, first_auction_id(options.robot_name, options.robot_number, options.simulation))

    def anew(self, old: Exploration, now: float) -> Exploration:
        """All times noted so far lie in the future. What has none stays: map, pose, home and the robots that are there.
        Numbers that they know are not given again."""
        old.driver.drop()
        sent = old.sharing.sent()
        self._senses.restart()
        self._perception.restart()
        mission = self._make(old.driver.last_id, old.auctions.last_id)
        mission.sharing.recall(sent)
        mission.hearing.take_robots(old.team.known())
        self._see_again(now)
        if old.started_at is not None:
            mission.start(now)
        if old.orders.ended_by == STOPPED:
            mission.steering.stop(now)
        if old.orders.ended_by in ORDERED and old.orders.homeward:
            mission.steering.go_home(now)
        mission.orders.halt = old.orders.halt
        mission.orders.limits = old.orders.limits
        return mission

    def in_new_frame(self, old: Exploration, now: float) -> Exploration:
        """The map begins anew, in another frame: what was decided in the former one is gone. Start, end, orders, limits
        and the way driven stay, and home where that is known."""
        old.driver.drop()
        distance = self._senses.distance
        self._perception.begin_frame()
        mission = self._make(old.driver.last_id, old.auctions.last_id)
        mission.recall(old.memory, now)
        self._senses.distance = distance
        mission.orders.limits = old.orders.limits
        mission.hearing.take_robots(old.team.known())
        return mission

    def _see_again(self, now: float) -> None:
        if self._senses.map is not None:
            self._senses.take_map(self._senses.map, now)
            self._perception.take_map()
        if self._senses.pose is not None:
            self._senses.take_pose(self._senses.pose, now)

    def _make(self, last_goal: int, last_auction: int) -> Exploration:
        return Exploration(
            self._options, self._strategy(), self._senses, self._perception, self._foreign, self._emit, last_goal,
            last_auction,
        )  # fmt: skip

    def _strategy(self) -> Strategy:
        kind = strategy_of(self._options.frontier_selection)
        return kind(self._random) if self._on_decision is None else telling(kind, self._random, self._tell)

    def _tell(self, scene: Scene, bids: Bids, choice: Optional[int], random: Mapping[str, Any]) -> None:
        assert self._on_decision is not None
        strategy = strategy_of(self._options.frontier_selection).name
        why = reasons(self._perception.clusters, self._perception.worth)
        self._on_decision(Decision(self._options.robot_name, strategy, scene, bids, choice, random, why))
