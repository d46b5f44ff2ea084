"""Whole agents that see and hear one another, in small scenes on virtual time."""

import math
import re

import numpy as np
import pytest
from agent_scene import AgentScene
from meeting_scene import NARROW, Actor, Scene, Wall, driving, room

from mr_grid import Pose

SMALL = room(7.0, 6.0)
"""Of less wall than what convinces alone."""


def weave(rate=0.5, period=6.0):
    return lambda time: rate * math.sin(2.0 * math.pi * time / period)


def circling(x, y, radius=0.8, speed=0.25, begin=0.0):
    """Round a point from 2 s on."""

    def way(time):
        angle = begin + speed / radius * max(0.0, time - 2.0)
        ahead = angle + math.copysign(0.5 * math.pi, speed)
        return Pose(x + radius * math.cos(angle), y + radius * math.sin(angle), ahead)

    return way


def equal_rooms(count=4, width=5.0, depth=4.0, door=1.2):
    """A row of copies of a room, open to a hall on the north side; the second one around the origin."""
    walls = []
    for number in range(count):
        left, right = (number - 1.5) * width, (number - 0.5) * width
        x0, y0, y1 = left, -0.5 * depth, 0.5 * depth
        gap = left + 0.3 * width
        walls += [Wall(x0, y0, right, y0), Wall(x0, y0, x0, y1), Wall(x0, y1, gap, y1), Wall(gap + door, y1, right, y1)]
    ends = -1.5 * width, (count - 1.5) * width
    hall = 0.5 * depth + 2.0
    corners = [(ends[0], 0.5 * depth), (ends[0], hall), (ends[1], hall), (ends[1], -0.5 * depth)]
    return [*walls, *(Wall(*first, *second) for first, second in zip(corners, corners[1:]))]


def side_by_side(seed=1, lost=None):
    """Three robots that set off together in one of several equal rooms."""
    robots = [
        Actor("robot_0", circling(1.2, -0.8, 0.7, 0.3, begin=math.pi)),
        Actor("robot_1", circling(-1.2, -0.7, 0.8, -0.25)),
        Actor("robot_2", circling(0.0, 0.9, 0.5, 0.2, begin=-1.6)),
    ]
    return AgentScene(Scene(robots, equal_rooms(), seed=seed), lost)


@pytest.mark.parametrize("seed", [1, 2])
def test_robots_side_by_side_in_equal_rooms_are_placed_seconds_after_they_set_off(seed):
    scene = side_by_side(seed)
    scene.run(2.0)
    assert not any(agent.view.transforms() for agent in scene.team.agents.values())
    assert scene.until_placed(12.0) <= 12.0
    scene.run(scene.time + 3.0)
    assert_same_everywhere(scene.team)


def assert_same_everywhere(team, shift=0.05, turn=0.5):
    """Every robot has the same picture of the team: transforms there and back again are none."""
    for own, agent in team.agents.items():
        for robot, there in agent.view.transforms().items():
            loop = there.compose(team.agents[robot].view.transforms()[own])
            assert math.hypot(loop.x, loop.y) <= shift, (own, robot)
            assert abs(loop.yaw) <= math.radians(turn), (own, robot)


def test_sightings_place_robots_though_a_third_of_all_messages_is_lost():
    before = side_by_side().until_placed(12.0)
    random = np.random.default_rng(3)
    lost = []

    def lose(*_):
        lost.append(bool(random.random() < 0.3))
        return lost[-1]

    after = side_by_side(lost=lose).until_placed(before + 6.0)
    assert after <= before + 6.0 < 20.0 and sum(lost) > 0.2 * len(lost)


def test_a_person_who_crosses_between_two_robots_that_drive_is_never_taken_for_one():
    """`run` asserts at each step that who is placed is placed right."""
    robots = [
        Actor("robot_0", driving(-2.4, 0.8, -0.2, speed=0.3, turn=weave())),
        Actor("robot_1", driving(2.2, -0.8, 2.9, speed=0.3, turn=weave(-0.6, 5.0))),
    ]
    person = driving(0.0, -2.3, 1.5, speed=0.35, turn=weave(0.3, 7.0))
    scene = AgentScene(Scene(robots, SMALL, [person]))
    assert scene.until_placed(15.0) <= 15.0
    scene.run(scene.time + 3.0)


def copies_of_a_room(others=()):
    """Two robots that hear and do not see one another; each sees the others."""
    robots = [
        Actor("robot_0", circling(-1.5, 0.0)),
        Actor("robot_1", circling(0.8, -0.8, 1.0, 0.3, begin=2.0)),
    ]
    return AgentScene(Scene(robots, SMALL, others, worlds={"robot_1": 1}))


@pytest.mark.parametrize("others", [(), (circling(1.8, 1.2, 0.6, 0.2),), (driving(-2.0, -2.0, 0.5, 0.2, weave(0.3)),)])
def test_robots_in_copies_of_a_room_are_never_placed_and_the_status_says_why(others):
    scene = copies_of_a_room(others)
    while scene.time < 30.0:
        scene.step()
        assert not any(agent.view.transforms() for agent in scene.team.agents.values())
    for own, robot in (("robot_0", "robot_1"), ("robot_1", "robot_0")):
        why = scene.why(own, robot)
        assert re.search(r"\d m of \d+ m|two solutions .* apart|was not where this puts it", why) and re.search(
            "not seen|wall in free space", why
        ), why


def test_turtlebots_are_placed_after_they_have_faced_one_another_and_not_before():
    def looker(time):
        yaw = math.pi * (1.0 - min(1.0, max(0.0, (time - 12.0) / 3.0)))
        return Pose(-2.2, 0.0, yaw)

    view = dict(view=NARROW, farthest=4.0, nearest=0.45)
    scene = AgentScene(Scene([Actor("robot_0", looker, **view), Actor("robot_1", circling(0.6, 0.0), **view)], SMALL))
    while scene.time < 12.0:
        scene.step()
        assert not any(agent.view.transforms() for agent in scene.team.agents.values())
    assert scene.until_placed(27.0) <= 27.0
