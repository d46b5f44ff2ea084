"""Perfect local maps, merging and radio: the strategy alone."""

import itertools
import math
import time
from dataclasses import replace

import numpy as np
import pytest

from map_merger.exchange import bounds
from map_merger.options import options_of
from mr_experiments.common.stopwatch import Stopwatch
from mr_experiments.host.agenda import Agenda
from mr_experiments.host.fast.fast_body import FastBody
from mr_experiments.host.fast.perfect_merging import PerfectMerger
from mr_experiments.host.fast.perfect_radio import PerfectRadio
from mr_experiments.host.fast.team_sight import TeamSight
from mr_experiments.host.fast.wheels import Wheels
from mr_experiments.sweep.record import run_trial
from mr_experiments.trial.trial import Trial
from mr_experiments.trial.trial_world import world_of
from mr_grid import OccupancyGrid, Pose
from mr_measures.figures import coverage, wrong_walls
from mr_measures.record.robot_record import Contacts
from mr_measures.true_map import TrueMap
from mr_measures.truth import Truth
from mr_robot.navigation.options import NavigationOptions
from mr_robot.platforms.engines import defaults_of
from mr_sim.true_world import occupancy_of, true_world_of


def test_teams_explore_everything_and_faster_than_one_alone():
    times = {1: 0.0, 2: 0.0}
    for robots, seed in itertools.product((1, 2), (1, 2, 3)):
        record = run_trial(Trial("small8x8", robots, seed, limit=300.0, fast=True))
        assert record.outcome.status == "finished"
        times[robots] += record.team.exploration_time
        for robot in record.robots.values():
            assert robot.map.coverage > 0.99 and robot.map.wrong_walls == 0.0
            assert all(merge.offset < 0.05 for merge in robot.merges) and len(robot.merges) >= robots - 1
            assert robot.collisions == Contacts()
            assert robot.map.error is None and "SLAM" in robot.map.error_reason
    assert times[2] < times[1]


def test_seeds_make_different_missions():
    times = {run_trial(Trial("small8x8", 2, seed, fast=True)).team.exploration_time for seed in (1, 2, 3, 4)}
    assert len(times) > 1


@pytest.fixture
def world():
    return world_of(Trial("small8x8", 1, 1))


def navigation_with(**options):
    return NavigationOptions(**{**defaults_of(NavigationOptions), **options})


def body_in(world, field_of_view=None, **options):
    start, ranger = world.pose(0), world.robots[0].rangers[0]
    ranger = replace(ranger, field_of_view=field_of_view or ranger.field_of_view)
    sight = TeamSight({"robot_0": start})
    body = FastBody("robot_0", start, ranger, navigation_with(**options), world.visible, sight, Stopwatch())
    body.look()
    return body


def test_what_is_seen_is_true_and_bounded_by_walls(world):
    start = world.pose(0)
    body = body_in(world)
    body.look()
    occupancy = body.new_map(0.0)
    truth = Truth.of_world(true_world_of(world))
    assert 0.05 < coverage(truth, occupancy, start) < 0.9
    assert wrong_walls(truth, occupancy, start) == 0.0
    assert body.new_map(1.0) is None and body.new_map(2.0) is not None


def driven(body, goal, steps=100):
    """Poses after each step of 0.1 s, and how the goal ended."""
    ends, poses = [], []
    body.on_goal_end = lambda *end: ends.append(end)
    for step in range(steps):
        body.look()
        grid = body.new_map(0.1 * step)
        if grid is not None:
            body.set_map(grid)
        if step == 0:
            body.set_goal(1, goal, 0.0)
        body.drive(0.1)
        poses.append(body.pose)
    return poses, ends


def test_goals_end_as_the_action_would_end_them(world):
    body = body_in(world, yaw_goal_tolerance=0.1)
    poses, ends = driven(body, Pose(0.8, 0.1, 1.0))
    assert ends == [(1, True, "goal reached")]
    assert math.dist(body.pose[:2], (0.8, 0.1)) < 0.3 and abs(body.pose[2] - 1.0) < 0.15 and body.pose != poses[0]
    body.set_goal(2, Pose(500.0, 0.0, 0.0), 10.0)
    assert ends[-1] == (2, False, "there is no way")


def test_any_heading_will_do_where_it_does_for_navigation(world):
    poses, ends = driven(body_in(world), Pose(0.8, 0.0, math.pi))
    assert ends == [(1, True, "goal reached")] and abs(poses[-1].yaw) < 0.5


