"""The floor plan that the radio gets: the walls are where they are in the world, and the real daemon heeds them."""

import contextlib
import socket
import subprocess

import cv2
import pytest

from mr_launch import isolation
from mr_launch.arguments import parse_arguments
from mr_launch.plan import RADIO_CONTROL, Plan, radio_command
from mr_launch.programs import find_executable
from mr_launch.world import find_world, write_walls
from mr_sim.raster import rasterise
from mr_sim.world_model import load_world

WAIT_S = 20.0
IN_THE_ROOM, IN_SIGHT, BEHIND_A_WALL = (3.5, 9.0), (3.5, 11.5), (3.5, 6.5)
"""In office26x15, m. 4 m of reach are 2.2 m behind a wall of 10 dB."""


@pytest.mark.parametrize("name", ["office26x15", "small8x8"])
def test_the_image_shows_the_walls_of_the_world(tmp_path, name):
    world = find_world(name)
    walls = write_walls(world, str(tmp_path / "walls.pgm"))
    pixels = cv2.imread(walls.file, cv2.IMREAD_UNCHANGED)
    description = load_world(world)
    raster = rasterise(description.obstacles, description.resolution)
    assert ((pixels[::-1] == 0) == (raster.cells == 1)).all()
    assert 0 < (pixels == 0).mean() < 0.3
    assert (walls.resolution, walls.origin) == (raster.resolution, raster.origin)


@contextlib.contextmanager
def running_radio(folder, *arguments):
    """The radio daemon of a mission in office26x15, as a hub."""
    radio = find_executable("adhoc_communication", "radio")
    if radio is None:
        pytest.skip("the radio daemon is not built")
    options = parse_arguments(["--out", str(folder), "--range", "4", "--loss", "0", *arguments])
    plan = Plan(options, find_world("office26x15"), [], str(folder), isolation.HUB, {"radio": radio}, str(folder))
    walls = write_walls(plan.world, plan.socket("walls.pgm"))
    command = radio_command(plan, walls if options.wall_attenuation else None)
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout.readline().startswith("radio ready")
            yield plan
        finally:
            process.terminate()
            assert process.wait(WAIT_S) == 0


def connected(path):
    client = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    client.settimeout(WAIT_S)
    client.connect(path)
    return client


def frame(number):
    """A frame to all with a number in it."""
    return bytes([255] * 6 + [2, 0, 0, 0, 0, 1, 0x88, 0xB5]) + bytes([number] * 50)


@pytest.mark.parametrize(("arguments", "first_heard"), [((), 1), (("--wall-attenuation", "10"), 2)])
def test_who_is_behind_a_wall_is_heard_unless_walls_weaken_the_radio(tmp_path, arguments, first_heard):
    """Frame 1 is sent while bob is behind a wall and carol in sight, frame 2 when bob is in sight, too."""
    with running_radio(tmp_path, *arguments) as plan, contextlib.ExitStack() as stack:
        alice, bob, carol = (stack.enter_context(connected(plan.socket("hub"))) for _ in range(3))
        control = stack.enter_context(connected(plan.socket(RADIO_CONTROL)))

        def place(**positions):
            lines = [f"position {name} {x} {y}" for name, (x, y) in positions.items()]
            control.send("\n".join([*lines, "statistics", ""]).encode())
            control.recv(65536)  # so they are known to have been carried out

        for client, name in ((alice, b"alice"), (bob, b"bob"), (carol, b"carol")):
            client.send(name)
        place(alice=IN_THE_ROOM, bob=BEHIND_A_WALL, carol=IN_SIGHT)
        alice.send(frame(1))
        assert carol.recv(4096)[-1] == 1
        place(bob=IN_SIGHT)
        alice.send(frame(2))
        assert bob.recv(4096)[-1] == first_heard
