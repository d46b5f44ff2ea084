"""The world engine: Stage's semantics, one test each."""

import math

import numpy as np
import pytest

from mr_sim.world import CONTACT_WITH_ROBOT, CONTACT_WITH_WALL, ODOMETRY_MODELS, RANDOM_WALK, World, WorldError
from mr_sim.world_model import load_world
from mr_sim.worlds import find_world

ROVER = 'rover ( name "a" pose [ 0 0 0 0 ] )\n'
WALL_AHEAD = "model ( size [ 0.2 4 1 ] pose [ 1.1 0 0 0 ] )\n"  # its face is at x = 1.0


def test_command_takes_effect_at_the_next_step(make_world):
    world = make_world(ROVER)
    world.step()
    world.command(0, 0.4, 0.0)
    assert world.pose(0) == (0, 0, 0)
    world.step()
    assert world.pose(0) == pytest.approx((0.02, 0, 0)), "full speed at once: velocity control knows no acceleration"


def test_command_waits_for_the_base_update(make_world):
    world = make_world(ROVER.replace(")", "update_interval 100 )"))
    world.step()
    world.command(0, 0.4, 0.0)
    world.step()
    assert world.pose(0)[0] == 0.0 and world.base_due(0)
    world.step()
    assert world.pose(0)[0] == pytest.approx(0.02) and not world.base_due(0)


def test_command_is_clipped_to_velocity_bounds(make_world, drive):
    world = make_world(ROVER)
    drive(world, 1.0, (9.0, 0.0))
    assert world.pose(0)[0] == pytest.approx(0.5)
    drive(world, 1.0, (0.0, -9.0))
    assert world.pose(0)[2] == pytest.approx(-math.pi / 2)


OMNI = 'rover ( name "a" drive "omni" velocity_bounds [ -0.5 0.5 -0.2 0.3 0 0 -90 90 ] %s )\n'


def test_omnidirectional_robot_drives_aside_too(make_world):
    world = make_world(OMNI % "pose [ 0 0 0 90 ]")
    for _ in range(20):
        world.command(0, 0.2, 0.0, lateral=0.25)
        world.step()
    state = world.states()[0]
    assert world.pose(0) == pytest.approx((-0.25, 0.2, math.pi / 2)), "ahead is up, to the left is -x"
    assert (state["linear"], state["lateral"], state["angular"]) == (0.2, 0.25, 0.0)
    assert (state["velocity_x"], state["velocity_y"]) == pytest.approx((-0.25, 0.2))
    assert (state["odometry_x"], state["odometry_y"]) == pytest.approx((0.2, 0.25))


def test_omnidirectional_robot_turns_while_it_drives_aside(make_world):
    world = make_world(OMNI % "")
    for _ in range(20):
        world.command(0, 0.0, 0.5, lateral=0.2)
        world.step()
    x, y, yaw = world.pose(0)
    assert yaw == pytest.approx(0.5)
    state = world.states()[0]
    assert (state["odometry_x"], state["odometry_y"], state["odometry_yaw"]) == pytest.approx((x, y, yaw))
    assert x < -0.02 and 0.15 < y < 0.2


def test_lateral_speed_is_clipped_and_a_differential_drive_has_none(make_world):
    world = make_world(OMNI % "" + 'rover ( name "b" pose [ 3 0 0 0 ] )')
    for lateral, expected in ((9.0, 0.3), (-9.0, -0.2)):
        for robot in (0, 1):
            world.command(robot, 0.0, 0.0, lateral)
        world.step()
        assert world.states()["lateral"].tolist() == [expected, 0.0]
    assert world.pose(1) == (3.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="finite"):
        world.command(0, 0.0, 0.0, math.nan)


def test_omnidirectional_robot_is_blocked_aside(make_world):
    world = make_world("model ( size [ 4 0.2 1 ] pose [ 0 0.5 0 0 ] )\n" + OMNI % "")
    for _ in range(40):
        world.command(0, 0.0, 0.0, lateral=0.3)
        world.step()
    assert world.states()[0]["contact"] == CONTACT_WITH_WALL
    assert 0.19 <= world.pose(0)[1] <= 0.21


