"""Edges on the radio. Needs the built messages."""

import io
import math

import pytest

pytest.importorskip("rospy")

from test_graph import Truth

from map_merger import ros_io, ros_team
from map_merger.graph.edges import MOST_EDGES


def over_the_radio(message):
    written = io.BytesIO()
    message.serialize(written)
    received = type(message)()
    received.deserialize(written.getvalue())
    return received


def test_edges_arrive_as_they_were_told():
    report = Truth(4, 1).find_all().report_of("robot_1")
    received = ros_team.edges_of(over_the_radio(ros_team.edges_message(report)))
    assert received == report and [edge.age for edge in received.edges] == [0.0] * 3


def test_a_yaw_that_is_no_angle_is_refused():
    message = ros_team.edges_message(Truth(2, 1).find_all().report_of("robot_1"))
    message.edges[0].yaw = math.inf
    with pytest.raises(ros_io.MessageError, match="robot_1 - robot_0"):
        ros_team.edges_of(message)


def test_a_message_of_any_length_is_cut():
    message = ros_team.edges_message(Truth(2, 1).find_all().report_of("robot_1"))
    message.edges *= 1000
    assert len(ros_team.edges_of(message).edges) == MOST_EDGES + 1
