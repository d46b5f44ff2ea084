"""One mission: who owns what, and the order of a step."""

from typing import Optional

from explorer.agreement import Agreement
from explorer.announcing import Announcing
from explorer.answering import Answering
from explorer.auction_result import AuctionResult, result_of
from explorer.auctions import Auctions
from explorer.claim import OwnClaim
from explorer.course import Course
from explorer.departure import Departure
from explorer.driver import Driver, GoalEvent
from explorer.ending import Ending
from explorer.foreign import ForeignFrontiers
from explorer.hearing import Hearing
from explorer.homecoming import Homecoming
from explorer.journal import Journal
from explorer.leftovers import sentence
from explorer.looking import Looking
from explorer.making_room import MakingRoom
from explorer.memory import Memory
from explorer.messages import FAILED, REACHED, Auction, Emit, Note
from explorer.options import Options
from explorer.orders import DONE, PAUSED, Orders
from explorer.outcomes import Outcomes
from explorer.perception import Perception
from explorer.reopening import Reopening
from explorer.scene import Scene
from explorer.scene_maker import SceneMaker
from explorer.selections import selection_for
from explorer.senses import Senses
from explorer.sharing import Sharing
from explorer.statement import Stage
from explorer.status import Counters, State
from explorer.steering import Steering
from explorer.strategies.strategy import Strategy
from explorer.team import Team
from explorer.verdicts import Verdicts


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
        self._name, self.strategy, self._emit = name, strategy, emit
        self._senses, self._perception = senses, perception
        self._autostart = options.autostart
        self.orders = Orders(options)
        self._course = Course(self.orders)
        self.team = Team(name, options.claim_timeout)
        self._departure = Departure(name, options.field_of_view, options.largest_robot_radius, self.team)
        self.verdicts = Verdicts()
        self.claim = OwnClaim(name)
        self.driver = Driver(options, emit, last_goal)
        self.auctions = Auctions(name, self.team, options.auction_timeout, emit, last_auction, strategy.unit)
        self.last_auction: Optional[AuctionResult] = None
        self.sharing = Sharing(name, self.team, perception.frontiers, self.verdicts, emit)
        self.ending = Ending(options.finish_delay, perception, self.verdicts, self.driver, self.claim, emit)
        self._outcomes = Outcomes(
            options.number_unreachable_for_cluster, perception, self.verdicts, self.team, self.claim, emit
        )
        self.agreement = Agreement(foreign)
        self.looking = Looking(self.team, foreign, self.verdicts, self.agreement, self.sharing, perception)
        self._announcing = Announcing(name, self.team, senses, perception, self.verdicts, self.ending, emit)
        self.hearing = Hearing(
            self.team, foreign, self.verdicts, self.agreement, self.sharing, self._announcing, perception
        )
        self._reopening = Reopening(options.finish_delay, perception)
        self._selection = selection_for(
            strategy, self.driver, self.claim, self.auctions, self.sharing, self.team, name, emit
        )
        self._scenes = SceneMaker(name, senses, perception, self.verdicts, self.team, foreign, self.claim)
        room = MakingRoom(senses, perception, self.team, foreign, options.largest_robot_radius)
        self._homecoming = Homecoming(self._course, self.orders, self.driver, senses, perception, self._outcomes, room)
        self._answering = Answering(
            name, strategy, senses, perception, foreign, self.team, self.auctions, self._selection, self._scenes
        )
        self._journal = Journal(options, emit)
        self.steering = Steering(
            self.orders,
            self._course,
            self.driver,
            self.ending,
            senses,
            awaited=lambda: self._awaited,
            give_up_claim=self._give_up_claim,
            end=self._end,
        )

    @property
    def state(self) -> State:
        return self._course.state

    @property
    def text(self) -> str:
        return self._course.text

    @property
    def started_at(self) -> Optional[float]:
        return self._course.started_at

    @property
    def finished_at(self) -> Optional[float]:
        return self._course.finished_at

    # ---- input ----------------------------------------------------------------------------------------------------

    def start(self, now: float) -> bool:
        """False if it was started or stopped before."""
        if self.started_at is not None or self.finished_at is not None:
            return False
        self._course.started_at = now
        self._journal.start(now)
        return True

    def take_auction(self, auction: Auction, now: float) -> bool:
        """True if the next step should not wait."""
        return self._answering.take(auction, self.finished_at is not None or bool(self.orders.halt), now)

    def take_result(self, goal_id: int, outcome: str, text: str, now: float) -> None:
        event = self.driver.take_result(goal_id, outcome, text, now)
        if event is None:
            return
        if self.state == State.RETURNING:
            self._homecoming.take_result(outcome, now)
        elif event.goal.frontier is None:
            self.ending.look_again()
        elif outcome in (REACHED, FAILED):
            self._take_event(event, now)
        self._perception.touch()

    @property
    def _begun(self) -> bool:
        return self.started_at is not None and self._perception.ways is not None and self._senses.pose is not None

    # ---- the step -------------------------------------------------------------------------------------------------

    def step(self, now: float) -> None:
        if self._begun:
            self._announcing.say(self._stage, now)
        if self.finished_at is not None and self._reopens(now):
            self._reopen()
        if self.state == State.FINISHED and not self._homecoming.makes_room(now):
            return
        awaited = self._awaited
        if awaited:
            self._course.wait_for(awaited)
        elif self.orders.paused:
            self._stand(now)
        elif self.orders.halt:
            self._come_back(now)
        elif self.finished_at is not None:
            self._drive_home(now)
        else:
            self._explore(now)
        if self.started_at is not None and self.finished_at is None and self._journal.due(now):
            self._journal.write(self.counters, self.unreachable_count(), self._senses.map, now)

    @property
    def _awaited(self) -> str:
        """What there is to be before the robot explores or drives home, empty if it can."""
        if self._senses.map is None:
            return "the map"
        if self._senses.pose is None:
            return "the robot's pose"
        if self.started_at is not None or self.finished_at is not None:
            return ""
        return "move_base" if self._autostart else "the start"

    @property
    def _stage(self) -> Stage:
        if self.finished_at is not None:
            return Stage.ENDED if self.orders.complete else Stage.QUIT
        if self.orders.halt:
            return Stage.QUIT
        return Stage.NOTHING_LEFT if self.ending.nothing_left else Stage.EXPLORING

    def _reopens(self, now: float) -> bool:
        """True if a map shows something new that counts, after the robot has ended because nothing was left."""
        if not self.orders.complete or self.orders.halt or not self._reopening.due(now):
            return False
        if self._senses.map is None or self._senses.pose is None:
            return False
        self._perception.touch()
        self.looking.look(now)
        return self._reopening.wanted(self._scenes.scene(now))

    def _reopen(self) -> None:
        self.driver.drop()
        self.ending.look_again()
        self._course.finished_at, self.orders.ended_by = None, None
        self._emit(Note("something new is to be explored; goes on"))
        self._course.be(State.EXPLORING, "goes on")

    def _stand(self, now: float) -> None:
        """What a paused robot does: the others may need what it sees."""
        self._course.be(State.WAITING, PAUSED)
        if self.finished_at is None:
            self.looking.look(now)
            self.sharing.share(now)

    def _come_back(self, now: float) -> None:
        self.looking.look(now)
        self.sharing.share(now)
        self._homecoming.follow_call(now)

    def _explore(self, now: float) -> None:
        here = self._senses.pose
        assert here is not None
        self.looking.look(now)
        limit = self.orders.limits.reached(self.exploration_time(now), self._senses.distance)
        if limit is not None:
            self._finish(limit, now)
            return
        event = self.driver.watch(here, now, self._perception.rest_of_way)
        if event is not None:
            self._take_event(event, now)
        scene = self._scenes.scene(now)
        if self.ending.reached(scene, self._senses.fresh(now)):
            self._finish(DONE, now)
            return
        assert self.started_at is not None
        awaited = self._departure.awaited(self.started_at, here, self._senses.map, now)
        self._allocate(scene, now, not awaited)
        self.sharing.share(now)
        if awaited:
            self._course.be(State.WAITING, f"lets {', '.join(awaited)} drive off first")
        else:
            self._tell_state()

    def _allocate(self, scene: Scene, now: float, may_drive: bool) -> None:
        auction = self.auctions.close_if_complete(now)
        if auction is not None:
            self._selection.close(auction.auction_id, auction.bids, self._scenes.scene(now))
            scene = self._scenes.scene(now)
            self.last_auction = result_of(auction, self.auctions.told, self.strategy.unit, scene)
        if may_drive and self.driver.may_send(now):
            self._selection.select(scene)
        self._selection.confirm(scene)

    def _tell_state(self) -> None:
        goal = self.driver.goal
        if goal is not None:
            self._course.be(State.EXPLORING, f"drives to ({goal.pose.x:.1f}, {goal.pose.y:.1f})")
        elif any(cluster.reachable for cluster in self._perception.clusters):
            self._course.be(State.WAITING, "frontiers are left, none is for this robot now")
        else:
            self._course.be(State.WAITING, "sees no frontier, waits for the map to confirm it")

    def _take_event(self, event: GoalEvent, now: float) -> None:
        assert self._senses.pose is not None
        self._outcomes.take(event, self._senses.pose, now)
        self._perception.touch()

    def _finish(self, reason: str, now: float) -> None:
        self._end(reason, now)
        self._drive_home(now)

    def _end(self, reason: str, now: float) -> None:
        """Of the exploration; `reason` in words."""
        self._course.finished_at, self.orders.ended_by = now, reason
        self.driver.drop()
        self._give_up_claim(now)
        if self.started_at is None:
            self._emit(Note(f"exploration ended before it began: {reason}"))
            return
        how = "finished" if self.orders.complete else "ended"
        why = "" if self.orders.complete else f": {reason}"
        self._emit(Note(f"exploration {how} after {self.exploration_time(now):.1f} s{why}"))
        if self._senses.map is not None:
            self._emit(Note(sentence(self._perception.leftovers())))
        self._reopening.end()
        self._journal.finish(self.orders.complete, self.counters, self._senses.map, now)

    def _give_up_claim(self, now: float) -> None:
        self.claim.release()
        if self._perception.ways is not None and self._senses.pose is not None:
            self._selection.finish(self._scenes.scene(now))

    def _drive_home(self, now: float) -> None:
        if self._perception.field is None:
            self.looking.look(now)  # after a crash, or when the clock was set back
        self._homecoming.end_mission(now)

    # ---- memory ---------------------------------------------------------------------------------------------------

    @property
    def memory(self) -> Memory:
        """What is to be kept of this mission."""
        return self._course.memory(self._senses)

    def recall(self, memory: Memory, now: float) -> None:
        """Goes on with a mission of which only this was kept."""
        self._course.recall(memory, self._senses, now)
        if self.started_at is not None:
            self._journal.start(self.started_at)

    # ---- the clock ------------------------------------------------------------------------------------------------

    def skip(self, before: float, now: float) -> bool:
        """The clock was set forward in between; whether that concerns the exploration."""
        skipped = self._course.skip(before, now)
        if skipped and self.started_at is not None:
            self._journal.start(self.started_at)
        return skipped

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
        return self._course.exploration_time(now)

    def scene(self, now: float) -> Optional[Scene]:
        """What the robot knows now; None before it has perceived a map."""
        ready = self._perception.ways is not None and self._senses.pose is not None
        return self._scenes.scene(now) if ready else None

    def unreachable_count(self) -> int:
        """Frontiers that are given up, or that no reachable place sees."""
        return self._perception.unreachable(self.verdicts)
