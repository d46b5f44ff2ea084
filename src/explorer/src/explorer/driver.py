"""The goal on its way: sent until it is accepted, watched for progress, dropped, and the way home."""

import math
from dataclasses import dataclass, replace
from typing import Callable, NamedTuple, Optional

from explorer.geometry import Position, apart, distance
from explorer.messages import FAILED, REACHED, CancelGoal, Emit, Note, SetGoal
from explorer.options import Options
from mr_grid import Pose

ARRIVED_DISTANCE = 0.45  # m, the goal is close enough to look
PROGRESS_DISTANCE = 0.3  # m of motion that count as progress
SLOWEST = 0.2  # m/s: a robot that needs longer for its way, and the time without progress besides, gets nowhere
GOAL_TRIES = 5  # times a goal is sent before it counts as failed because move_base does not accept it
REPLACED_PAUSE = 2.0  # s without a goal after somebody else gave move_base one
HOME_ATTEMPTS = 5  # contract 3.3
HOME_DISTANCE = 0.4  # m
HOME_PAUSE = 3.0  # s between two attempts


@dataclass
class Goal:
    """What the robot drives to. `frontier` and `cluster` are numbers, None on the way home or to step aside.
    `deadline`: when it has failed, though the robot still moves about. `nearest`: the place, in metres, from which the
    way to it was shortest, `nearest_way` m."""

    goal_id: int
    pose: Pose
    sent: float
    deadline: float
    frontier: Optional[int] = None
    cluster: Optional[int] = None
    accepted: bool = False
    progress_place: Position = (0.0, 0.0)
    progress_time: float = 0.0
    nearest: Position = (0.0, 0.0)
    nearest_way: float = math.inf


class GoalEvent(NamedTuple):
    """A goal was `REACHED`, `FAILED` for a reason, or `REPLACED` by somebody else."""

    goal: Goal
    outcome: str
    text: str = ""


class Driver:
    """Owner of the goal. `last_id`: of the goals of a former mission."""

    def __init__(self, options: Options, emit: Emit, last_id: int = 0) -> None:
        self._options = options
        self._emit = emit
        self.goal: Optional[Goal] = None
        self.last_id = last_id
        self.goals = self.reached = self.failed = 0
        self._awaited_since = -math.inf  # since when move_base has accepted none of the goals sent
        self._hold_until = -math.inf
        self._home_attempts = 0

    def may_send(self, now: float) -> bool:
        return now >= self._hold_until

    def send(
        self,
        pose: Pose,
        here: Pose,
        now: float,
        way: float,
        frontier: Optional[int] = None,
        cluster: Optional[int] = None,
    ) -> None:
        """Drives to `pose` from `here`, `way` m of path, in place of the goal before."""
        if self.goal is None or self.goal.accepted:
            self._awaited_since = now
        self.last_id += 1
        self.goals += 1
        place, progress = (here.x, here.y), now
        deadline = now + self._options.progress_timeout + way / SLOWEST
        if self.goal is not None and cluster is not None and self.goal.cluster == cluster:
            deadline = min(deadline, self.goal.deadline)
        if self.goal is not None and frontier is not None and self.goal.frontier is not None:
            # A goal that moves on while the robot stands still must not reset the watchdog.
            place, progress = self.goal.progress_place, self.goal.progress_time
        self.goal = Goal(
            self.last_id,
            pose,
            now,
            deadline,
            frontier,
            cluster,
            progress_place=place,
            progress_time=progress,
            nearest=(here.x, here.y),
        )
        self._emit(SetGoal(self.last_id, pose))

    def drop(self) -> None:
        """Stops the robot."""
        if self.goal is not None:
            self._emit(CancelGoal(self.goal.goal_id))
            self.goal = None

    def take_accepted(self, goal_id: int, now: float) -> None:
        self._awaited_since = now
        if self.goal is not None and self.goal.goal_id == goal_id:
            self.goal.accepted = True

    def take_result(self, goal_id: int, outcome: str, text: str, now: float) -> Optional[GoalEvent]:
        """move_base is done with a goal; None if it was a former one."""
        if self.goal is None or self.goal.goal_id != goal_id:
            return None
        goal, self.goal = self.goal, None
        if goal.frontier is not None:
            self.reached += outcome == REACHED
            self.failed += outcome == FAILED
            if outcome not in (REACHED, FAILED):
                self._hold_until = now + REPLACED_PAUSE
        return GoalEvent(goal, outcome, text)

    def watch(self, here: Pose, now: float, way: Callable[[Pose], float]) -> Optional[GoalEvent]:
        """What has become of the goal, if anything: failed, or near enough to look, while the robot drives on.
        `way`: m of path to a place from here."""
        goal = self.goal
        if goal is None:
            return None
        rest = way(goal.pose)
        if rest < goal.nearest_way:
            goal.nearest, goal.nearest_way = (here.x, here.y), rest
        if not goal.accepted and now - goal.sent > self._options.wait_for_planner_result:
            return self._send_again(goal, now)
        if distance((here.x, here.y), goal.progress_place) > PROGRESS_DISTANCE:
            goal.progress_place, goal.progress_time = (here.x, here.y), now
        if now - goal.progress_time > self._options.progress_timeout and goal.accepted:
            return self._give_up(goal, f"no progress for {self._options.progress_timeout:g} s")
        if goal.frontier is not None and apart(here, goal.pose) <= ARRIVED_DISTANCE:
            return GoalEvent(goal, REACHED)
        if now > goal.deadline:
            return self._give_up(goal, "not there in the time that its way takes")
        return None

    def _send_again(self, goal: Goal, now: float) -> Optional[GoalEvent]:
        if now - self._awaited_since > GOAL_TRIES * self._options.wait_for_planner_result:
            return self._give_up(goal, f"move_base has not accepted it in {GOAL_TRIES} tries")
        self._emit(Note("move_base does not accept the goal; it is sent again", True))
        self.last_id += 1
        self.goals += 1
        self.goal = replace(goal, goal_id=self.last_id, sent=now)
        self._emit(SetGoal(self.last_id, goal.pose))
        return None

    def _give_up(self, goal: Goal, text: str) -> GoalEvent:
        self.drop()
        self.failed += 1
        return GoalEvent(goal, FAILED, text)

    # ---- the way home ---------------------------------------------------------------------------------------------

    def begin_home(self) -> None:
        """All attempts are to be made from now on."""
        self._home_attempts = 0

    def home_is_over(self, here: Pose, home: Pose) -> bool:
        """Nothing is left to be driven: the robot is at home, or has tried often enough."""
        return at_home(here, home) or self._home_attempts >= HOME_ATTEMPTS

    def end_home(self, outcome: str, now: float) -> None:
        """An attempt has ended."""
        if outcome == REACHED:
            self._home_attempts = HOME_ATTEMPTS  # as near as move_base gets
        else:
            self._home_attempts += 1
            self._hold_until = now + HOME_PAUSE


def at_home(here: Pose, home: Pose) -> bool:
    return apart(here, home) <= HOME_DISTANCE
