"""Walls and lasers together: a robot that is seen to drive where the walls put it."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest
from meeting_scene import NARROW, WIDE, Actor, Scene, Wall, driving, room, standing

from map_merger import job as job_module
from map_merger.alignment import Alignment
from map_merger.evidence import Evidence
from map_merger.job import Job, LandmarkCache, Versioned
from map_merger.meetings.sweeps import NO_SWEEPS
from map_merger.presence import FEWEST_SWEEPS, is_refuted, presence_of
from map_merger.registration import Limits, Registration, Verdict
from map_merger.robot_size import USUAL_SIZE
from map_merger.surface import landmarks_of
from map_merger.transform import displacement, rotation_between
from mr_grid import FREE, OCCUPIED, GridInfo, OccupancyGrid, Pose

RESOLUTION, HALF = 0.05, 7.0
CORNERED = room(9.0, 7.0)
SQUARE = [
    Wall(-4.0, -4.0, 4.0, -4.0),
    Wall(4.0, -4.0, 4.0, 4.0),
    Wall(4.0, 4.0, -4.0, 4.0),
    Wall(-4.0, 4.0, -4.0, -4.0),
]


def map_of(walls, frame):
    """What a robot that starts at `frame` maps of a room that it has seen all of."""
    inverse, size = frame.inverse(), int(2 * HALF / RESOLUTION)
    cells = np.full((size, size), -1, np.int8)
    corners = [
        np.rint((inverse.apply(np.array([[wall.x0, wall.y0], [wall.x1, wall.y1]])) + HALF) / RESOLUTION)
        for wall in walls
    ]
    cv2.fillPoly(cells, [np.array([ends[0] for ends in corners], np.int32)], FREE)
    for ends in corners:
        cv2.line(cells, *(tuple(map(int, end)) for end in ends), OCCUPIED)
    return OccupancyGrid(GridInfo(size, size, RESOLUTION, Pose(-HALF, -HALF, 0.0)), cells)


def scene_of(way, walls=CORNERED, view=NARROW, **more):
    """Robot a stands and looks; b goes its way; with a narrow view it does not see a."""
    return Scene([Actor("a", standing(-2.5, 0.5, 0.3)), Actor("b", way, view=view)], walls, **more)


def straight():
    return driving(-0.5, -1.5, 0.4, speed=0.3)


def job_of(scene, walls=CORNERED, **more):
    target, source = (map_of(walls, scene.frame(robot)) for robot in scene.robots)
    meeting = scene.meetings["a"].sightings("b", scene.time)
    return Job(
        "b", Versioned("a", target), Versioned("b", source), (), None, None, Limits(), "correlation",
        LandmarkCache(USUAL_SIZE), USUAL_SIZE, meeting=meeting, **more,
    )  # fmt: skip


def seen_by(scene, transform):
    viewer = landmarks_of(map_of(CORNERED, scene.frame(scene.robots[0])))
    return presence_of(scene.meetings["a"].sightings("b", scene.time), viewer, transform, USUAL_SIZE)


def test_a_straight_drive_is_enough_where_the_walls_say_the_same():
    """It used to wait for a turn, with 30 m of shared wall and the other robot in sight."""
    scene = scene_of(straight()).run(6.5)
    assert scene.settled("a", "b") is None, "by the sightings alone it is not clear"
    result = job_of(scene).run()
    assert result.accepted and result.met and result.covariance is not None
    truth = scene.truth("b", "a")
    assert displacement(result.transform, truth, np.array([[5.0, 5.0]]))[0] < 0.1
    assert rotation_between(result.transform, truth) < math.radians(1.0)
    assert Alignment().finished(result) == "accepted"


def test_without_sightings_the_same_walls_are_not_enough():
    scene = scene_of(straight()).run(6.5)
    alone = replace(job_of(scene), meeting=None).run()
    assert alone.accepted and not alone.met
    assert Alignment().finished(alone) == ""


def test_what_the_last_search_found_is_looked_at_before_the_next_search():
    scene = scene_of(straight()).run(6.5)
    look = job_of(scene, search=False, suggested=scene.truth("b", "a"))
    assert look.run().met


def test_a_robot_that_is_elsewhere_is_not_believed_by_walls_that_agree():
    """A copy of the room: the walls agree, and nobody is seen where the other says that it drives."""
    scene = scene_of(straight(), worlds={"b": 1}).run(6.5)
    assert not job_of(scene).run().met
    assert seen_by(scene, scene.truth("b", "a")).empty >= FEWEST_SWEEPS


def test_walls_that_leave_several_places_are_decided_by_what_drives_in_one_of_them():
    scene = scene_of(straight(), SQUARE).run(6.5)
    result, truth = job_of(scene, SQUARE).run(), scene.truth("b", "a")
    assert result.accepted and displacement(result.transform, truth, np.array([[0.0, 0.0]]))[0] < 0.1
    alone = replace(job_of(scene, SQUARE), meeting=None).run()
    assert alone.verdict is Verdict.AMBIGUOUS


def test_what_stands_is_not_seen_to_drive():
    presence = seen_by(scene_of(standing(0.5, -1.0)).run(6.5), Pose(3.0, -1.5, -0.3))
    assert not presence.confirms
    standing_still = scene_of(standing(0.5, -1.0)).run(6.5)
    presence = seen_by(standing_still, standing_still.truth("b", "a"))
    assert presence.there >= FEWEST_SWEEPS and not presence.confirms


@pytest.mark.parametrize("shift", [(0.0, 1.5), (1.0, 1.0), (-1.5, 0.0)])
def test_another_transform_puts_the_robot_where_nothing_is_seen(shift):
    scene = scene_of(straight()).run(6.5)
    truth = scene.truth("b", "a")
    assert seen_by(scene, truth).confirms
    assert not seen_by(scene, Pose(truth.x + shift[0], truth.y + shift[1], truth.yaw)).confirms


def test_a_robot_that_is_placed_there_is_not_taken_for_another():
    scene = scene_of(straight()).run(6.5)
    truth = scene.truth("b", "a")
    viewer = landmarks_of(map_of(CORNERED, scene.frame(scene.robots[0])))
    sightings = scene.meetings["a"].sightings("b", scene.time)
    other = replace(sightings, others={"c": sightings.told}, placed={"c": truth})
    assert not presence_of(other, viewer, truth, USUAL_SIZE).confirms


def test_copies_in_which_the_other_robot_is_not_are_refuted_and_stay_so():
    """Robots that started in copies of a room believed 45 m of wall, 29 m wrong."""
    scene = scene_of(straight(), worlds={"b": 1}).run(6.5)
    result = job_of(scene).run()
    assert result.verdict is Verdict.NOT_THERE
    alignment = Alignment()
    assert alignment.finished(result) == ""
    strong = Registration(Verdict.ACCEPTED, result.transform, Evidence(60.0, 20.0, 0.0, 0.9, 0.02))
    assert alignment.finished(strong) == "", "not believed by walls, however many"
    assert Alignment().finished(strong) == "accepted"
    assert alignment.finished(strong._replace(met=True)) == "accepted"


def test_two_robots_in_one_place_are_refuted_and_what_is_right_is_not():
    scene = scene_of(straight()).run(6.5)
    sightings, truth = scene.meetings["a"].sightings("b", scene.time), scene.truth("b", "a")
    assert not is_refuted(sightings, truth)
    unseen = replace(sightings, sweeps=NO_SWEEPS)
    assert is_refuted(unseen, Pose()), "both start at the origin of their frames"
    assert not is_refuted(unseen, Pose(1.0, 0.0, 0.0))


@pytest.mark.parametrize("sees_back", [True, False])
def test_where_a_third_robot_drives_alike_the_other_must_see_this_one_as_well(sees_back):
    """In the next copy of a room it would be taken for the other one."""
    scene = scene_of(straight(), view=WIDE).run(6.5)
    truth = scene.truth("b", "a")
    sightings = scene.meetings["a"].sightings("b", scene.time)
    assert sightings.told_objects
    changes = {"others": {"c": sightings.told}, **({} if sees_back else {"told_objects": ()})}
    viewer = landmarks_of(map_of(CORNERED, scene.frame(scene.robots[0])))
    assert presence_of(replace(sightings, **changes), viewer, truth, USUAL_SIZE).confirms == sees_back


def test_a_wall_near_by_is_nobody():
    """The laser would see the wall, too."""
    scene = scene_of(driving(-3.5, 3.2, 0.0, speed=0.3), worlds={"b": 1}).run(8.0)
    assert seen_by(scene, scene.truth("b", "a")).there == 0


def test_what_maps_keep_of_robots_does_not_place_one_that_scans_do_not_show_there(monkeypatch):
    """In a building of copies one of many small things in the maps lay where the wrong copy put the other robot."""
    monkeypatch.setattr(job_module, "places_seen", lambda *sightings: 1)
    scene = scene_of(straight(), worlds={"b": 1}).run(6.5)
    assert not job_of(scene).run().met
    without_scans = replace(job_of(scene), meeting=None)
    assert without_scans.run().met, "where there is no laser maps have to do"
