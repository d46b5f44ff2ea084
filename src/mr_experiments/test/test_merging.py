"""The host of the map merger in virtual time: what waits for what, and what a message keeps."""

import numpy as np
import pytest

from map_merger import ros_io
from map_merger.messages import Tile
from map_merger.options import options_of
from mr_experiments.common.stopwatch import Stopwatch
from mr_experiments.host.agenda import Agenda
from mr_experiments.host.merging import Merger
from mr_experiments.host.robot_radio import RobotRadio
from mr_grid import OccupancyGrid


class SlowRadio:
    """Sends end when the test says so."""

    def __init__(self):
        self.calls = []

    def send(self, robot, service, destination, topic, message, done):
        self.calls.append((service, destination, done))

    def services(self):
        return [service for service, _, _ in self.calls]


class Silent:
    """Wants nothing that the merger publishes."""

    def __getattr__(self, name):
        return lambda *_: None


@pytest.fixture
def host():
    """A merger, its radio, and a function that lets time go by."""
    radio, agenda, clock = SlowRadio(), Agenda(), [0.0]
    stopwatch = Stopwatch()
    options = options_of({"exchange_position": True, "split_size": 20, "debug": False}, "robot_0")
    merger = Merger(options, (1, 0), agenda, RobotRadio(radio, stopwatch), stopwatch, Silent(), lambda: clock[0])
    merger.start(0.0)

    def until(time):
        while agenda.next_time <= time:
            clock[0] = agenda.next_time
            agenda.run_due(clock[0])

    return merger, radio, until


def test_positions_do_not_wait_behind_a_map(host):
    """Both were in one queue of group sends, so that a position waited for the slowest member to have the map."""
    merger, radio, until = host
    merger.on_local_map(OccupancyGrid.of(np.zeros((20, 80), np.int8), 0.05))
    merger.on_pose(1.0, 2.0, 0.5)
    until(3.0)
    assert radio.services()[:2] == ["send_map", "send_position"], "the anchor, before the map, is still under way"


def test_a_tile_that_is_not_delivered_does_not_end_the_group_send(host):
    merger, radio, until = host
    merger.on_local_map(OccupancyGrid.of(np.zeros((20, 80), np.int8), 0.05))
    until(0.1)
    delivered = iter([True, True, False, True, True])
    for index in range(5):
        radio.calls[index][2](next(delivered), "nobody there")
    assert radio.services() == ["send_map"] + 4 * ["send_map_update"]
    until(2.5)
    assert radio.services() == ["send_map"] + 5 * ["send_map_update"], "one tile again"


@pytest.mark.parametrize("whole", [False, True])
def test_a_message_says_whether_a_tile_is_whole(whole):
    tile = Tile("robot_0", (3,), -4, 7, np.array([[0, -1]], np.int8), 0.05, (1, 2), 4, whole)
    copy = ros_io.tile_of(ros_io.tile_message(tile))
    assert copy.whole is whole and copy.box == tile.box and copy.cells.tolist() == tile.cells.tolist()
    assert (copy.numbers, copy.boot, copy.updates) == ((3,), (1, 2), 4)
