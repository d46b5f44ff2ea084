"""Robots that are heard and seen at the same time, in small scenes."""

import math
from dataclasses import replace

import numpy as np
import pytest
from meeting_scene import NARROW, Actor, Scene, driving, room, standing

from map_merger.meetings.doubts import rival_of
from map_merger.meetings.meetings import Meetings
from map_merger.meetings.values import MOST_OBJECTS, MOST_POSES, MOST_SAMPLES, ToldObject, TrackReport
from map_merger.robot_size import USUAL_SIZE
from map_merger.transform import displacement, rotation_between
from mr_grid import GridInfo, OccupancyGrid, Pose

WALLS = room(14.0, 11.0)


def weave(rate=0.5, period=6.0):
    return lambda time: rate * math.sin(2.0 * math.pi * time / period)


def assert_right(found, truth, shift=0.2, turn=2.0):
    assert found is not None
    around = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 3.0], [-3.0, 0.0]])
    assert displacement(found, truth, around).max() < shift
    assert rotation_between(found, truth) < math.radians(turn)


def test_a_robot_that_is_seen_driving_gives_its_transform_to_one_that_it_does_not_see():
    scene = Scene(
        [
            Actor("watcher", standing(-3.0, 0.0)),
            Actor("driver", driving(-1.0, -1.0, 0.3, turn=weave()), view=NARROW),
        ],
        WALLS,
    )
    scene.run(10.0)
    assert_right(scene.settled("watcher", "driver"), scene.truth("driver", "watcher"))
    best = scene.hypotheses("watcher", "driver")[0]
    assert not best.mutual


def test_the_robot_that_is_seen_learns_of_it_from_what_the_other_tells():
    scene = Scene(
        [
            Actor("watcher", standing(-3.0, 0.0)),
            Actor("driver", driving(-1.0, -1.0, 0.3, turn=weave()), view=NARROW),
        ],
        WALLS,
    )
    scene.run(10.0)
    assert_right(scene.settled("driver", "watcher"), scene.truth("watcher", "driver"))


def test_robots_that_see_one_another_agree_and_are_exact():
    scene = Scene(
        [
            Actor("a", driving(-3.0, 0.5, 0.2, turn=weave())),
            Actor("b", driving(-3.0, -1.0, 2.9, turn=weave(-0.6, 5.0))),
        ],
        WALLS,
    )
    scene.run(10.0)
    there, back = scene.settled("a", "b"), scene.settled("b", "a")
    assert_right(there, scene.truth("b", "a"), 0.15)
    assert_right(back, scene.truth("a", "b"), 0.15)
    assert scene.hypotheses("a", "b")[0].mutual


def test_nothing_is_believed_before_something_has_moved():
    scene = Scene([Actor("a", standing(-3.0, 0.5)), Actor("b", standing(-3.0, -1.0))], WALLS)
    scene.run(15.0)
    assert scene.settled("a", "b") is None
    assert scene.meetings["a"].why("b") == "waits to see b move"


def test_straight_drives_that_are_alike_wait_for_a_turn():
    def straight_then_left(time):
        return 0.6 if 9.0 < time < 11.0 else 0.0

    scene = Scene(
        [
            Actor("a", standing(-6.0, 2.0)),
            Actor("b", driving(-5.0, 1.0, speed=0.3, turn=straight_then_left), view=NARROW),
            Actor("c", driving(-5.0, -0.5, speed=0.3), view=NARROW),
        ],
        WALLS,
    )
    scene.run(9.0)
    assert scene.settled("a", "b") is None and scene.settled("a", "c") is None
    assert scene.meetings["a"].why("b") in (
        "waits to see b turn: a straight drive of 2.1 m is like others",
        "waits to see b turn: a straight drive of 2.0 m is like others",
        "b and c move alike",
    )
    scene.run(20.0)
    assert_right(scene.settled("a", "b"), scene.truth("b", "a"), 0.25)


