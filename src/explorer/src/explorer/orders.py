"""What people and limits order: pause, return, stop, go home."""

from typing import Optional

from explorer.limits import Limits
from explorer.options import Options

DONE = "finished"  # how a mission ends by itself
STOPPED = "stopped"
SENT_HOME = "sent home"
ORDERED = (STOPPED, SENT_HOME)  # ends that somebody wanted: they hold on when a mission starts anew
PAUSED = "is paused"  # what holds a robot, in words
CALLED = "is called back"


class Orders:
    """Those that hold in one mission. `limits`: what ends its exploration; `halt`: what holds the robot until it is to
    go on, `PAUSED` where it is or `CALLED` to its home, empty for nothing; `ended_by`: how the exploration ended, in
    words, None while it has not; `homeward`: the robot is to drive home after it."""

    def __init__(self, options: Options) -> None:
        self.limits = Limits(options.time_limit, options.distance_limit)
        self.halt = ""
        self.homeward = options.return_home
        self.ended_by: Optional[str] = None

    @property
    def paused(self) -> bool:
        return self.halt == PAUSED

    @property
    def complete(self) -> bool:
        """The exploration ended because nothing was left."""
        return self.ended_by == DONE
