"""What worlds promise to robots that drive in them, for every kind and size."""

import hashlib
import itertools
import math

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mr_plans import WORLD_KINDS, FloorPlan, anywhere, side_by_side, world_plan
from mr_plans.passable import NARROW_CELLS, WIDE_CELLS, passable, places, reachable
from mr_plans.starts import ABREAST_M, BEHIND_M
from mr_plans.worlds import LONGEST_M, SHORTEST_M

OPEN_SHARE = 0.12
"""Of the building, at least, that robots can drive through: dead rock and solid blocks take the rest."""

RADIUS = 0.29  # m, of the robots of generated worlds


@st.composite
def worlds(draw):
    kind = draw(st.sampled_from(list(WORLD_KINDS)))
    length = draw(st.floats(SHORTEST_M, 60.0))
    depth = draw(st.floats(WORLD_KINDS[kind].shallowest, 40.0))
    return kind, draw(st.integers(0, 2**40)), (length, depth)


@settings(max_examples=60)
@given(worlds())
def test_a_world_is_one_connected_space_closed_outside(world):
    kind, _, size = world
    plan = world_plan(*world)
    assert plan.walls[[0, 1, -1, -2]].all() and plan.walls[:, [0, 1, -1, -2]].all()
    count, _ = cv2.connectedComponents(places(plan.walls, WORLD_KINDS[kind].room).astype(np.uint8), connectivity=4)
    assert count == 2, "all places to drive through are one part (the other is the walls)"
    assert reachable(plan.walls, WORLD_KINDS[kind].room).sum() * plan.resolution**2 > OPEN_SHARE * size[0] * size[1]
    assert np.abs(np.array(plan.walls.shape[::-1]) * plan.resolution - size).max() <= plan.resolution
    with_room = cv2.dilate(reachable(plan.walls, WORLD_KINDS[kind].room).astype(np.uint8), np.ones((15, 15)))
    assert not (reachable(plan.walls, NARROW_CELLS) & (with_room == 0)).any(), "nothing lies behind a narrower opening"
    assert not (plan.furniture & ~plan.walls).any()


@settings(max_examples=40)
@given(worlds(), st.booleans())
def test_sixteen_robots_start_free_and_apart(world, spread):
    plan = world_plan(*world)
    starts = (anywhere if spread else side_by_side)(plan, world[1], RADIUS)
    assert len(starts) == 16
    cells = np.array([(int(y / plan.resolution), int(x / plan.resolution)) for x, y, _ in starts])
    assert (places(plan.walls, 6) & reachable(plan.walls))[cells[:, 0], cells[:, 1]].all()
    between = np.hypot(*(np.array(starts)[:, None, :2] - np.array(starts)[None, :, :2]).transpose(2, 0, 1))
    np.fill_diagonal(between, np.inf)
    assert between.min() >= 2.0 * RADIUS + ABREAST_M - 1e-6
    if not spread:
        nearest = [between[number, :number].min() for number in range(1, 16)]
        assert max(nearest) <= 2.0 * RADIUS + BEHIND_M + 1e-6, "each stands beside one of those before it"
        assert {heading for _, _, heading in starts} == {0.0}


@pytest.mark.parametrize("kind", WORLD_KINDS)
@pytest.mark.parametrize("size", [(SHORTEST_M, 18.0), (LONGEST_M, 60.0), (18.0, LONGEST_M)])
def test_every_kind_comes_in_every_size(kind, size):
    plan = world_plan(kind, 5, size)
    assert plan.walls.shape == (round(size[1] / 0.05), round(size[0] / 0.05))
    assert len(side_by_side(plan, 5, RADIUS)) == 16


@pytest.mark.parametrize("radius", [0.18, 0.5])
def test_larger_robots_start_farther_apart_and_from_walls(radius):
    plan = world_plan("hall", 7, (30.0, 20.0))
    for place in (side_by_side, anywhere):
        starts = place(plan, 7, radius, 4)
        cells = np.array([(int(y / plan.resolution), int(x / plan.resolution)) for x, y, _ in starts])
        assert places(plan.walls, math.floor(radius / plan.resolution))[cells[:, 0], cells[:, 1]].all()
        assert min(math.dist(one[:2], other[:2]) for one, other in itertools.combinations(starts, 2)) > 2.0 * radius


HASHES = {
    "office": "ba30a226cc1b",
    "equalrooms": "d0659ac3fc75",
    "rooms": "22eeb94faed1",
    "hospital": "9ecf3a00be88",
    "laboratory": "55a9e92e5bb7",
    "hall": "2125548b7b57",
    "cave": "370ee16f734f",
    "loop": "fe8d610dc720",
    "corridor": "4a8331fc199d",
    "narrow": "3ff7672eb7fd",
}


@pytest.mark.parametrize(("kind", "expected"), HASHES.items())
def test_a_seed_gives_the_same_world_on_every_computer(kind, expected):
    plan = world_plan(kind, 7)
    starts = repr(side_by_side(plan, 7, RADIUS)) + repr([(x, y) for x, y, _ in anywhere(plan, 7, RADIUS)])
    assert hashlib.sha256(np.packbits(plan.walls).tobytes() + starts.encode()).hexdigest()[:12] == expected


def test_seeds_and_kinds_differ():
    walls = [world_plan(kind, seed, (20.0, 18.0)).walls.tobytes() for kind in WORLD_KINDS for seed in range(4)]
    assert len(set(walls)) == len(walls)


def test_doors_of_a_narrow_world_are_too_narrow_for_wider_robots_only():
    plan = world_plan("narrow", 2)
    wider = places(plan.walls, 7).astype(np.uint8)
    rooms = cv2.connectedComponentsWithStats(wider, connectivity=4)[2][1:, cv2.CC_STAT_AREA]
    assert (rooms * plan.resolution**2 > 1.0).sum() >= 4, "0.6 m of door do not pass what needs 0.75 m"


def test_furniture_that_blocks_a_door_goes_and_a_closed_cell_is_filled():
    walls = np.zeros((120, 160), bool)
    walls[58:60] = True
    walls[58:60, 30:48] = False
    furniture = np.zeros_like(walls)
    furniture[52:66, 28:50] = True
    furniture[100:110, 140:150] = True
    walls[20:42, 100:122] = True
    walls[22:40, 102:120] = False
    plan = passable(FloorPlan(walls | furniture, furniture=furniture))
    assert reachable(plan.walls)[30, 40] and reachable(plan.walls)[90, 40]
    assert not plan.walls[58, 39] and plan.walls[105, 145]
    assert not places(plan.walls, WIDE_CELLS)[25:38, 105:118].any()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("castle", 1), "castle"),
        (("office", -1), "seed"),
        (("office", 1, (14.0, 20.0)), "14 m"),
        (("office", 1, (20.0, 101.0)), "101 m"),
        (("hospital", 1, (40.0, 12.0)), "12 m"),
        (("office", 1, (float("nan"), 20.0)), "nan"),
    ],
)
def test_what_cannot_be_is_named(arguments, told):
    with pytest.raises(ValueError, match=told):
        world_plan(*arguments)


def test_a_plan_without_room_is_an_error():
    plan = FloorPlan(np.pad(np.zeros((30, 30), bool), 2, constant_values=True))
    for place in (side_by_side, anywhere):
        with pytest.raises(ValueError, match="16 robots"):
            place(plan, 1, RADIUS)
