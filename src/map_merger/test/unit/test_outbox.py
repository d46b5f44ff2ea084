"""Effects of several threads come out in the order in which they were put."""

import threading

import numpy as np
import pytest

from map_merger.effects import Note, PublishMap, Purpose, Register, Send
from map_merger.grid import Box
from map_merger.outbox import Outbox
from mr_grid import GridInfo, OccupancyGrid


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


def send(number):
    return Send(number, Purpose.ANSWER, "robot_1", ())


def published(size, *edges):
    return PublishMap(OccupancyGrid(GridInfo(size, size, 0.05), np.zeros((size, size), np.int8)), Box(*edges), (1, 2))


def test_a_full_outbox_drops_old_notes_and_hands_back_sends():
    """It grew without bound while an effect was being carried out."""
    done = []
    outbox = Outbox(done.append, most=3)
    notes = [Note(str(number)) for number in range(5)]
    assert outbox.put(notes) == []
    sends = [send(number) for number in range(4)]
    job = Register(None, 0)
    assert outbox.put([*sends, job, Note("no room")]) == sends[3:]
    outbox.work()
    assert done == [*sends[:3], job]
    done.clear()
    assert outbox.put(notes) == []
    outbox.work()
    assert done == notes[2:], "the newest stay"


def test_of_maps_the_newest_waits_with_all_that_changed():
    done = []
    outbox = Outbox(done.append, most=2)
    outbox.put([published(8, 0, 0, 1, 1), Note("between"), published(8, 2, 2, 4, 5)])
    newest = published(8, 6, 6, 7, 7)
    outbox.put([newest])
    outbox.work()
    assert done[0] == Note("between") and len(done) == 2
    assert done[1].grid is newest.grid and done[1].changed == Box(0, 0, 7, 7)
    done.clear()
    outbox.put([published(8, 0, 0, 1, 1), published(9, 2, 2, 3, 3)])
    outbox.work()
    assert [each.changed for each in done] == [Box(0, 0, 9, 9)], "of another size all of it is new"