@pytest.mark.parametrize("seed", range(3))
def test_odometry_aside_has_a_bias_of_its_own(make_world, seed):
    world = make_world(OMNI % "odom_error [ 0 0.1 0 0 ]", seed=seed)
    for _ in range(20):
        world.command(0, 0.0, 0.0, lateral=0.2)
        world.step()
    aside = world.odometry_bias[0][1]
    assert 0.0 < abs(aside) <= 0.1
    assert world.states()[0]["odometry_y"] == pytest.approx(0.2 * (1.0 + aside))


def test_robot_without_fresh_command_stops_after_half_a_second(make_world):
    world = make_world(ROVER)
    world.command(0, 0.4, 0.0)
    for _ in range(30):
        world.step()
    assert world.pose(0)[0] == pytest.approx(0.4 * 0.5)
    assert world.states()[0]["linear"] == 0.0


def test_commands_must_be_finite(make_world):
    world = make_world(ROVER)
    for linear, angular in ((math.nan, 0.0), (0.0, math.inf)):
        with pytest.raises(ValueError, match="finite"):
            world.command(0, linear, angular)


def test_blocked_robot_stops_without_sliding_and_its_odometry_goes_on(make_world, drive):
    world = make_world(WALL_AHEAD + 'rover ( name "a" pose [ 0 0 0 30 ] )')
    drive(world, 10.0, (0.5, 0.0))
    state = world.states()[0]
    assert state["stalled"] == 1 and state["contact"] == CONTACT_WITH_WALL
    x, y, yaw = world.pose(0)
    corner = x + 0.22 * math.cos(yaw) + 0.19 * math.sin(yaw)
    assert 1.0 - 0.5 * 0.05 < corner <= 1.0, "stands within one step of the wall"
    assert y == pytest.approx(x * math.tan(math.radians(30))), "has not slid along it"
    assert (state["velocity_x"], state["velocity_y"], state["velocity_yaw"]) == (0, 0, 0)
    assert state["odometry_x"] == pytest.approx(5.0)
    drive(world, 1.0, (-0.5, 0.0))
    assert world.pose(0)[0] < x - 0.4 and world.states()[0]["stalled"] == 0


def test_turning_on_the_spot_is_blocked_too(make_world, drive):
    # The corner reaches 0.29 m, the front only 0.22 m.
    world = make_world(WALL_AHEAD + 'rover ( name "a" pose [ 0.76 0 0 0 ] )')
    drive(world, 1.0, (0.0, 1.0))
    assert world.states()[0]["stalled"] == 1
    assert 0.0 < world.pose(0)[2] < 0.5
    assert world.states()[0]["odometry_yaw"] == pytest.approx(1.0)


def test_robots_block_one_another(make_world, drive):
    world = make_world(ROVER + 'rover ( name "b" pose [ 2 0.1 0 180 ] )')
    drive(world, 5.0, (0.5, 0.0), (0.5, 0.0))
    first, second = world.states()
    gap = second["x"] - first["x"] - 0.44
    assert 0.0 <= gap < 0.05
    assert first["contact"] == second["contact"] == CONTACT_WITH_ROBOT


def test_robot_that_is_no_obstacle_is_passed(make_world, drive):
    world = make_world(ROVER + 'rover ( name "b" pose [ 1 0 0 180 ] obstacle_return 0 )')
    drive(world, 4.0, (0.5, 0.0), (0.0, 0.0))
    assert world.pose(0)[0] == pytest.approx(2.0)


def test_ground_truth_velocity_is_in_the_world_frame(make_world, drive):
    world = make_world('rover ( name "a" pose [ 0 0 0 90 ] )')
    drive(world, 0.5, (0.4, 0.0))
    state = world.states()[0]
    assert (state["velocity_x"], state["velocity_y"]) == pytest.approx((0.0, 0.4))
    assert (state["linear"], state["angular"]) == (0.4, 0.0)


def test_odometry_counts_from_the_start_pose(make_world, drive):
    world = make_world('rover ( name "a" pose [ 3 4 0 90 ] )')
    drive(world, 1.0, (0.5, 0.0))
    state = world.states()[0]
    assert (state["odometry_x"], state["odometry_y"], state["odometry_yaw"]) == pytest.approx((0.5, 0, 0))


