"""Robots that see one another: seen where it said it was, gone since; not where another robot may have been."""

import math

import numpy as np
import pytest
from team import options

from map_merger.agent import Agent
from map_merger.alignment import Alignment
from map_merger.effects import Register
from map_merger.evidence import Evidence
from map_merger.job import outcome_of
from map_merger.messages import Anchor, Position, Tile
from map_merger.registration import Registration, Verdict
from map_merger.robot_size import USUAL_SIZE
from map_merger.sighting import Sighting, Views, nowhere, places_seen, view_of
from mr_grid import FREE, OCCUPIED, UNKNOWN, GridInfo, OccupancyGrid, Pose

PLACE = (2.0, 3.0)
GONE = np.array([[2.0, 3.0, 5.0], [5.0, 3.0, 9.0]])


def draw_robot(cells, robot):
    for angle in np.linspace(0.0, 2.0 * math.pi, 40):
        x, y = robot[0] + 0.2 * math.cos(angle), robot[1] + 0.2 * math.sin(angle)
        cells[int((y + 5.0) / 0.05), int((x + 5.0) / 0.05)] = OCCUPIED


def floor(robot=None, fill=FREE):
    """10 m x 10 m of floor around (0, 0), with the sides of a robot that stands there."""
    cells = np.full((200, 200), fill, np.int8)
    if robot is not None:
        draw_robot(cells, robot)
    return OccupancyGrid(GridInfo(200, 200, 0.05, Pose(-5.0, -5.0, 0.0)), cells)


def sighting(place=PLACE, time=5.0):
    return Sighting(view_of(floor(place), None), *place, time)


def seen(present, sightings, track=GONE, transform=None, others=None):
    return places_seen(
        present, sightings, track, transform or Pose(), nowhere() if others is None else others, USUAL_SIZE
    )


def test_a_robot_seen_where_it_said_it_was():
    assert seen(floor(), [sighting()]) == 1


def test_the_same_in_frames_that_differ():
    transform = Pose(1.0, -2.0, 0.7)
    told = transform.inverse().apply(np.array([PLACE, (5.0, 3.0)]))
    track = np.column_stack([told, [5.0, 9.0]])
    view = Sighting(view_of(floor(PLACE), None), *told[0], 5.0)
    assert seen(floor(), [view], track, transform) == 1
    assert seen(floor(), [view], track, Pose(1.0, -2.5, 0.7)) == 0


@pytest.mark.parametrize(
    ("present", "track", "transform"),
    [
        (floor(), GONE[:1], Pose()),
        (floor(), nowhere(), Pose()),
        (floor(PLACE), GONE, Pose()),
        (floor(fill=UNKNOWN), GONE, Pose()),
        (floor(), GONE, Pose(0.8, 0.0, 0.0)),
    ],
    ids=["still there", "never heard of", "something stands there still", "place not seen since", "elsewhere"],
)
def test_what_is_no_sighting(present, track, transform):
    assert seen(present, [sighting()], track, transform) == 0


def test_places_count_once_however_often_the_robot_was_seen_there():
    assert seen(floor(), [sighting(), sighting((2.5, 3.0)), sighting((2.0, 3.2))]) == 1
    assert seen(floor(), [sighting(), sighting((2.5, 3.0)), sighting((2.8, 3.0))]) == 2


@pytest.mark.parametrize(("other", "places"), [((2.3, 3.0, 4.0), 0), ((3.0, 3.0, 4.0), 1), ((2.0, 3.0, 8.0), 1)])
def test_where_another_robot_was_until_then_nothing_counts(other, places):
    assert seen(floor(), [sighting()], others=np.array([other])) == places


def test_a_view_ends_where_the_laser_does():
    near, far = view_of(floor(PLACE), Pose(0.0, 0.0, 0.0)), view_of(floor(PLACE), Pose(-12.0, 0.0, 0.0))
    assert len(near.obstacles) > 0 and len(far.obstacles) == 0


def test_views_are_bounded_and_keep_the_first_and_the_latest():
    views = Views()
    for step in range(200):
        views.add(sighting((0.2 * (step % 5), 0.0), float(step)))
    kept = views.all()
    assert len(kept) == 132
    assert kept[0].time == 0.0 and kept[-1].time == 199.0


def test_a_robot_that_stands_does_not_crowd_out_where_it_was_before():
    views = Views()
    for step in range(0, 40, 2):
        views.add(sighting((0.1 * step, 0.0)))
    for time in range(500):
        views.add(sighting((-1.0, 0.0), float(time)))
    kept = views.all()
    assert len(kept) == 22
    assert kept[-1].time == 499.0


def test_a_repeated_view_is_kept_once():
    views, first = Views(), sighting()
    views.add(first)
    views.add(first._replace(x=first.x + 0.05))
    assert views.all() == (first,)


def test_a_meeting_is_believed_at_once():
    result = Registration(Verdict.ACCEPTED, Pose(1.0, 2.0, 0.5), Evidence(15.0, 5.0, 0.0, 0.8, 0.02), 60.0)
    assert Alignment().finished(result) == ""
    assert Alignment().finished(result._replace(met=True)) == "accepted"


