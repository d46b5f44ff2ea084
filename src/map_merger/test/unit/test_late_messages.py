"""What a robot sent in a former run and arrives late does not count in its present one."""

import numpy as np
import pytest
from team import options

from map_merger.agent import Agent
from map_merger.covariance import as_covariance
from map_merger.graph.edges import Edge, EdgeReport
from map_merger.meetings import TrackReport
from map_merger.messages import LONGEST_DELAY_S, Anchor, Position
from map_merger.robot_size import USUAL_SIZE
from map_merger.told_runs import ToldRuns
from mr_grid import GridInfo, Pose

FORMER, PRESENT = (1_700_000_000, 5), (1_700_000_100, 500_000_000)


def restarted(name="robot_1"):
    """An agent that has heard both runs of a robot."""
    agent = Agent(options("robot_0"), (1, 0))
    agent.on_anchor(Anchor(name, GridInfo(0, 0, 0.05), FORMER), 10.0)
    agent.on_anchor(Anchor(name, GridInfo(0, 0, 0.05), PRESENT), 110.5)
    return agent


def sent_at(stamp):
    return Position("robot_1", Pose(3.0, 4.0, 0.0), stamp)


def test_a_late_position_of_a_former_run_is_ignored():
    """A place in the former frame was taken for one in the present frame."""
    agent = restarted()
    agent.on_position(sent_at(1_700_000_100.4), 110.6)
    assert agent._observations.whereabouts.position("robot_1") is None
    agent.on_position(sent_at(1_700_000_100.6), 110.7)
    assert agent._observations.whereabouts.position("robot_1").heard == 110.7


@pytest.mark.parametrize("stamp", [0.0, 99.0, 1_700_000_100.0 - 2.0 * LONGEST_DELAY_S])
def test_positions_that_are_not_dated_by_that_clock_count(stamp):
    """As those of the original in a simulation, or after the clock of the robot was set back."""
    agent = restarted()
    agent.on_position(sent_at(stamp), 110.6)
    assert agent._observations.whereabouts.position("robot_1") is not None


def test_a_late_track_of_a_former_run_is_ignored():
    """With the restart it was forgotten that the run was over."""
    agent = restarted()
    poses = np.array([[0.2, 1.0, 1.0, 0.0], [0.0, 1.1, 1.0, 0.0]])
    agent.on_track(TrackReport("robot_1", USUAL_SIZE.body_radius, FORMER, 90.0, poses=poses), 110.6)
    assert agent._observations.meetings.why("robot_1") == "robot_1 does not tell its track"
    agent.on_track(TrackReport("robot_1", USUAL_SIZE.body_radius, PRESENT, 0.3, poses=poses), 110.8)
    assert agent._observations.meetings.why("robot_1") != "robot_1 does not tell its track"


def edges_to(run):
    covariance = as_covariance(np.diag([0.01, 0.01, 0.001]))
    return EdgeReport("base", (7, 0), (Edge("base", "robot_1", (7, 0), run, Pose(), covariance),))


def test_late_edges_of_a_base_do_not_make_a_robot_restart_again():
    """The late report and the next one each made everybody forget what the robot had told in its present run."""
    runs = ToldRuns()
    assert runs.restarted(edges_to(FORMER)) == []
    assert runs.restarted(edges_to(PRESENT)) == ["robot_1"]
    assert runs.restarted(edges_to(FORMER)) == [] == runs.restarted(edges_to(PRESENT))
    assert runs.restarted(edges_to((9, 9))) == ["robot_1"]


def test_late_edges_of_a_former_run_place_nobody():
    agent = restarted()
    covariance = as_covariance(np.diag([0.01, 0.01, 0.001]))
    for run, placed in ((FORMER, False), (PRESENT, True)):
        edge = Edge("robot_1", "robot_0", run, (1, 0), Pose(1.0, 0.0, 0.0), covariance)
        agent.on_edges(EdgeReport("robot_1", run, (edge,)), 111.0)
        assert ("robot_1" in agent.view.transforms()) == placed