def test_localization_origin_moves_the_odometry(make_world, drive):
    world = make_world('rover ( name "a" pose [ 3 4 0 90 ] localization_origin [ 0 0 0 0 ] )')
    drive(world, 1.0, (0.5, 0.0))
    state = world.states()[0]
    assert (state["odometry_x"], state["odometry_y"]) == pytest.approx((3.0, 4.5))
    assert state["odometry_yaw"] == pytest.approx(math.pi / 2)


def test_gps_is_exact_even_when_blocked(make_world, drive):
    world = make_world(WALL_AHEAD + 'rover ( name "a" localization "gps" odom_error [ 0.1 0.1 0 0.1 ] )')
    drive(world, 4.0, (0.5, 0.3))
    state = world.states()[0]
    assert (state["odometry_x"], state["odometry_y"], state["odometry_yaw"]) == world.pose(0)
    assert state["stalled"] == 1


@pytest.mark.parametrize("seed", range(5))
def test_odometry_error_is_one_bias_for_the_whole_run(make_world, drive, seed):
    world = make_world('rover ( name "a" odom_error [ 0.03 0.03 0 0.05 ] )', seed=seed)
    forward, _, turn = world.odometry_bias[0]
    assert abs(forward) <= 0.03 and abs(turn) <= 0.05 and forward != 0.0 and turn != 0.0
    drive(world, 2.0, (0.5, 0.0))
    assert world.states()[0]["odometry_x"] == pytest.approx(1.0 + forward)
    drive(world, 1.0, (0.0, 1.0))
    assert world.states()[0]["odometry_yaw"] == pytest.approx(1.0 + turn)


def test_odometry_bias_fills_its_range(make_world):
    biases = np.array(
        [make_world('rover ( name "a" odom_error [ 0.03 0 0 0.05 ] )', seed=s).odometry_bias[0] for s in range(60)]
    )[:, [0, 2]]
    assert (biases.min(axis=0) < [-0.02, -0.035]).all() and (biases.max(axis=0) > [0.02, 0.035]).all()


def walked(make_world, seed, seconds, command, text='rover ( name "a" odom_error [ 0.03 0.1 0 0.05 ] %s )'):
    """The state after a way under the random walk."""
    world = make_world(text % "", seed=seed, odometry=RANDOM_WALK)
    assert world.odometry_bias == [(0.0, 0.0, 0.0)]
    for _ in range(round(seconds / world.interval)):
        world.command(0, *command)
        world.step()
    return world.states()[0]


@pytest.mark.parametrize("seconds", [2.0, 18.0])
def test_random_walk_grows_with_the_square_root_of_the_way(make_world, seconds):
    ways = [walked(make_world, seed, seconds, (0.5, 0.0)) for seed in range(120)]
    errors = np.array([way["odometry_x"] - way["x"] for way in ways])
    assert errors.std() == pytest.approx(0.03 * math.sqrt(0.5 * seconds), rel=0.2)
    assert abs(errors.mean()) < 0.35 * errors.std()
    assert all(way["odometry_yaw"] == 0.0 for way in ways)


def test_random_walk_of_the_turn(make_world):
    turns = [walked(make_world, seed, 2.0, (0.0, 1.0)) for seed in range(120)]
    errors = np.array([turn["odometry_yaw"] - turn["yaw"] for turn in turns])
    assert errors.std() == pytest.approx(0.05 * math.sqrt(2.0), rel=0.2)


def test_random_walk_aside(make_world):
    text = 'rover ( name "a" drive "omni" velocity_bounds [ -1 1 -1 1 0 0 -90 90 ] odom_error [ 0 0.1 0 0 ] %s )'
    ways = [walked(make_world, seed, 2.0, (0.0, 0.0, 0.5), text) for seed in range(120)]
    errors = np.array([way["odometry_y"] - way["y"] for way in ways])
    assert errors.std() == pytest.approx(0.1, rel=0.2)


def test_random_walk_is_seeded_and_its_steps_are_independent(make_world):
    first, again, other = (walked(make_world, seed, 2.0, (0.5, 0.3)) for seed in (3, 3, 4))
    assert first == again and first["odometry_x"] != other["odometry_x"]
    world = make_world('rover ( name "a" odom_error [ 0.03 0 0 0.05 ] )', odometry=RANDOM_WALK)
    steps = []
    for _ in range(400):
        before = float(world.states()[0]["odometry_x"])
        world.command(0, 0.5, 0.0)
        world.step()
        steps.append(float(world.states()[0]["odometry_x"]) - before)
    assert abs(np.corrcoef(steps[1:-1], steps[2:])[0, 1]) < 0.15
    world.command(0, 0.0, 0.0)
    world.step()
    rest = world.states()[0]["odometry_x"]
    world.step()
    assert world.states()[0]["odometry_x"] == rest, "a robot at rest does not drift"


