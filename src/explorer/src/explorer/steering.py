"""What people order a robot during its mission."""

from typing import Callable

from explorer.answer import Answer
from explorer.course import Course
from explorer.driver import Driver, at_home
from explorer.ending import Ending
from explorer.homecoming import HOME_LOST
from explorer.orders import CALLED, PAUSED, SENT_HOME, STOPPED, Orders
from explorer.senses import Senses
from explorer.status import State


class Steering:
    """Each order is answered with whether it is carried out, or why not."""

    def __init__(
        self,
        orders: Orders,
        course: Course,
        driver: Driver,
        ending: Ending,
        senses: Senses,
        *,
        begun: Callable[[], bool],
        give_up_claim: Callable[[float], None],
        end: Callable[[str, float], None],
    ) -> None:
        """Of the mission: `begun`, whether the robot has begun to explore; `give_up_claim` and `end` (of the
        exploration, for a reason in words), at a time in s."""
        self._orders, self._course, self._driver, self._ending, self._senses = orders, course, driver, ending, senses
        self._begun, self._give_up_claim, self._end = begun, give_up_claim, end

    @property
    def _ended(self) -> bool:
        return self._course.finished_at is not None

    def pause(self, now: float) -> Answer:
        """The robot stays where it is and claims nothing until `resume`; it still maps, tells and answers. One that has
        not begun to explore is paused when it does."""
        if self._orders.paused or self._course.state == State.FINISHED:
            return Answer(False, "is paused already" if self._orders.paused else f"has ended: {self._course.text}")
        if not self._begun():
            self._orders.halt = PAUSED
            return Answer(True, f"paused, {self._course.text}")
        self._halt(PAUSED, now)
        self._course.be(State.WAITING, PAUSED)
        return Answer(True, "paused")

    def return_now(self, now: float) -> Answer:
        """The robot drives home at once and claims nothing until `resume`: the exploration has not ended."""
        if not self._begun():
            return self._not_begun()
        if self._senses.home_is_lost:
            return Answer(False, HOME_LOST)
        if self._ended or self._orders.halt == CALLED:
            return Answer(False, "is called back already" if self._orders.halt else f"has ended: {self._course.text}")
        self._halt(CALLED, now)
        self._driver.begin_home()
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
        here, home = self._senses.pose, self._senses.home
        if not self._begun() or here is None or home is None:
            return self._not_begun()
        finished = self._course.state == State.FINISHED
        if self._course.state == State.RETURNING or (finished and at_home(here, home)):
            return Answer(False, "is at home" if finished else "is on its way home already")
        self._orders.halt, self._orders.homeward = "", True
        if not self._ended:
            self._end(SENT_HOME, now)
        self._driver.begin_home()
        self._course.be(State.RETURNING, f"{self._orders.ended_by}, drives home")
        return Answer(True, "drives home")

    def _not_begun(self) -> Answer:
        return Answer(False, f"has not begun to explore: {self._course.text}")

    def _halt(self, how: str, now: float) -> None:
        self._orders.halt = how
        self._driver.drop()
        if not self._ended:
            self._give_up_claim(now)
