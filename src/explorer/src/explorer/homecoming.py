"""The way home: after the exploration, or called back from it."""

from typing import Tuple

from explorer.course import Course
from explorer.driver import ARRIVED_DISTANCE, Driver, at_home
from explorer.geometry import apart
from explorer.making_room import MakingRoom
from explorer.messages import FAILED
from explorer.orders import CALLED, Orders
from explorer.outcomes import Outcomes
from explorer.perception import Perception
from explorer.senses import Senses
from explorer.status import State
from mr_grid import Pose

HOME_LOST = "its home is not known any more"  # where SLAM was started anew, and nothing ties the two maps


class Homecoming:
    """To be used once the robot has a pose."""

    def __init__(
        self,
        course: Course,
        orders: Orders,
        driver: Driver,
        senses: Senses,
        perception: Perception,
        outcomes: Outcomes,
        room: MakingRoom,
    ) -> None:
        self._course, self._orders, self._driver = course, orders, driver
        self._senses, self._perception, self._outcomes = senses, perception, outcomes
        self._room = room
        self._aside = False  # it drives for another robot, not home

    def follow_call(self, now: float) -> None:
        """A step of a robot that was called back; it waits at home, or where it cannot come nearer."""
        if self._senses.home_is_lost:
            self._stay(CALLED, State.WAITING)
        else:
            self._go(CALLED, State.WAITING, now)

    def end_mission(self, now: float) -> None:
        """A step of a robot whose exploration has ended."""
        ended_by = self._orders.ended_by
        assert ended_by is not None
        if self._orders.homeward and not self._senses.home_is_lost:
            self._go(ended_by, State.FINISHED, now)
        else:
            self._stay(ended_by, State.FINISHED)

    def makes_room(self, now: float) -> bool:
        """Whether a robot whose mission is over has to drive once more, for another one."""
        drives = self._orders.homeward and not self._senses.home_is_lost
        return drives and self._senses.pose is not None and self._room.place(now) is not None

    def _go(self, why: str, then: State, now: float) -> None:
        """Home, and there out of the way of others."""
        aside = self._room.place(now) if self._aside or self._over else None
        self._turn(aside is not None)
        if aside is not None:
            self._course.be(State.RETURNING, f"{why}, makes room for {self._room.robot}")
            if self._driver.goal is not None or apart(self._poses()[0], aside) > ARRIVED_DISTANCE:
                self._head_for(aside, now)
        elif self._over:
            self._stay(why, then)
        else:
            self._course.be(State.RETURNING, f"{why}, drives home")
            self._head_for(self._poses()[1], now)

    def _stay(self, why: str, then: State) -> None:
        self._driver.drop()
        self._course.be(then, f"{why}, {self._whereabouts}")

    def take_result(self, outcome: str, now: float) -> None:
        """Of a goal on the way."""
        self._driver.end_home(FAILED if self._aside else outcome, now)

    def _turn(self, aside: bool) -> None:
        """From the way home to another place, or back."""
        if aside != self._aside:
            self._driver.drop()
            self._driver.begin_home()
            self._aside = aside

    def _poses(self) -> Tuple[Pose, Pose]:
        here, home = self._senses.pose, self._senses.home
        assert here is not None and home is not None
        return here, home

    @property
    def _over(self) -> bool:
        return self._driver.home_is_over(*self._poses())

    @property
    def _whereabouts(self) -> str:
        if self._senses.home_is_lost:
            return HOME_LOST
        return "at home" if at_home(*self._poses()) else "away from home"

    def _head_for(self, place: Pose, now: float) -> None:
        here, _ = self._poses()
        event = self._driver.watch(here, now, self._perception.rest_of_way)
        if event is not None:
            self._outcomes.take(event, here, now)
            self._perception.touch()
            self._driver.end_home(FAILED, now)
        if self._driver.goal is None and self._driver.may_send(now):
            self._driver.send(place, here, now, self._perception.way(here, place))