def test_odometry_model_changes_nothing_else(make_world, drive):
    text = (
        'rover ( name "a" odom_error [ 0.03 0.03 0 0.05 ] ranger ( sensor ( samples 9 noise [ 0.01 0 0 ] ) ) )'
        + WALL_AHEAD
    )
    bias, walk = (make_world(text, seed=2, odometry=model) for model in ODOMETRY_MODELS)
    for world in (bias, walk):
        drive(world, 0.5, (0.3, 0.2))
    assert bias.pose(0) == walk.pose(0)
    assert np.array_equal(bias.core.scan(0, 1), walk.core.scan(0, 1))


def test_random_walk_spares_exact_localization(make_world, drive):
    world = make_world('rover ( name "a" localization "gps" )', odometry=RANDOM_WALK)
    drive(world, 1.0, (0.5, 0.5))
    state = world.states()[0]
    assert (state["odometry_x"], state["odometry_y"], state["odometry_yaw"]) == pytest.approx(world.pose(0))


def test_unknown_odometry_model(make_world):
    with pytest.raises(WorldError, match='must be bias or random_walk, not "gauss"'):
        make_world(ROVER, odometry="gauss")


# --- rangers ---


def scans(world):
    return {(scan.robot, scan.ranger): scan.ranges for scan in world.due_scans()}


def test_scan_comes_at_the_rangers_interval_only(make_world):
    world = make_world(ROVER)
    due = []
    for _ in range(6):
        world.step()
        due.append(len(list(world.due_scans())))
    assert due == [0, 1, 0, 1, 0, 1], "10 Hz in steps of 50 ms, no beam twice"


def test_scan_measures_from_the_mount_counter_clockwise(make_world):
    world = make_world("model ( size [ 6 0.2 1 ] pose [ 0 2.1 0 0 ] )\n" + WALL_AHEAD + ROVER)
    ranges = world.core.scan(0, 0)
    assert ranges.dtype == np.float32 and ranges.shape == (541,)
    assert ranges[270] == pytest.approx(0.9), "ahead: wall face at 1.0, laser at 0.1"
    assert ranges[270 + 180] == pytest.approx(2.0), "left, at +90 degrees"
    assert ranges[270 - 180] == 8.0, "nothing on the right"


def test_noise_is_a_variance_and_spares_the_maximum(make_world):
    world = make_world(
        'model ( size [ 1 1 1 ] pose [ 2.6 0 0 0 ] )\nposition ( name "a" ranger ('
        " sensor ( range [ 0 8 ] fov 360 samples 361 noise [ 0.01 0 0 ] ) ) )"
    )
    ranges = np.array([world.core.scan(0, 0) for _ in range(400)])
    hit = ranges[:, 180]
    assert hit.std() == pytest.approx(0.1, rel=0.1), "0.01 is the variance in m^2"
    assert hit.mean() == pytest.approx(2.1, abs=0.02)
    assert (ranges[:, 0] == 8.0).all()
    assert np.corrcoef(hit, ranges[:, 181])[0, 1] == pytest.approx(0.0, abs=0.15)


def test_noisy_ranges_may_leave_the_limits(make_world):
    world = make_world(
        'model ( size [ 1 1 1 ] pose [ 0.75 0 0 0 ] )\nposition ( name "a" ranger ('
        " sensor ( range [ 0 0.3 ] fov 10 samples 11 noise [ 0.04 0 0 ] ) ) )"
    )
    ranges = np.array([world.core.scan(0, 0) for _ in range(100)])
    assert ranges.min() < 0.0 and ranges.max() > 0.3


def test_robots_see_one_another_but_not_themselves(make_world):
    world = make_world(ROVER + 'rover ( name "b" pose [ 3 0 0 90 ] )')
    seen = world.core.scan(0, 0)
    assert seen[270] == pytest.approx(3.0 - 0.19 - 0.1), "the other one stands across: its side is 0.19 m off"
    assert (seen[:200] == 8.0).all() and (seen[-200:] == 8.0).all()
    width = (seen < 8.0).sum() * math.radians(0.5) * 2.71
    assert width == pytest.approx(0.44, abs=0.05)


