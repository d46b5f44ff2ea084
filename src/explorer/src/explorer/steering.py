"""What people order a robot, during its mission and before."""

from typing import Callable

from explorer.answer import Answer
from explorer.course import Course
from explorer.driver import Driver, at_home
from explorer.ending import Ending
from explorer.homecoming import HOME_LOST
from explorer.limits import Limits
from explorer.orders import CALLED, PAUSED, SENT_HOME, STOPPED, Orders
from explorer.senses import Senses
from explorer.status import State


class Steering:
    """Each order is answered with whether it is carried out, or why not. One that comes before the robot has begun
    holds from its beginning on, and one that ends the mission ends it before that."""

    def __init__(
        self,
        orders: Orders,
        course: Course,
        driver: Driver,
        ending: Ending,
        senses: Senses,
        *,
        awaited: Callable[[], str],
        give_up_claim: Callable[[float], None],
        end: Callable[[str, float], None],
    ) -> None:
        """Of the mission: `awaited`, what there is to be before the robot begins, empty if it can; `give_up_claim` and
        `end` (of the exploration, for a reason in words), at a time in s."""
        self._orders, self._course, self._driver, self._ending, self._senses = orders, course, driver, ending, senses
        self._awaited, self._give_up_claim, self._end = awaited, give_up_claim, end

    @property
    def _ended(self) -> bool:
        return self._course.finished_at is not None

    def pause(self, now: float) -> Answer:
        """The robot stays where it is and claims nothing until `resume`; it still maps, tells and answers."""
        if self._orders.paused or self._course.state == State.FINISHED:
            return Answer(False, "is paused already" if self._orders.paused else f"has ended: {self._course.text}")
        self._halt(PAUSED, now)
        awaited = self._awaited()
        if awaited:
            return self._wait_for(awaited)
        self._course.be(State.WAITING, PAUSED)
        return Answer(True, "paused")

    def return_now(self, now: float) -> Answer:
        """The robot drives home at once and claims nothing until `resume`: the exploration has not ended."""
        if self._senses.home_is_lost:
            return Answer(False, HOME_LOST)
        if self._ended or self._orders.halt == CALLED:
            return Answer(False, "is called back already" if self._orders.halt else f"has ended: {self._course.text}")
        self._halt(CALLED, now)
        self._driver.begin_home()
        awaited = self._awaited()
        if awaited:
            return self._wait_for(awaited)
        self._course.be(State.RETURNING, f"{CALLED}, drives home")
        return Answer(True, "drives home")

    def resume(self) -> Answer:
        """The robot goes on after `pause` or `return_now`."""
        if not self._orders.halt:
            return Answer(False, "is not paused")
        self._driver.drop()
        self._orders.halt = ""
        self._ending.look_again()
        return Answer(True, "goes on")

    def stop(self, now: float) -> Answer:
        """Ends the mission where the robot is."""
        if self._course.state == State.FINISHED:
            return Answer(False, f"has ended already: {self._course.text}")
        self._orders.halt, self._orders.homeward = "", False
        self._driver.drop()
        if not self._ended:
            self._end(STOPPED, now)
        self._course.be(State.FINISHED, "stopped")
        return Answer(True, "stopped")

    def go_home(self, now: float) -> Answer:
        """Ends the exploration; the robot drives home, also if it was stopped before or is not to return by itself."""
        if self._senses.home_is_lost:
            return Answer(False, HOME_LOST)
        finished = self._course.state == State.FINISHED
        homeward = self._ended and self._orders.homeward and not self._orders.halt
        if (finished and self._is_at_home) or (homeward and not finished):
            return Answer(False, "is at home" if finished else "is on its way home already")
        self._orders.halt, self._orders.homeward = "", True
        if not self._ended:
            self._end(SENT_HOME, now)
        self._driver.begin_home()
        awaited = self._awaited()
        if awaited:
            return self._wait_for(awaited)
        self._course.be(State.RETURNING, f"{self._orders.ended_by}, drives home")
        return Answer(True, "stays at home" if self._is_at_home else "drives home")

    def set_limits(self, limits: Limits) -> Answer:
        """In place of those of before; one that is reached already ends the exploration at once."""
        if self._ended:
            return Answer(False, f"has ended: {self._course.text}")
        self._orders.limits = limits
        return Answer(True, limits.words)

    @property
    def _is_at_home(self) -> bool:
        here, home = self._senses.pose, self._senses.home
        return here is not None and home is not None and at_home(here, home)

    def _wait_for(self, awaited: str) -> Answer:
        self._course.wait_for(awaited)
        return Answer(True, self._course.text)

    def _halt(self, how: str, now: float) -> None:
        self._orders.halt = how
        self._driver.drop()
        if not self._ended:
            self._give_up_claim(now)