def test_a_person_who_crosses_is_nobody():
    person = driving(0.0, -4.0, 1.4, speed=0.4, turn=weave(0.3, 7.0))
    scene = Scene(
        [Actor("a", standing(-4.0, 0.0)), Actor("b", driving(3.0, 0.0, turn=weave()))],
        WALLS,
        [person],
        worlds={"b": 1},
    )
    for until in range(1, 25):
        scene.run(float(until))
        assert scene.settled("a", "b") is None


@pytest.mark.parametrize("seed", range(4))
def test_a_chair_is_never_a_robot_however_long_it_stands(seed):
    random = np.random.default_rng(seed)
    chairs = [standing(*random.uniform(-4.0, 4.0, 2).tolist()) for _ in range(6)]
    scene = Scene(
        [Actor("a", standing(-5.0, 0.0)), Actor("b", driving(-5.0, 0.0, turn=weave()))],
        WALLS,
        chairs,
        seed=seed,
        worlds={"b": 1},
    )
    for until in range(2, 20, 2):
        scene.run(float(until))
        assert scene.settled("a", "b") is None and scene.settled("b", "a") is None


def test_a_third_robot_without_radio_that_starts_alike_is_not_taken_for_the_one_that_is_heard():
    """Both drive off at the same time and speed, and turn a little differently later on."""
    scene = Scene(
        [
            Actor("a", standing(-6.0, 0.0)),
            Actor("b", driving(-5.0, 3.0, turn=lambda time: 0.35 if time > 4.0 else 0.0)),
            Actor("silent", driving(-5.0, 1.0, turn=lambda time: -0.3 if time > 4.0 else 0.0), radio=False),
        ],
        WALLS,
        worlds={"b": 1},
    )
    for until in range(2, 16):
        scene.run(float(until))
        assert scene.settled("a", "b") is None


def test_a_silent_twin_that_turns_alike_at_first_is_not_believed():
    """For a moment its way is unmistakable; then it goes another way."""

    def way(after):
        return lambda time: 0.8 if 1.0 < time < 2.0 else after if time > 3.6 else 0.0

    scene = Scene(
        [
            Actor("a", standing(-6.0, 0.0)),
            Actor("b", driving(-5.0, -2.0, turn=way(0.7)), view=NARROW),
            Actor("silent", driving(-5.0, -2.0, turn=way(-0.7)), radio=False),
        ],
        WALLS,
        worlds={"b": 1},
    )
    for step in range(1, 81):
        scene.run(0.2 * step)
        assert scene.settled("a", "b") is None


def test_a_robot_that_should_see_the_own_one_and_does_not_is_somebody_else():
    turn = weave(0.5, 9.0)
    scene = Scene(
        [
            Actor("a", standing(-4.0, 0.0)),
            Actor("b", driving(0.0, -2.0, math.pi, 0.25, turn)),
            Actor("silent", driving(0.0, -2.0, math.pi, 0.25, turn), radio=False),
        ],
        WALLS,
        worlds={"b": 1},
    )
    scene.run(12.0)
    assert scene.settled("a", "b") is None
    assert scene.meetings["a"].why("b") == "b does not see this robot, though nothing hides it"


def test_of_two_robots_the_one_that_is_heard_is_found():
    scene = Scene(
        [
            Actor("a", standing(-6.0, 0.0)),
            Actor("b", driving(-4.0, 2.0, turn=weave())),
            Actor("silent", driving(-4.0, -2.0, turn=weave(-0.5)), radio=False),
        ],
        WALLS,
    )
    scene.run(12.0)
    assert_right(scene.settled("a", "b"), scene.truth("b", "a"), 0.25)


def test_robots_in_copies_of_a_room_never_meet():
    scene = Scene(
        [
            Actor("a", driving(-3.0, 0.5, 0.2, turn=weave())),
            Actor("b", driving(-3.0, -1.0, 2.9, turn=weave(-0.6, 5.0))),
        ],
        WALLS,
        worlds={"b": 1},
    )
    for until in range(2, 30, 2):
        scene.run(float(until))
        assert not any(each.path > 0.3 for each in scene.hypotheses("a", "b"))


