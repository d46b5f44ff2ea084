"""What a page can ask of a robot, by name."""

from __future__ import annotations

from typing import Awaitable, Callable, NamedTuple, Sequence

from mr_page.numbers import is_finite

ORDERS = ("start", "pause", "resume", "return_now", "stop", "go_home")
TEAM = "team_"  # before the name of an order to all that the robot's radio reaches
PASS_ON = "pass_on_"  # before the name of one to a single robot that it reaches
SET_LIMITS = "set_limits"
LIMITS_SERVICE = "explorer/set_limits"  # explorer/SetLimits
TEAM_LIMITS_SERVICE = "mission_control/set_limits"  # explorer/SetLimits
ORDER_SERVICE = "mission_control/order"  # explorer/OrderRobots
SERVICES = {  # command: service at the robot's own master; which of them there are is looked up
    **{order: f"explorer/{order}" for order in ORDERS},  # std_srvs/Trigger, for this robot
    SET_LIMITS: LIMITS_SERVICE,
    **{f"{TEAM}{order}": f"mission_control/{order}" for order in ORDERS},  # std_srvs/Trigger
    f"{TEAM}{SET_LIMITS}": TEAM_LIMITS_SERVICE,
    **{f"{PASS_ON}{order}": ORDER_SERVICE for order in (*ORDERS, SET_LIMITS)},
}
RADIO = {"radio_off": "down", "radio_on": "up"}  # command: word for the radio daemon of a simulated team
COMMANDS = (*SERVICES, *RADIO)


class Answer(NamedTuple):
    done: bool
    text: str


class Order(NamedTuple):
    """`command` of COMMANDS; `to`: the robot to which one that begins with PASS_ON is passed on; `limits` of
    one that ends with SET_LIMITS: time in s and way in m, 0 for none."""

    command: str
    to: str = ""
    limits: Sequence[float] = ()

    def fault(self) -> str:
        """What is wrong with it, one sentence; empty: nothing."""
        if self.command not in COMMANDS:
            return f"there is no command {self.command!r}; there are {', '.join(COMMANDS)}"
        if self.command.startswith(PASS_ON) != bool(self.to):
            return (
                f"{self.command} needs a robot to pass it on to" if not self.to else f"{self.command} is not passed on"
            )
        if self.command.endswith(SET_LIMITS) and not (len(self.limits) == 2 and is_finite(*self.limits)):
            return f"{self.command} needs a time in s and a way in m, 0 for no limit"
        return ""


Command = Callable[[str, Order], Awaitable[Answer]]
"""Asks a robot (by name) for something."""