def test_robot_that_sees_little_looks_around_before_it_drives(world):
    poses, _ = driven(body_in(world, field_of_view=1.0), Pose(0.8, 0.0, 0.0))
    first = next(index for index, pose in enumerate(poses) if math.dist(pose[:2], (0.0, 0.0)) > 0.05)
    assert max(pose.yaw for pose in poses[:first]) > 2.0 * math.pi - 0.1
    others = (
        driven(body_in(world), Pose(0.8, 0.0, 0.0)),
        driven(body_in(world, 1.0, look_around=False), Pose(0.8, 0.0, 0.0)),
    )
    assert all(max(pose.yaw for pose in poses) < 0.5 for poses, _ in others)


def test_wheels_keep_to_what_the_drive_can_do():
    options = navigation_with()
    wheels = Wheels(options)
    yaw, before, last = 0.0, (0.0, 0.0), 0.0
    for step in range(60):
        off = math.remainder(2.5 - yaw, 2.0 * math.pi)
        wheels.towards(off, 0.1) if step < 40 else wheels.brake(0.1)
        (speed, turn), (former_speed, former_turn) = wheels.velocity, before
        assert abs(speed - former_speed) <= 0.1 * options.linear_acceleration + 1e-9
        assert abs(turn - former_turn) <= 0.1 * options.angular_acceleration + 1e-9
        assert 0.0 <= speed <= options.max_linear_velocity and abs(turn) <= options.max_angular_velocity
        assert speed == 0.0 or last > 0.0 or abs(off) < math.pi / 2.0  # it drives no way back
        yaw, before, last = yaw + 0.1 * turn, wheels.velocity, speed
        if step == 39:
            assert speed == options.max_linear_velocity and yaw == pytest.approx(2.5, abs=0.05)
    assert wheels.velocity == (0.0, 0.0)


class Ear:
    def __init__(self):
        self.heard, self.present = [], []

    def on_packet(self, topic, message, now):
        self.heard.append((topic, message))

    def on_robot_appeared(self, robot, now):
        self.present.append(robot)

    def on_robot_lost(self, robot, now):
        self.present.remove(robot)


def test_perfect_radio_reaches_exactly_those_meant():
    agenda = Agenda()
    radio = PerfectRadio(agenda)
    ears = [Ear(), Ear(), Ear()]
    done = []
    for i, ear in enumerate(ears):
        radio.add(f"robot_{i}", ear, (0.0, 0.0))
    agenda.run_due(1.0)
    assert [sorted(ear.present) for ear in ears] == [
        ["robot_1", "robot_2"], ["robot_0", "robot_2"], ["robot_0", "robot_1"]
    ]  # fmt: skip
    radio.advance(1.0)
    radio.send(0, "send_frontier", "mc_robot_0", "frontiers", b"all", lambda *end: done.append(end))
    radio.send(0, "send_control_message", "robot_2", "control", b"one", lambda *end: done.append(end))
    radio.send(0, "send_control_message", "robot_9", "control", b"none", lambda *end: done.append(end))
    agenda.run_due(2.0)
    assert [ear.heard for ear in ears] == [[], [("frontiers", b"all")], [("frontiers", b"all"), ("control", b"one")]]
    assert done == [(True, ""), (True, ""), (False, "no such robot")]
    radio.switch_off(1)
    agenda.run_due(3.0)
    assert ears[0].present == ["robot_2"] and radio.neighbors(0) == ["robot_2"]
    assert np.isclose(radio.statistics(0)["bytes_sent"], 10)


class Published:
    def __init__(self):
        self.grid, self.positions = None, {}

    def on_global_map(self, grid, now):
        self.grid = grid

    def on_positions(self, positions, now):
        self.positions = positions

    def on_note(self, text, warning, now):
        raise AssertionError(text)


def known_cells(published):
    return int((published.grid.cells >= 0).sum())


def square(x, y, edge=1.0):
    return np.array([[x, y], [x + edge, y], [x + edge, y + edge], [x, y + edge]])


class Pair:
    """Two robots in small8x8, which take their local maps every 2 s; robot_0 hears robot_1."""

    def __init__(self, world, **options):
        self.starts = {"robot_0": Pose(2.0, 2.0, 0.5), "robot_1": Pose(5.0, 6.0, -2.0)}
        self.sight, self.agenda = TeamSight(self.starts), Agenda()
        self.published, self.now, self.mapped_at = Published(), 0.0, 0.0
        self.mergers = [self._merger(world, name, options) for name in self.starts]
        self.own = square(2.0, 2.0)
        self.sight.add("robot_0", self.own, self.starts["robot_0"])
        for merger in self.mergers:
            merger.start(0.0)
        self.mergers[0].on_robot("robot_1")

    def _merger(self, world, name, options):
        published = self.published if name == "robot_0" else Published()
        periods = {"seconds_send_timer": 2, "seconds_pub_timer": 2, "seconds_send_position": 1}
        given = options_of({**periods, **options}, name)
        return PerfectMerger(given, TrueMap(occupancy_of(world.visible), self.starts[name]), self.sight, self.agenda,
                             Stopwatch(), published, lambda: self.now)  # fmt: skip

    def run(self, until):
        while self.mapped_at <= until:
            self._run_to(self.mapped_at)
            for merger in self.mergers:
                merger.on_local_map(OccupancyGrid.of(np.zeros((30, 30), dtype=np.int8), 0.1))
            self.mapped_at += 2.0
        self._run_to(until)

    def _run_to(self, now):
        self.now = now
        self.agenda.run_due(now)


