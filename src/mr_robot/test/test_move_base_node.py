"""The move_base node without a master: SLAM is started anew while it drives."""

import threading
from typing import Any, List

import numpy as np
import pytest
import rospy
from usual_robot import navigation_with

from mr_grid import GridInfo, OccupancyGrid, Pose
from mr_grid.map_frame import MapRuns, NewFrame
from mr_grid.ros import grid_message
from mr_robot.navigation.engine import Navigator
from mr_robot.navigation.node import MoveBaseNode
from mr_robot.navigation.options import NavigationError
from mr_robot.parameter_names import FRAMES

RUN, NEXT_RUN = (1_700_000_000, 5), (1_700_000_900, 5)


class Server:
    """Keeps how goals ended."""

    def __init__(self) -> None:
        self.ended: List[str] = []
        self.active = True

    def is_active(self) -> bool:
        return self.active

    def set_aborted(self, _: Any, text: str) -> None:
        self.active = False
        self.ended.append(text)


class Command:
    def __init__(self) -> None:
        self.sent: List[Any] = []

    def publish(self, message: Any) -> None:
        self.sent.append(message)


@pytest.fixture
def node() -> MoveBaseNode:
    made = MoveBaseNode.__new__(MoveBaseNode)
    made._navigator = Navigator(navigation_with(max_linear_velocity=0.3), "robot_7")
    made._frames, made._lock, made._runs, made._unnamed = FRAMES, threading.RLock(), MapRuns(), None
    made._server, made._command, made._moving = Server(), Command(), True
    made._navigator.set_goal(Pose(1.0, 0.0, 0.0), 100.0)
    return made


def hall(run: Any, stamp: float) -> Any:
    """A map that names its run, or none."""
    cells = np.zeros((60, 60), np.int8)
    message = grid_message(OccupancyGrid(GridInfo(60, 60, 0.05, Pose(-1.5, -1.5)), cells), "map", rospy.Time(stamp))
    message.info.map_load_time = rospy.Time(*run) if run else message.header.stamp
    message.data = message.data.astype(np.int8)
    return message


def text_of_a_step(node: MoveBaseNode, now: float) -> str:
    """What a goal comes to without pose and scan, which says whether there is a map."""
    node._navigator.set_goal(Pose(1.0, 0.0, 0.0), now)
    node._navigator.step(now, None, None)
    return node._navigator.step(now + 9.0, None, None).text


def test_a_goal_of_the_former_frame_ends_and_the_robot_stops(node: MoveBaseNode) -> None:
    """Once it drove on to the place that has the same numbers in the new frame."""
    node._on_new_frame(NewFrame(None, 99.0))
    assert len(node._server.ended) == 1 and "started anew" in node._server.ended[0]
    assert node._command.sent[-1].linear.x == 0.0 and not node._moving
    assert (node._navigator.name, node._navigator.options.max_linear_velocity) == ("robot_7", 0.3)


def test_a_map_of_the_former_frame_is_planned_on_no_more(node: MoveBaseNode) -> None:
    node._on_map(hall(RUN, 90.0))
    assert "map" not in text_of_a_step(node, 100.0).replace("in the map", "")
    node._on_new_frame(NewFrame(None, 101.0))
    node._on_map(hall(RUN, 101.5))
    assert "no map" in text_of_a_step(node, 102.0)
    node._on_map(hall(NEXT_RUN, 120.0))
    assert "no map" not in text_of_a_step(node, 121.0)


def test_a_map_of_a_building_holds_where_only_localisation_was_started_anew(node: MoveBaseNode) -> None:
    node._on_map(hall(None, 90.0))
    node._on_new_frame(NewFrame(None, 101.0))
    assert "no map" not in text_of_a_step(node, 102.0)


@pytest.mark.parametrize("period", [1.0e-12, 1.0e300])
def test_a_period_in_which_nobody_is_controlled_is_refused(period: float) -> None:
    """A timer without a pause took a whole core, and one of 1e300 s ended the node with a traceback."""
    with pytest.raises(NavigationError, match=r"parameter controller_period must be from 0\.001 to 10 s, not "):
        navigation_with(controller_period=period)
