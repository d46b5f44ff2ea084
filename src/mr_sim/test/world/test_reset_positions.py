"""All robots back to their start poses, as `reset_positions` of stageros has it."""

import numpy as np
import pytest

ROVER = 'rover ( name "a" pose [ 0 0 0 0 ] )\n'


def test_robots_drive_on_from_their_starts_and_odometry_goes_on(make_world, drive):
    world = make_world('rover ( name "a" pose [ 1 0 0 90 ] )\nrover ( name "b" pose [ 3 0 0 0 ] )')
    drive(world, 1.0, (0.4, 0.3), (0.2, 0.0))
    odometry = world.states()[["odometry_x", "odometry_y", "odometry_yaw"]].copy()
    world.reset_positions()
    assert [tuple(world.pose(robot)) for robot in (0, 1)] == [robot.start for robot in world.robots]
    assert not np.array([world.states()[name] for name in ("velocity_x", "velocity_y", "velocity_yaw")]).any()
    assert (world.states()[["odometry_x", "odometry_y", "odometry_yaw"]] == odometry).all()
    world.step()
    assert world.pose(0)[1] == pytest.approx(0.4 * 0.05), "its command goes on"
    assert world.states()[1]["odometry_x"] == pytest.approx(0.2 * 1.05)


def test_exact_odometry_goes_back_with_the_robot(make_world):
    world = make_world('position ( name "a" pose [ 2 1 0 90 ] localization "gps" )')
    for _ in range(10):
        world.command(0, 0.5, 0.3)
        world.step()
    world.command(0, 0.0, 0.0)
    world.step()
    world.step()
    world.reset_positions()
    world.step()
    state = world.states()[0]
    assert (state["odometry_x"], state["odometry_y"], state["odometry_yaw"]) == (0.0, 0.0, 0.0)


def test_a_robot_that_was_stuck_is_free(make_world, drive):
    world = make_world("model ( size [ 0.2 4 1 ] pose [ 1.1 0 0 0 ] )\n" + ROVER)
    drive(world, 4.0, (0.5, 0.0))
    assert world.states()[0]["stalled"] == 1
    world.reset_positions()
    assert world.states()[0]["stalled"] == world.states()[0]["contact"] == 0
    drive(world, 0.5, (0.5, 0.0))
    assert world.pose(0)[0] == pytest.approx(0.25)


def test_robots_that_have_changed_places_do_not_block_each_other(make_world, drive):
    world = make_world(ROVER + 'rover ( name "b" pose [ 0 1 0 0 ] )\nrover ( name "c" pose [ 2 0 0 180 ] )')
    drive(world, 2.0, (0.5, 0.0), (0.5, 0.0), (0.0, 0.0))
    drive(world, 2.0, (0.0, 0.0), (0.0, 0.0), (0.5, 0.0))
    world.reset_positions()
    drive(world, 1.0, (0.5, 0.0), (0.5, 0.0), (0.0, 0.0))
    assert [world.pose(robot)[0] for robot in range(3)] == pytest.approx([0.5, 0.5, 2.0])
    assert world.core.scan(2, 0)[270] == pytest.approx(2.0 - 0.5 - 0.1 - 0.22, abs=1e-5), "seen where it stands"


def test_robots_block_where_they_stand_again(make_world, drive):
    world = make_world(ROVER + 'rover ( name "b" pose [ 1 0 0 0 ] )')
    drive(world, 2.0, (0.0, 0.0), (0.5, 0.0))
    world.reset_positions()
    drive(world, 3.0, (0.5, 0.0), (0.0, 0.0))
    assert world.pose(0)[0] == pytest.approx(1.0 - 0.44, abs=0.03) and world.states()[0]["stalled"] == 1


def test_noise_and_errors_are_those_without_a_reset(make_world):
    def noise(reset):
        world = make_world(
            'model ( size [ 1 1 1 ] pose [ 2.6 0 0 0 ] )\nposition ( name "a" ranger ('
            " sensor ( range [ 0 8 ] fov 10 samples 11 noise [ 0.01 0 0 ] ) ) )"
        )
        world.core.scan(0, 0)
        if reset:
            world.reset_positions()
        return world.core.scan(0, 0)

    assert np.array_equal(noise(False), noise(True))