def test_robot_behind_is_seen_where_the_field_of_view_wraps(make_world):
    world = make_world(
        'position ( name "a" ranger ( sensor ( range [ 0 8 ] fov 360 samples 361 ) ) )\n'
        'rover ( name "b" pose [ -2 0 0 0 ] )'
    )
    ranges = world.core.scan(0, 0)
    assert ranges[0] == ranges[360] == pytest.approx(2.0 - 0.22)
    assert ranges[4] == pytest.approx(ranges[356], rel=1e-5) and ranges[4] < 8.0


def test_robot_next_to_the_laser_is_seen(make_world):
    world = make_world(ROVER + 'rover ( name "b" pose [ 0.5 0 0 0 ] )')
    assert world.core.scan(0, 0)[270] == pytest.approx(0.5 - 0.22 - 0.1)


def test_things_that_return_no_ranges_are_not_seen_but_block(make_world, drive):
    world = make_world("model ( size [ 0.2 4 1 ] pose [ 1.1 0 0 0 ] ranger_return -1 )\n" + ROVER)
    assert world.core.scan(0, 0)[270] == 8.0
    drive(world, 4.0, (0.5, 0.0))
    assert world.states()[0]["stalled"] == 1


def test_robots_without_ranger_return_are_not_seen(make_world):
    world = make_world(ROVER + 'rover ( name "b" pose [ 2 0 0 0 ] ranger_return -1 )')
    assert (world.core.scan(0, 0) == 8.0).all()


# --- the world as a whole ---


def run(seed, robots=3):
    world = World(load_world(find_world("office26x15")), robots, seed)
    record = []
    for step in range(200):
        for robot in range(robots):
            world.command(robot, 0.4, math.sin(0.1 * step + robot))
        world.step()
        record.append(world.states())
        record.extend(scan.ranges for scan in world.due_scans())
    return record


def test_same_seed_same_bits():
    assert all((a == b).all() for a, b in zip(run(7), run(7), strict=True))
    assert any((a != b).any() for a, b in zip(run(7), run(8), strict=True))


def test_another_robot_does_not_change_the_noise_of_the_others():
    description = load_world(find_world("office26x15"))
    two, three = World(description, 2, 5), World(description, 3, 5)
    assert two.odometry_bias == three.odometry_bias[:2]
    # Seen or not, the third robot must not shift the first one's stream: compare beams that point away from it.
    a, b = two.core.scan(0, 0), three.core.scan(0, 0)
    away = np.isclose(two.core.scan(0, 0), three.core.scan(0, 0), atol=0.5)
    assert away.mean() > 0.8 and np.array_equal(a[away], b[away])


def test_first_robots_take_part_the_others_are_absent(make_world, drive):
    world = make_world(ROVER + 'rover ( name "b" pose [ 1 0 0 0 ] )', robots=1)
    assert world.names == ("a",)
    assert (world.core.scan(0, 0) == 8.0).all()


@pytest.mark.parametrize("count", [0, 2, -1])
def test_too_many_or_no_robots_are_refused(make_world, count):
    with pytest.raises(WorldError, match=f"defines 1 robot; asked for {count}: ask for others with --robots"):
        make_world(ROVER, robots=count)


def test_robot_in_a_wall_or_in_another_is_refused(make_world):
    with pytest.raises(WorldError, match="a starts inside a wall"):
        make_world("model ( size [ 1 1 1 ] pose [ 0.5 0 0 0 ] )\n" + ROVER)
    with pytest.raises(WorldError, match="starts inside another robot"):
        make_world(ROVER + 'rover ( name "b" pose [ 0.3 0 0 0 ] )')


def test_time_is_counted_in_steps(make_world):
    world = make_world(ROVER)
    for _ in range(1000):
        assert world.next_deadline() == pytest.approx(world.time + 0.05)
        world.step()
    assert world.time == pytest.approx(50.0, abs=1e-9)


def test_unknown_robot(make_world):
    with pytest.raises(WorldError, match=r'no robot "x".*there are a'):
        make_world(ROVER).index("x")
