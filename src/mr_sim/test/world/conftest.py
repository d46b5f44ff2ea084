"""Small worlds for the tests of the world engine."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, settings

from mr_sim.world import World
from mr_sim.world_model import load_world

# The same examples in every run; a fixture that writes a file is as good for the second example as for the first.
settings.register_profile(
    "repeatable", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
settings.load_profile("repeatable")

ROBOT = """
define rover position
(
  drive "diff" size [ 0.44 0.38 0.25 ] update_interval 50
  velocity_bounds [ -0.5 0.5 0 0 0 0 -90 90 ]
  localization "odom" odom_error [ 0 0 0 0 ]
  ranger ( update_interval 100 pose [ 0.1 0 0 0 ] sensor ( range [ 0 8 ] fov 270 samples 541 ) )
)
"""
HEAD = "resolution 0.02 interval_sim 50\n"


@pytest.fixture
def write_world(tmp_path: Path) -> Callable[..., Path]:
    """Writes world text (and further files) and returns the path of the world file."""

    def write(text: str, **files: str) -> Path:
        for name, content in files.items():
            (tmp_path / name.replace("_inc", ".inc")).write_text(content)
        path = tmp_path / "test.world"
        path.write_text(text)
        return path

    return write


@pytest.fixture
def make_world(write_world: Callable[..., Path]) -> Callable[..., World]:
    """World with the test's rover defined; keyword arguments go to `World`."""

    def make(text: str, head: str = HEAD, **options: object) -> World:
        return World(load_world(write_world(head + ROBOT + text)), **options)

    return make


@pytest.fixture
def image(tmp_path: Path) -> Callable[..., Path]:
    """Writes a grey image whose row 0 is at the bottom and returns its path."""

    def write(name: str, pixels: np.ndarray) -> Path:
        cv2.imwrite(str(tmp_path / name), np.flipud(pixels))
        return tmp_path / name

    return write


@pytest.fixture
def drive() -> Callable[..., None]:
    """Advances a world with the same command for each robot, renewed at every step."""

    def advance(world: World, seconds: float, *commands: tuple) -> None:
        for _ in range(round(seconds / world.interval)):
            for robot, (linear, angular) in enumerate(commands):
                world.command(robot, linear, angular)
            world.step()

    return advance