def room(robot=None):
    """A room of 7 m x 5 m without one corner, with a partition and a cupboard. Its copy has the same map."""
    cells = np.full((200, 200), UNKNOWN, np.int8)
    cells[40:144, 20:164] = OCCUPIED
    cells[42:142, 22:162] = FREE
    cells[42:74, 128:164] = OCCUPIED
    cells[40:72, 130:164] = UNKNOWN
    cells[90:142, 60:62] = OCCUPIED
    cells[130:144, 90:112] = OCCUPIED
    if robot is not None:
        draw_robot(cells, robot)
    return OccupancyGrid(GridInfo(200, 200, 0.05, Pose(-5.0, -5.0, 0.0)), cells)


START, SECOND, AWAY = (0.0, -1.0), (0.0, 0.5), (-2.5, -1.5)


class Watcher:
    """An agent that shares a map with robot_1, or has the map of a copy of its room."""

    def __init__(self):
        self.agent = Agent(options("robot_0"), (1, 0))
        self.agent.on_local_pose(Pose(2.0, -1.0, 0.0), 0.0)
        self.now = 0.0
        info = room().info
        self.agent.on_anchor(Anchor("robot_1", info, (1, 1), 1), 0.0)
        self.agent.on_tile(Tile("robot_1", (0,), 0, 0, room().cells, info.resolution, (1, 1), 1), 0.0)

    def sees(self, shown, told, seconds=4.0):
        """For some seconds the own map shows a robot at one place (or none) while robot_1 tells where it is."""
        self.agent.on_local_map(room(shown), self.now)
        self.agent.on_position(Position("robot_1", Pose(*told, 0.0)), self.now)
        until = self.now + seconds
        while self.now < until:
            self.now += 0.25
            self.agent.tick(self.now)
            for effect in self.agent.effects():
                if isinstance(effect, Register):
                    self.agent.on_registered(effect, effect.job.run(), self.now)

    def third_robot_is_heard(self):
        """Where in the own frame it is nobody knows: it has no map that could be registered."""
        self.agent.on_position(Position("robot_2", Pose(0.0, 0.0, 0.0)), self.now)

    def third_robot_is_placed(self, place):
        """The same map again and a position: its frame is proposed."""
        self.third_robot_has_a_map()
        self.agent.on_position(Position("robot_2", Pose(*place, 0.0)), self.now)

    def third_robot_has_a_map(self):
        info = room().info
        self.agent.on_anchor(Anchor("robot_2", info, (1, 2), 1), self.now)
        self.agent.on_tile(Tile("robot_2", (0,), 0, 0, room().cells, info.resolution, (1, 2), 1), self.now)

    @property
    def merged(self):
        return "robot_1" in self.agent.view.transforms()


def test_a_third_robot_that_may_be_anywhere_fakes_no_meeting():
    watcher = Watcher()
    watcher.third_robot_is_heard()
    watcher.sees(START, told=START)
    watcher.sees(None, told=AWAY, seconds=60.0)
    assert not watcher.merged


def test_a_third_robot_that_is_known_to_have_stood_there_fakes_no_meeting_not_even_twice():
    watcher = Watcher()
    watcher.third_robot_is_placed(START)
    watcher.sees(START, told=START, seconds=10.0)
    watcher.third_robot_is_placed(SECOND)
    watcher.sees(SECOND, told=SECOND)
    watcher.third_robot_is_placed((-2.0, -1.0))
    watcher.sees(None, told=AWAY, seconds=60.0)
    assert not watcher.merged


def test_a_third_robot_with_a_map_that_does_not_tell_where_it_is_may_be_anywhere():
    watcher = Watcher()
    watcher.third_robot_has_a_map()
    watcher.sees(START, told=START, seconds=6.0)
    watcher.sees(None, told=AWAY, seconds=60.0)
    assert not watcher.merged


def test_two_robots_that_were_seen_are_merged_although_a_third_may_be_anywhere():
    watcher = Watcher()
    watcher.third_robot_is_heard()
    watcher.sees(START, told=START)
    watcher.sees(SECOND, told=SECOND)
    watcher.sees(None, told=AWAY, seconds=10.0)
    assert watcher.merged


@pytest.mark.parametrize("third", [False, True], ids=["no third robot", "the third one was elsewhere"])
def test_one_place_is_enough_when_nobody_else_can_have_stood_there(third):
    watcher = Watcher()
    if third:
        watcher.third_robot_is_placed((-2.0, -1.0))
    watcher.sees(START, told=START, seconds=6.0)
    watcher.sees(None, told=AWAY, seconds=10.0)
    assert watcher.merged


class BrokenJob:
    def run(self):
        raise ZeroDivisionError("a map nobody thought of")


def test_a_fault_in_a_job_ends_no_thread():
    """Registration went silent for good after the first exception."""
    outcome, fault = outcome_of(BrokenJob())
    assert outcome.verdict is Verdict.FAILED and not outcome.accepted
    assert isinstance(fault, ZeroDivisionError)
