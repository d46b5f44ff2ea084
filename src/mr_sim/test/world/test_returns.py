"""What models return to lasers and to robots that drive into them: `ranger_return`, `obstacle_return`,
through definitions, models in models and parts of robots, as Stage 4.3 has it: each model's own words count."""

import pytest

ROVER = 'rover ( name "a" pose [ 0 0 0 0 ] )\n'
DEFINED = """
define glass model ( size [ 0.2 4 1 ] ranger_return -1 )
define curtain model ( size [ 0.2 4 1 ] obstacle_return 0 )
define ghost model ( size [ 0.2 4 1 ] ranger_return -1 obstacle_return 0 )
define frame model ( size [ 0 0 0 ] ranger_return -1 obstacle_return 0 )
define pane glass ( size [ 0.2 4 1 ] )
"""
SEEN, UNSEEN = 0.9, 8.0  # m, of a wall 0.2 m thick at x = 1.1 m by a laser at 0.1 m


def returns(world, drive) -> tuple[bool, bool]:
    """Whether the rover's laser sees what stands before it, and whether it runs into that."""
    ahead = world.core.scan(0, 0)[270]
    assert ahead == pytest.approx(SEEN, abs=0.03) or ahead == UNSEEN
    drive(world, 4.0, (0.5, 0.0))
    return ahead < UNSEEN, bool(world.states()[0]["stalled"])


@pytest.mark.parametrize(
    ("model", "seen", "solid"),
    [
        ("model ( {} )", True, True),
        ("model ( {} ranger_return 0 )", True, True),  # an echo without strength
        ("model ( {} ranger_return 0.5 )", True, True),
        ("model ( {} ranger_return -1 )", False, True),
        ("model ( {} ranger_return -0.001 )", False, True),
        ("model ( {} laser_return 0 )", True, True),  # of Stage 3
        ("model ( {} laser_return 2 ranger_return 1 )", True, True),
        ("model ( {} obstacle_return 0 )", True, False),
        ("model ( {} obstacle_return 0 ranger_return -1 )", False, False),
        ("model ( {} noblocks 1 boundary 1 )", True, True),
        ("model ( {} noblocks 1 boundary 1 ranger_return -1 )", False, True),
        ("model ( {} noblocks 1 boundary 1 obstacle_return 0 )", True, False),
        ("model ( {} map_resolution 0.5 )", True, True),
        ("glass ( {} )", False, True),
        ("pane ( {} )", False, True),
        ("glass ( {} ranger_return 1 )", True, True),
        ("curtain ( {} )", True, False),
        ("curtain ( {} obstacle_return 1 )", True, True),
        ("ghost ( {} )", False, False),
        ("frame ( model ( {} ) )", True, True),
        ("frame ( frame ( glass ( {} ) ) )", False, True),
        ("model ( size [ 0 0 0 ] curtain ( {} ) )", True, False),
        ("model ( pose [ 0 0 0 180 ] size [ 0 0 0 ] model ( size [ 0.2 4 1 ] pose [ -1.1 0 0 0 ] ) )", True, True),
        ("model ( size [ 0.2 4 1 ] pose [ 0.6 0 0 0 ] origin [ 0.5 0 0 0 ] )", True, True),
    ],
)
def test_a_model_returns_what_its_own_words_say(make_world, drive, model, seen, solid):
    world = make_world(DEFINED + ROVER + model.format("size [ 0.2 4 1 ] pose [ 1.1 0 0 0 ]"))
    assert returns(world, drive) == (seen, solid)


@pytest.mark.parametrize(
    ("words", "part", "seen", "solid"),
    [
        ("", "", True, True),
        ("ranger_return -1", "", False, True),
        ("obstacle_return 0", "", True, False),
        # The body of one without a size is its part alone.
        ("size [ 0 0 0 ]", "model ( size [ 0.2 4 1 ] )", True, True),
        ("size [ 0 0 0 ]", "glass ( )", False, True),
        ("size [ 0 0 0 ]", "model ( size [ 0 0 0 ] glass ( ) )", False, True),
        ("size [ 0 0 0 ] ranger_return -1", "model ( size [ 0.2 4 1 ] )", True, True),
        ("size [ 0 0 0 ] obstacle_return 0", "model ( size [ 0.2 4 1 ] )", True, True),
        ("size [ 0.1 0.1 1 ] obstacle_return 0", "model ( size [ 0.2 4 1 ] )", True, True),
        ("ranger_return -1", "glass ( )", False, True),
        (
            "size [ 0 0 0 ]",
            'gripper ( size [ 0.2 4 1 ] ranger_return -1 paddle_state [ "closed" "down" ] )',
            False,
            True,
        ),
    ],
)
def test_a_part_of_a_robot_returns_what_its_own_words_say(make_world, drive, words, part, seen, solid):
    other = f'position ( name "b" size [ 0.2 4 1 ] pose [ 1.1 0 0 0 ] {words} {part} )'
    assert returns(make_world(DEFINED + ROVER + other), drive) == (seen, solid)


def test_a_body_that_stops_nothing_is_left_out_where_there_are_parts_and_that_is_told(make_world):
    """As a part with obstacle_return 0: what is seen may be touched."""
    part = "model ( size [ 0.2 0.2 1 ] pose [ 0.3 0 0 0 ] )"
    world = make_world(f"position ( size [ 2 2 1 ] obstacle_return 0 {part} )")
    (robot,) = world.robots
    assert len(robot.footprint) == len(robot.seen) == 1 and robot.solid
    assert "body with obstacle_return 0 of a robot that has parts" in world.description.warning
    assert "ranger_return" not in make_world("position ( model ( ranger_return -1 ) )").description.warning
