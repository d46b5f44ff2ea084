"""Robots that see one another: seen where it said it was, gone since; nothing else counts as a meeting."""

import math

import numpy as np
import pytest

from map_merger.alignment import Alignment, outcome_of
from map_merger.evidence import Evidence
from map_merger.grid import FREE, OCCUPIED, UNKNOWN, Grid, GridInfo
from map_merger.registration import Registration, Verdict
from map_merger.sighting import Sighting, Views, robot_seen, view_of
from map_merger.transform import Transform

PLACE = (2.0, 3.0)
GONE = np.array([[2.0, 3.0], [5.0, 3.0]])


def floor(robot=None, fill=FREE):
    """10 m x 10 m of floor around (0, 0), with the sides of a robot that stands there."""
    cells = np.full((200, 200), fill, np.int8)
    if robot is not None:
        for angle in np.linspace(0.0, 2.0 * math.pi, 40):
            x, y = robot[0] + 0.2 * math.cos(angle), robot[1] + 0.2 * math.sin(angle)
            cells[int((y + 5.0) / 0.05), int((x + 5.0) / 0.05)] = OCCUPIED
    return Grid(GridInfo(200, 200, 0.05, Transform(-5.0, -5.0, 0.0)), cells)


def sighting(place=PLACE):
    return Sighting(view_of(floor(place)), *place)


def test_a_robot_seen_where_it_said_it_was():
    assert robot_seen(floor(), [sighting()], GONE, Transform())


def test_the_same_in_frames_that_differ():
    transform = Transform(1.0, -2.0, 0.7)
    told = transform.inverse().apply(np.array([PLACE, (5.0, 3.0)]))
    seen = Sighting(view_of(floor(PLACE)), *told[0])
    assert robot_seen(floor(), [seen], told, transform)
    assert not robot_seen(floor(), [seen], told, Transform(1.0, -2.5, 0.7))


@pytest.mark.parametrize(
    ("present", "track", "transform"),
    [
        (floor(), GONE[:1], Transform()),
        (floor(), np.empty((0, 2)), Transform()),
        (floor(PLACE), GONE, Transform()),
        (floor(fill=UNKNOWN), GONE, Transform()),
        (floor(), GONE, Transform(0.8, 0.0, 0.0)),
    ],
    ids=["still there", "never heard of", "something stands there still", "place not seen since", "elsewhere"],
)
def test_what_is_no_meeting(present, track, transform):
    assert not robot_seen(present, [sighting()], track, transform)


def test_views_are_bounded_and_keep_the_first_and_the_latest():
    views = Views()
    for step in range(100):
        views.add(sighting((0.01 * step, 0.0)))
    kept = views.all()
    assert len(kept) == 24
    assert kept[0].x == 0.0 and kept[-1].x == pytest.approx(0.99)


def test_a_repeated_view_is_kept_once():
    views, seen = Views(), sighting()
    views.add(seen)
    views.add(seen._replace(x=seen.x + 0.05))
    assert views.all() == (seen,)


def test_a_meeting_is_believed_at_once():
    result = Registration(Verdict.ACCEPTED, Transform(1.0, 2.0, 0.5), Evidence(15.0, 5.0, 0.0, 0.8, 0.02), 60.0)
    assert Alignment().finished(result) == ""
    assert Alignment().finished(result._replace(met=True)) == "accepted"


class BrokenJob:
    def run(self):
        raise ZeroDivisionError("a map nobody thought of")


def test_a_fault_in_a_job_ends_no_thread():
    """Registration went silent for good after the first exception."""
    outcome, fault = outcome_of(BrokenJob())
    assert outcome.verdict is Verdict.FAILED and not outcome.accepted
    assert isinstance(fault, ZeroDivisionError)
