"""What of the ground a robot covers, as navigation measures it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from usual_robot import navigation_with

from mr_robot import _navigation
from mr_robot.navigation.options import NavigationError
from mr_robot.platforms.engines import navigation_options
from mr_robot.platforms.preset import load_platform

TURTLEBOT = load_platform("turtlebot")
SIZES = st.floats(0.05, 1.5)
PLACES = st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))


def from_box(length: float, width: float, x: float, y: float) -> float:
    ahead, beside = abs(x) - length, abs(y) - width
    return math.hypot(ahead, beside) if min(ahead, beside) > 0.0 else max(ahead, beside)


@given(SIZES, SIZES, PLACES)
def test_without_a_radius_it_is_a_box(length, width, place):
    footprint = _navigation.Footprint(length, width)
    assert footprint.radius == pytest.approx(math.hypot(length, width))
    assert footprint.distance(*place) == pytest.approx(from_box(length, width, *place), abs=1e-9)


@given(SIZES, PLACES)
def test_a_disc_is_a_disc(radius, place):
    distance = _navigation.Footprint(radius, radius, radius).distance(*place)
    assert distance == pytest.approx(math.hypot(*place) - radius, abs=1e-9)


@given(SIZES, SIZES, st.floats(0.0, 1.0), PLACES)
def test_a_place_is_inside_if_it_is_in_the_box_and_within_the_radius(length, width, share, place):
    radius = max(length, width) + share * (math.hypot(length, width) - max(length, width))
    distance = _navigation.Footprint(length, width, radius).distance(*place)
    both = max(from_box(length, width, *place), math.hypot(*place) - radius)
    assert distance == pytest.approx(both, abs=1e-9)


def test_a_round_robot_turns_where_a_box_of_its_size_cannot():
    """Turtlebots were planned as boxes: they turned nowhere but where 0.25 m around them were free."""
    options = navigation_options(TURTLEBOT, (TURTLEBOT,))
    angles = np.linspace(-math.pi, math.pi, 60)
    ring = np.column_stack([0.22 * np.cos(angles), 0.22 * np.sin(angles), np.zeros(60), np.zeros(60)])
    disc, box = options.footprint, _navigation.Footprint(0.177, 0.177)
    assert _navigation.has_room_to_turn((0.0, 0.0, 0.0), ring, disc)
    assert not _navigation.has_room_to_turn((0.0, 0.0, 0.0), ring, box)
    assert _navigation.clearance((0.0, 0.0, 0.3), ring, disc) == pytest.approx(0.043)
    assert options.circumscribed_radius == 0.177


def test_a_radius_that_cuts_into_the_sides_is_refused():
    with pytest.raises(NavigationError, match=r"footprint_radius must be at least half the longer side, 0\.22 m, or 0"):
        navigation_with(footprint_radius=0.2)
