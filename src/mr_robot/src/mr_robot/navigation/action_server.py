"""The action server of navigation, for clocks that are set back."""

from typing import Any

import actionlib
import rospy


class LatestGoalServer(actionlib.SimpleActionServer):
    """Takes each goal that comes, as `SimpleActionServer` does while time goes on. After a clock was set back that one
    refuses all goals until the time of the last goal has come again, and no longer tells its status."""

    def start(self) -> None:
        super().start()
        server = self.action_server
        server.status_timer.shutdown()
        period = rospy.Duration(1.0 / server.status_frequency)
        server.status_timer = rospy.Timer(period, server.publish_status_async, reset=True)

    def internal_goal_callback(self, goal: Any) -> None:
        """`goal`: handle of the new one. Stamps that lie in the future are from before the clock was set back."""
        with self.execute_condition:
            now = rospy.Time.now()
            for former in (self.current_goal, self.next_goal):
                if former.get_goal() and former.get_goal_id().stamp > now:
                    former.get_goal_id().stamp = goal.get_goal_id().stamp
        super().internal_goal_callback(goal)