def test_turtlebots_meet_only_when_they_face_one_another():
    def scene_of(yaw):
        return Scene(
            [
                Actor("a", standing(-2.0, 0.0, yaw), view=NARROW, farthest=4.0, nearest=0.45),
                Actor("b", driving(0.5, -1.0, 2.2, 0.2, turn=weave()), view=NARROW, farthest=4.0, nearest=0.45),
            ],
            WALLS,
        )

    away = scene_of(math.pi).run(14.0)
    assert away.settled("a", "b") is None and away.meetings["a"].why("b") == "not seen"
    facing = scene_of(0.0).run(14.0)
    assert_right(facing.settled("a", "b"), facing.truth("b", "a"), 0.3, 3.0)


@pytest.mark.parametrize(("loss", "late"), [(0.0, 0.02), (0.4, 0.3), (0.1, 1.5)])
def test_lost_and_late_reports_cost_time_and_no_exactness(loss, late):
    scene = Scene(
        [Actor("a", standing(-3.0, 0.0)), Actor("b", driving(-1.0, -1.0, 0.3, turn=weave()))],
        WALLS,
        loss=loss,
        late=late,
    )
    scene.run(14.0)
    assert_right(scene.settled("a", "b"), scene.truth("b", "a"))


def test_a_robot_that_starts_anew_is_forgotten():
    scene = Scene([Actor("a", standing(-3.0, 0.0)), Actor("b", driving(-1.0, -1.0, 0.3, turn=weave()))], WALLS)
    scene.run(10.0)
    assert scene.settled("a", "b") is not None
    last = [report for _, report in scene.reports if report.robot == "b"][-1]
    scene.meetings["a"].on_report(replace(last, boot=(2, 0), uptime=0.5), scene.time)
    assert scene.settled("a", "b") is None
    assert all(each.path < 0.5 for each in scene.hypotheses("a", "b"))


def test_a_late_report_of_a_former_run_changes_nothing():
    """It pushed out what the present run had told."""

    def report(boot, uptime, x):
        return TrackReport("b", USUAL_SIZE.body_radius, boot, uptime, poses=np.array([[0.0, x, 0.0, 0.0]]))

    meetings = Meetings("a", USUAL_SIZE, (1, 0))
    meetings.on_own_pose(Pose(), 99.0)
    late = report((1, 1), 50.0, 3.0)
    for told, now in ((late, 100.0), (report((2, 1), 1.0, 5.0), 101.0), (late, 101.5)):
        meetings.on_report(told, now)
    assert meetings.sightings("b", 101.5).told[:, 1].tolist() == [5.0]


def test_a_clock_that_jumps_back_begins_anew_and_meets_again():
    scene = Scene([Actor("a", standing(-3.0, 0.0)), Actor("b", driving(-1.0, -1.0, 0.3, turn=weave()))], WALLS)
    scene.run(10.0)
    meetings = scene.meetings["a"]
    meetings.on_own_pose(Pose(), -500.0)
    assert meetings.hypotheses("b", -500.0) == ()
    again = Scene(scene.robots, WALLS)
    again.meetings["a"] = meetings
    again.run(10.0)
    assert_right(again.settled("a", "b"), again.truth("b", "a"))


def test_who_is_placed_everywhere_neither_tells_nor_watches():
    meetings = Meetings("a", USUAL_SIZE)
    meetings.on_own_pose(Pose(), 0.0)
    meetings.on_team({"b"}, {})
    assert meetings.watching and meetings.report(0.0).unplaced == ("b",)
    meetings.on_team({"b"}, {"b": Pose()})
    assert not meetings.watching and meetings.report(10.0) is None
    meetings.on_report(TrackReport("b", USUAL_SIZE.body_radius, unplaced=("a",)), 10.0)
    assert meetings.watching and meetings.report(10.0).unplaced == ()
    meetings.on_report(TrackReport("b", USUAL_SIZE.body_radius, uptime=1.0), 11.0)
    assert not meetings.watching


