"""Programs that a team has started."""

import os
import time

import pytest

from mr_launch.processes import Children


@pytest.fixture
def children(tmp_path):
    started = Children()
    yield lambda name, *command: (started.start(name, command, tmp_path / name, os.environ, may_finish=True), started)[
        1
    ]
    started.stop_all(0.0)


def test_the_reference_is_waited_for_beyond_the_end_of_a_mission(children):
    """On a busy machine the mission was over before, and its maps were not measured."""
    children("world", "sleep", "60")
    started = children("reference", "sleep", "0.3")
    assert started.wait("reference", 20.0, lambda: False) and not started.running("reference")
    assert started.running("world")


def test_who_asks_to_stop_does_not_wait(children):
    begin = time.monotonic()
    assert not children("reference", "sleep", "60").wait("reference", 60.0, lambda: True)
    assert time.monotonic() - begin < 30.0


def test_patience_ends(children):
    assert not children("reference", "sleep", "60").wait("reference", 0.1, lambda: False)
