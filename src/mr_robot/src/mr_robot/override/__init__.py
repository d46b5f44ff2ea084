"""A person drives the robot: velocities that go before those of navigation."""