def test_the_last_word_of_a_robot_that_fell_silent_does_not_keep_the_others_watching():
    """Who has placed everybody tells nothing any more, and what it told last was that it had not."""
    meetings = Meetings("a", USUAL_SIZE)
    meetings.on_own_pose(Pose(), 0.0)
    meetings.on_report(TrackReport("b", USUAL_SIZE.body_radius, uptime=1.0, unplaced=("c",)), 1.0)
    assert meetings.report(5.0) is not None
    assert meetings.report(10.0) is None
    assert not meetings.watching


def test_reports_are_rare_while_nothing_moves_and_frequent_then():
    still = Scene([Actor("a", standing(-3.0, 0.0)), Actor("b", standing(-1.0, -1.0))], WALLS).run(20.0)
    moving = Scene(
        [Actor("a", standing(-3.0, 0.0)), Actor("b", driving(-1.0, -1.0, 0.3, 0.2, turn=weave()))], WALLS
    ).run(20.0)
    assert len(still.reports) <= 22
    assert len(moving.reports) >= 80


def test_everything_that_is_kept_or_told_is_bounded():
    random = np.random.default_rng(3)
    crowd = [standing(*random.uniform(-5.0, 5.0, 2).tolist()) for _ in range(40)]
    scene = Scene([Actor("a", driving(0.0, 0.0, turn=weave())), Actor("b", standing(1.0, 1.0))], WALLS, crowd)
    scene.run(40.0)
    for _, report in scene.reports:
        assert len(report.poses) <= MOST_POSES and len(report.objects) <= MOST_OBJECTS
        assert all(len(each.samples) <= MOST_SAMPLES for each in report.objects)
    meetings = scene.meetings["a"]
    for number in range(500):
        meetings.on_report(TrackReport(f"robot_{number}", USUAL_SIZE.body_radius, uptime=1.0), scene.time)
    sightings = meetings.sightings("robot_499", scene.time)
    assert len(sightings.others) <= 64 and meetings.sightings("robot_0", scene.time) is None
    assert len(sightings.objects) <= 40 and len(sightings.own) <= 300 and len(sightings.sweeps.times) <= 120


@pytest.mark.parametrize(
    "fields",
    [
        {"robot": ""},
        {"poses": np.full((2, 4), np.nan)},
        {"poses": np.array([[-1.0, 0.0, 0.0, 0.0]])},
        {"poses": np.array([[0.0, 1e9, 0.0, 0.0]])},
        {"poses": np.zeros((MOST_POSES + 1, 4))},
        {"objects": (ToldObject(1, np.zeros((MOST_SAMPLES + 1, 3))),)},
        {"objects": (ToldObject(1, np.full((1, 3), np.inf)),)},
        {"uptime": math.nan},
        {"body_radius": 0.0},
    ],
)
def test_a_report_that_cannot_be_used_is_refused(fields):
    with pytest.raises(ValueError, match="track"):
        TrackReport(**{"robot": "b", "body_radius": USUAL_SIZE.body_radius, **fields})


