"""Who waits for a round of a loop."""

import threading

from mr_grid.rounds import Rounds


def test_a_round_that_was_under_way_does_not_count():
    rounds, hurried, waited = Rounds(), threading.Event(), threading.Event()

    def wait():
        rounds.wait_for_whole_one(hurried.set)
        waited.set()

    with rounds.next_one():
        waiting = threading.Thread(target=wait, daemon=True)
        waiting.start()
        assert hurried.wait(10.0)
    assert not waited.is_set()
    with rounds.next_one():
        assert not waited.is_set()
    assert waited.wait(10.0)


def test_a_round_that_failed_has_ended():
    rounds, hurried = Rounds(), threading.Event()
    waiting = threading.Thread(target=rounds.wait_for_whole_one, args=[hurried.set], daemon=True)
    waiting.start()
    assert hurried.wait(10.0)
    try:
        with rounds.next_one():
            raise ValueError
    except ValueError:
        pass
    waiting.join(10.0)
    assert not waiting.is_alive()
