"""One mission: who owns what, and the order of a step."""

from typing import Optional, Sequence

from explorer.auctions import Auctions, comparable
from explorer.claim import OwnClaim
from explorer.driver import Driver, GoalEvent, at_home
from explorer.ending import Ending
from explorer.foreign import Element, ForeignFrontiers
from explorer.journal import Journal
from explorer.leftovers import sentence
from explorer.messages import FAILED, REACHED, Auction, Emit, Note
from explorer.options import Options
from explorer.outcomes import Outcomes
from explorer.perception import Perception
from explorer.scene import Scene
from explorer.scene_maker import SceneMaker
from explorer.selections import selection_for
from explorer.senses import Senses
from explorer.sharing import Sharing
from explorer.status import Counters, State
from explorer.strategies.strategy import Strategy
from explorer.team import Team
from explorer.verdicts import Verdicts

MAXIMUM_CLAIMED = 5000  # elements of one claim that are read


class Exploration:
    """`senses`, `perception` and `foreign` outlive it; `last_goal`, `last_auction` are numbers of former missions."""

    def __init__(
        self,
        options: Options,
        strategy: Strategy,
        senses: Senses,
        perception: Perception,
        foreign: ForeignFrontiers,
        emit: Emit,
        last_goal: int,
        last_auction: int,
    ) -> None:
        name = options.robot_name
        self._name, self._strategy, self._emit = name, strategy, emit
        self._senses, self._perception, self._foreign = senses, perception, foreign
        self.state, self.text = State.STARTING, "waits for the start"
        self.started_at: Optional[float] = None
        self.finished_at: Optional[float] = None
        self.team = Team(name, options.claim_timeout)
        self.verdicts = Verdicts()
        self.claim = OwnClaim(name)
        self.driver = Driver(options, emit, last_goal)
        self.auctions = Auctions(name, self.team, options.auction_timeout, emit, last_auction)
        self.sharing = Sharing(name, self.team, perception.frontiers, self.verdicts, emit)
        self.ending = Ending(options.finish_delay, perception, self.verdicts, self.driver, self.claim, emit)
        self._outcomes = Outcomes(
            options.number_unreachable_for_cluster, perception, self.verdicts, self.team, self.claim, emit
        )
        self._selection = selection_for(
            strategy, self.driver, self.claim, self.auctions, self.sharing, self.team, name, emit
        )
        self._scenes = SceneMaker(name, senses, perception, self.verdicts, self.team, foreign, self.claim)
        self._journal = Journal(options, emit)

    # ---- input ----------------------------------------------------------------------------------------------------

    def start(self, now: float) -> bool:
        """False if it was started before."""
        if self.started_at is not None:
            return False
        self.started_at = now
        self._journal.start(now)
        return True

    def take_robots(self, names: Sequence[str]) -> None:
        """All robots that the radio reaches now."""
        came, left = self.team.set_known(names)
        if came:
            self.sharing.welcome(came)
        if left:
            self._perception.touch()

    def take_explored(self, elements: Sequence[Element], now: float) -> None:
        """Points that another robot has explored: own points there are not goals until the map had time to show it."""
        for element in elements:
            self._foreign.remove(element.key)
            place = self._foreign.to_own_frame(element)
            if place is not None:
                self.verdicts.believe_explored(*place, now)

    def take_choice(self, elements: Sequence[Element], now: float) -> None:
        """The clusters that others have chosen (strategies 5 and 6)."""
        for robot in sorted({element.detected_by for element in elements}):
            self.team.heard(robot)
            self.team.claim(robot, [e.key for e in elements if e.detected_by == robot], now)

    def take_auction(self, auction: Auction, now: float) -> None:
        if auction.robot == self._name or self.team.peer(auction.robot) is None:
            return
        self.team.heard(auction.robot)
        if not auction.status:
            self.auctions.take_bids(auction)
        elif auction.start:
            self._answer(auction, now)
        elif auction.finished:
            bid = self.auctions.take_end(auction)
            self.team.claim(auction.robot, auction.occupied[:MAXIMUM_CLAIMED], now, bid)
            if self._perception.ways is not None and self._senses.pose is not None:
                self._selection.settle(auction.robot, self._scenes.scene(now))

    def _answer(self, auction: Auction, now: float) -> None:
        self.auctions.take_start(auction, now)
        finished = self.finished_at is not None
        if finished or self._senses.pose is None or not comparable(auction, self._foreign, self._name):
            self.auctions.refuse(auction)
        elif self._perception.ways is None:
            self.auctions.answer(auction, (), lambda _: -1.0, self._foreign)
        else:
            scene = self._scenes.scene(now)
            self.auctions.answer(auction, scene.candidates, lambda c: self._strategy.bid(scene, c), self._foreign)

    def take_result(self, goal_id: int, outcome: str, text: str, now: float) -> None:
        event = self.driver.take_result(goal_id, outcome, text, now)
        if event is None:
            return
        if self.state == State.RETURNING:
            self.driver.end_home(outcome, now)
        elif event.goal.frontier is None:
            self.ending.look_again()
        elif outcome in (REACHED, FAILED):
            self._take_event(event, now)
        self._perception.touch()

    # ---- the step -------------------------------------------------------------------------------------------------

    def step(self, now: float) -> None:
        if self.started_at is None:
            self._be(State.STARTING, "waits for the start")
        elif self._senses.map is None or self._senses.pose is None:
            self._be(State.STARTING, "waits for " + ("the map" if self._senses.map is None else "the robot's pose"))
        elif self.finished_at is not None:
            self._go_home(now)
        else:
            self._explore(now)
        if self.started_at is not None and self.finished_at is None and self._journal.due(now):
            self._journal.write(self.counters, self.unreachable_count(), self._senses.map, now)

    def _explore(self, now: float) -> None:
        here = self._senses.pose
        assert here is not None
        others, known = list(self.team.positions(now).values()), len(self.team.known())
        self.sharing.take_vanished(self._perception.update(self.verdicts, others, known, now))
        self.sharing.ask_transforms(self._foreign.robots(), now)
        event = self.driver.watch(here, now)
        if event is not None:
            self._take_event(event, now)
        scene = self._scenes.scene(now)
        if self.ending.reached(scene, self._senses.fresh(now)):
            self._finish(now)
            return
        self._allocate(scene, now)
        self.sharing.share(now)
        self._tell_state()

    def _allocate(self, scene: Scene, now: float) -> None:
        auction = self.auctions.close_if_complete(now)
        if auction is not None:
            self._selection.close(auction.auction_id, auction.bids, self._scenes.scene(now))
            scene = self._scenes.scene(now)
        if self.driver.may_send(now):
            self._selection.select(scene)
        self._selection.confirm(scene)

    def _tell_state(self) -> None:
        goal = self.driver.goal
        if goal is not None:
            self._be(State.EXPLORING, f"drives to ({goal.pose.x:.1f}, {goal.pose.y:.1f})")
        elif any(cluster.reachable for cluster in self._perception.clusters):
            self._be(State.WAITING, "frontiers are left, none is for this robot now")
        else:
            self._be(State.WAITING, "sees no frontier, waits for the map to confirm it")

    def _take_event(self, event: GoalEvent, now: float) -> None:
        assert self._senses.pose is not None
        self._outcomes.take(event, self._senses.pose, now)
        self._perception.touch()

    def _finish(self, now: float) -> None:
        self.finished_at = now
        self.driver.drop()
        self.claim.release()
        self._selection.finish(self._scenes.scene(now))
        self._emit(Note(f"exploration finished after {self.exploration_time(now):.1f} s"))
        self._emit(Note(sentence(self._perception.leftovers())))
        self._journal.finish(self.counters, self._senses.map, now)
        self._go_home(now)

    def _go_home(self, now: float) -> None:
        here, home = self._senses.pose, self._senses.home
        assert here is not None and home is not None
        if self.state == State.FINISHED:
            return
        if self.driver.home_is_over(here, home):
            self.driver.drop()
            self._be(State.FINISHED, f"finished, {'at home' if at_home(here, home) else 'away from home'}")
            return
        self._be(State.RETURNING, "finished, drives home")
        event = self.driver.watch(here, now)
        if event is not None:
            self._take_event(event, now)
            self.driver.end_home(FAILED, now)
        self.driver.drive_home(here, home, now)

    def _be(self, state: State, text: str) -> None:
        self.state, self.text = state, text

    # ---- figures --------------------------------------------------------------------------------------------------

    @property
    def counters(self) -> Counters:
        return Counters(
            goals=self.driver.goals,
            goals_reached=self.driver.reached,
            goals_failed=self.driver.failed,
            auctions_completed=self.auctions.completed,
            auctions_uncompleted=self.auctions.uncompleted,
            maps=self._senses.maps,
            distance=self._senses.distance,
        )

    def exploration_time(self, now: float) -> float:
        """Seconds from the start of the mission, fixed once finished (T_r)."""
        if self.started_at is None:
            return 0.0
        return (self.finished_at if self.finished_at is not None else now) - self.started_at

    def unreachable_count(self) -> int:
        """Frontiers that are given up, or that no reachable place sees."""
        return self._perception.unreachable(self.verdicts)