def test_a_rival_is_a_transform_for_which_nearly_as_much_speaks():
    scene = Scene([Actor("a", standing(-3.0, 0.0)), Actor("b", driving(-1.0, -1.0, 0.3, turn=weave()))], WALLS)
    scene.run(10.0)
    best = scene.hypotheses("a", "b")[0]
    assert rival_of(best, [best, replace(best, samples=best.samples // 3)]) is None
    assert rival_of(best, [best, replace(best, samples=best.samples - 3)]) is not None


def test_without_a_laser_a_robot_is_found_in_the_maps():
    """Drawn as a map shows it: where the robot is now."""
    way = driving(1.0, -1.0, 0.5, 0.3, turn=weave())
    watcher, driver = Meetings("a", USUAL_SIZE, (1, 0)), Meetings("b", USUAL_SIZE, (1, 1))
    info = GridInfo(160, 160, 0.05, Pose(-4.0, -4.0))
    rows, columns = np.mgrid[:160, :160]
    for step in range(1, 150):
        time, place = 0.1 * step, way(0.1 * step)
        for meetings, other in ((watcher, "b"), (driver, "a")):
            meetings.on_team({other}, {})
        watcher.on_own_pose(Pose(), time)
        if step % 10 == 0:
            centres = (columns + 0.5) * 0.05 - 4.0, (rows + 0.5) * 0.05 - 4.0
            body = np.hypot(centres[0] - place.x, centres[1] - place.y) < 0.2
            watcher.on_map(OccupancyGrid(info, np.where(body, 100, 0).astype(np.int8)), time)
        driver.on_own_pose(way(0.0).inverse().compose(place), time)
        report = driver.report(time)
        if report is not None:
            watcher.on_report(report, time)
    best = watcher.hypotheses("b", 14.9)[0]
    assert best.settled
    assert_right(best.transform, way(0.0), 0.25, 3.0)


def test_for_a_base_station_its_reference_robot_sees():
    """It neither drives nor looks: what two robots tell of themselves and of one another has to do."""
    robots = [Actor("a", driving(-3.0, 0.0, turn=weave())), Actor("b", driving(-1.0, -1.0, 0.3, turn=weave()))]
    scene = Scene([*robots, Actor("c", standing(2.0, 1.5, 1.0))], WALLS).run(10.0)
    base = Meetings("base", USUAL_SIZE)
    for time, report in scene.reports:
        base.on_report(report, time + 100.0)
    base.on_team({"a", "b", "c"}, {})
    assert base.hypotheses("b", 110.0) == ()
    base.on_team({"a", "b", "c"}, {"a": Pose()}, "a")
    best = base.hypotheses("b", 110.0)[0]
    assert best.settled
    assert_right(best.transform, scene.truth("b", "a"))
    base.on_team({"a", "b", "c"}, {"b": Pose()}, "b")
    assert_right(base.hypotheses("a", 110.0)[0].transform, scene.truth("a", "b"))
    assert base.hypotheses("a", 150.0) == (), "nothing is told any more"


class LateScans(Scene):
    """Scans wait 0.3 s for the transforms of their time; poses of the present come in between."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.kept = []

    def step(self):
        self.time += 0.1
        self._deliver()
        for robot in self.robots:
            meetings = self.meetings[robot.name]
            meetings.on_team({other.name for other in self.robots if other is not robot}, {})
            pose = self.frame(robot).inverse().compose(robot.way(self.time))
            self.kept.append((robot.name, self.scan(robot), pose, self.time))
            if round(10.0 * self.time) % 5 == 0:
                meetings.on_own_pose(pose, self.time)
            report = meetings.report(self.time)
            if report is not None:
                self._send(robot, report)
        while self.kept and self.kept[0][3] < self.time - 0.25:
            name, scan, pose, time = self.kept.pop(0)
            self.meetings[name].on_scan(scan, pose, time)


def test_scans_that_wait_for_their_transforms_count_at_their_own_time():
    """They were dated 0.3 s late; and a scan before the last pose must not pass for a clock that jumped back."""
    robots = [Actor("a", driving(-3.0, 0.0, turn=weave())), Actor("b", driving(-1.0, -1.0, 0.3, turn=weave()))]
    scene = LateScans(robots, WALLS).run(10.0)
    for own, other in (("a", "b"), ("b", "a")):
        assert_right(scene.settled(own, other), scene.truth(other, own), 0.12)
        assert scene.hypotheses(own, other)[0].seconds > 5.0
