"""Goals of navigation, by the action `move_base`."""

from typing import Any, Callable

import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction

from explorer import messages, ros_io

OUTCOMES = {
    actionlib.GoalStatus.SUCCEEDED: messages.REACHED,
    actionlib.GoalStatus.PREEMPTED: messages.REPLACED,
    actionlib.GoalStatus.RECALLED: messages.REPLACED,
}


class Goals:
    """One at a time: the next replaces the one before."""

    def __init__(
        self, action: str, frame: str, accepted: Callable[[int], None], ended: Callable[[int, str, str], None]
    ) -> None:
        """`action`: its name. `frame`: of the goals. `accepted` gets the number of a goal, `ended` its outcome,
        one of `messages`, too, and a text; both in threads of their own."""
        self._frame, self._accepted, self._ended = frame, accepted, ended
        # Not the simple client: that one reports an error for each goal that replaces another.
        self._client = actionlib.ActionClient(action, MoveBaseAction)
        self._handle: Any = None

    @property
    def heard(self) -> bool:
        """Whether somebody takes goals."""
        return bool(self._client.pub_goal.get_num_connections() > 0)

    def send(self, effect: messages.SetGoal, stamp: rospy.Time) -> None:
        """Navigation begins at once."""

        def transition(handle: Any) -> None:
            state = handle.get_comm_state()
            if state == actionlib.CommState.ACTIVE:
                self._accepted(effect.goal_id)
            elif state == actionlib.CommState.DONE:
                status = handle.get_goal_status()
                text = handle.get_goal_status_text() or actionlib.GoalStatus.to_string(status)
                self._ended(effect.goal_id, OUTCOMES.get(status, messages.FAILED), text)

        goal = ros_io.goal_to(effect.pose, self._frame, stamp)
        self._handle = self._client.send_goal(goal, transition_cb=transition)

    def cancel(self) -> None:
        """The one on its way, if there is one."""
        if self._handle is not None:
            self._handle.cancel()
            self._handle = None