def test_maps_are_drawn_when_they_have_been_told_and_placed(world):
    pair = Pair(world)
    pair.run(1.0)
    alone = known_cells(pair.published)
    assert alone == pytest.approx(100, rel=0.3)  # a square metre
    pair.sight.add("robot_1", square(5.0, 2.0), Pose(5.0, 7.0, -2.0))
    pair.run(10.0)
    merger = pair.mergers[0]
    assert pair.sight.told["robot_1"] == 1
    # Nothing tells where the other map lies.
    assert known_cells(pair.published) == alone and pair.published.positions == {}
    assert merger.transforms() == {} and merger.transform_point("robot_1", (0.0, 0.0)) is None

    pair.sight.link("robot_0", "robot_1")
    pair.run(14.0)
    assert known_cells(pair.published) == pytest.approx(2 * alone, rel=0.15)
    expected = pair.starts["robot_0"].between(pair.starts["robot_1"].compose(Pose(1.0, 0.0, 0.0)))
    assert merger.transform_point("robot_1", (1.0, 0.0)) == pytest.approx(expected[:2])
    assert set(merger.transforms()) == {"robot_1"}
    seen_from_start = pair.starts["robot_0"].inverse().apply_point(5.0, 7.0)
    assert pair.published.positions["robot_1"] == pytest.approx(seen_from_start)

    merger.on_robot_lost("robot_1")
    pair.run(16.0)
    assert known_cells(pair.published) > 1.8 * alone and pair.published.positions == {}


def test_changes_are_held_back_as_by_map_merger(world):
    pair = Pair(world)
    pair.run(2.0)
    assert pair.sight.told["robot_0"] == 1
    pair.sight.add("robot_0", square(3.0, 2.0), Pose())
    pair.run(bounds.MARGINAL_HELD_S + 4.0)
    assert pair.sight.told["robot_0"] == 1  # no cell of the local map has changed since


def everything(world):
    return square(0.0, 0.0, 8.0)


@pytest.mark.parametrize(("drives", "given"), [(False, False), (True, False), (False, True)])
def test_shared_walls_place_robots_sooner_when_they_have_met_or_been_told(world, drives, given):
    poses = {"initial_poses": {"robot_0": Pose(2.0, 2.0, 0.5), "robot_1": Pose(5.0, 6.0, -2.0)}} if given else {}
    pair = Pair(world, **poses)
    corner = square(-1.0, -1.0, 6.0)  # shows some 10 m of wall, more than a robot that has met another one needs
    pair.sight.add("robot_0", corner, Pose(2.0, 2.0, 0.5))
    for second in range(8):
        pair.sight.add("robot_1", corner, Pose(3.0 + 0.2 * drives * second, 3.0, -2.0))
        pair.run(float(second))
        pair.mergers[0].on_pose(0.0, 0.0, 0.0)
    assert bool(pair.mergers[0].transforms()) == (drives or given)


def test_much_wall_places_robots_that_have_not_met(world):
    pair = Pair(world)
    for robot in pair.starts:
        pair.sight.add(robot, everything(world), pair.starts[robot])
    pair.run(4.2)
    assert not pair.mergers[0].transforms()
    pair.run(4.4)
    assert set(pair.mergers[0].transforms()) == {"robot_1"}


def test_transforms_chain():
    sight = TeamSight({})
    sight.link("a", "b")
    sight.link("c", "d")
    assert sight.linked("a") == {"a", "b"} and sight.linked("e") == {"e"}
    sight.link("b", "c")
    assert sight.linked("a") == sight.linked("d") == {"a", "b", "c", "d"}


def test_stopwatch_counts_an_inner_span_once_and_in_processor_time():
    watch = Stopwatch()
    begun = time.process_time()
    with watch.span("outer"):
        sum(range(300_000))
        with watch.span("inner"):
            sum(range(600_000))
    spent = watch.seconds()
    assert set(spent) == {"inner", "outer"}
    assert min(spent.values()) > 0.0
    assert spent["inner"] + spent["outer"] <= (time.process_time() - begun) * 1.05 + 1e-3
