"""The message that carries tracks. Needs the ROS messages of the package."""

import io
import math

import numpy as np
import pytest

pytest.importorskip("rospy")
pytest.importorskip("map_merger.msg")

from map_merger.meetings.values import Sensor, ToldObject, TrackReport
from map_merger.robot_size import USUAL_SIZE
from map_merger.ros_team import MessageError, robot_track_message, track_report_of


def travelled(report):
    sent, stream = robot_track_message(report), io.BytesIO()
    sent.serialize(stream)
    return type(sent)().deserialize(stream.getvalue()), len(stream.getvalue())


def some_report(poses=8, objects=3, places=4):
    random = np.random.default_rng(1)
    x, y, yaw = 500.0 + random.random(poses), random.random(poses), random.uniform(-3.1, 3.1, poses)
    way = np.column_stack([np.linspace(1.5, 0.0, poses), x, y, yaw])
    ages, beside = np.linspace(1.0, 0.0, places), 500.0 + random.random(places)
    seen = [ToldObject(7 + k, np.column_stack([ages, beside, random.random(places)])) for k in range(objects)]
    sensor = Sensor(math.radians(270.0), 0.0, 8.0)
    return TrackReport("robot_1", 0.2, (12, 34), 5678.25, sensor, way, tuple(seen), ("robot_2",))


def test_a_track_arrives_as_it_was_told_to_the_millimetre():
    report = some_report()
    message, size = travelled(report)
    arrived = track_report_of(message)
    assert (arrived.robot, arrived.boot, arrived.uptime) == ("robot_1", (12, 34), 5678.25)
    assert arrived.unplaced == ("robot_2",) and arrived.sensor.view == pytest.approx(math.radians(270.0))
    assert np.abs(arrived.poses - report.poses).max() < 6e-4
    for mine, theirs in zip(report.objects, arrived.objects):
        assert mine.number == theirs.number and np.abs(mine.samples - theirs.samples).max() < 6e-4
    assert size < 320


def test_a_track_of_nothing_arrives():
    arrived = track_report_of(travelled(TrackReport("robot_1", USUAL_SIZE.body_radius))[0])
    assert arrived.poses.shape == (0, 4) and arrived.objects == ()


def test_places_beyond_reach_are_left_out():
    report = TrackReport(
        "robot_1", USUAL_SIZE.body_radius, poses=np.array([[1.0, 900.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]])
    )
    assert len(track_report_of(travelled(report)[0]).poses) == 1


@pytest.mark.parametrize("field", ["ages", "yaw", "places", "objects", "robot"])
def test_a_message_that_does_not_fit_together_is_refused(field):
    message, _ = travelled(some_report())
    setattr(message, field, getattr(message, field)[:0])
    with pytest.raises(MessageError, match="track"):
        track_report_of(message)
