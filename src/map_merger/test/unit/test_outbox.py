"""Effects of several threads come out in the order in which they were put."""

import threading

import pytest

from map_merger.effects import Note
from map_merger.outbox import Outbox


def test_an_older_map_is_never_published_last():
    """A thread that was held up between the agent and the publisher left the older map on the latched topic."""
    begun, go_on, done = threading.Event(), threading.Event(), []

    def publish(note):
        if note.text == "old":
            begun.set()
            assert go_on.wait(10.0)
        done.append(note.text)

    outbox = Outbox(publish)
    outbox.put([Note("old")])
    slow = threading.Thread(target=outbox.work)
    slow.start()
    assert begun.wait(10.0)
    outbox.put([Note("new")])
    outbox.work()
    assert done == [], "the second thread neither overtakes nor waits"
    go_on.set()
    slow.join(10.0)
    assert done == ["old", "new"]


def test_what_is_put_while_carrying_out_comes_next():
    done = []

    def carry_out(note):
        done.append(note.text)
        if note.text == "first":
            outbox.put([Note("third")])
            outbox.work()

    outbox = Outbox(carry_out)
    outbox.put([Note("first"), Note("second")])
    outbox.work()
    assert done == ["first", "second", "third"]


def test_a_failure_loses_only_the_effect_that_failed():
    done = []

    def carry_out(note):
        if note.text == "bad":
            raise ValueError(note.text)
        done.append(note.text)

    outbox = Outbox(carry_out)
    outbox.put([Note("bad"), Note("good")])
    with pytest.raises(ValueError):
        outbox.work()
    outbox.work()
    assert done == ["good"]
