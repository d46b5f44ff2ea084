"""Order of blocking calls on virtual time."""

from typing import List, Tuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from explorer.call_queue import CallQueue

NAMES: List[str] = []


def call(name: str) -> object:
    return lambda: NAMES.append(name)


def started(queue: CallQueue, now: float) -> str:
    """Name of the call that starts now, empty if none does."""
    taken = queue.take(now)
    if taken is None:
        return ""
    NAMES.clear()
    taken[1]()
    return NAMES[0]


def test_a_call_does_not_overtake_the_one_before() -> None:
    """Three threads took calls at once: an auction could reach the radio before the frontiers it refers to."""
    queue = CallQueue(10, handover=0.2)
    for name in ("frontiers", "auction", "claim"):
        queue.put(call(name))
    assert started(queue, 5.0) == "frontiers"
    assert started(queue, 5.0) == "" and queue.pause(5.0) == pytest.approx(0.2)
    queue.ended(1)
    assert started(queue, 5.01) == "auction"
    assert started(queue, 5.1) == ""
    queue.ended(1)
    assert started(queue, 5.1) == "", "the end of an earlier call says nothing"


def test_a_call_that_blocks_holds_the_next_up_only_until_it_is_handed_over() -> None:
    queue = CallQueue(10, handover=0.2)
    for name in ("frontiers", "auction", "claim"):
        queue.put(call(name))
    assert [started(queue, now) for now in (0.0, 0.1, 0.2, 0.3, 0.4)] == ["frontiers", "", "auction", "", "claim"]
    assert queue.pause(9.0) is None


def test_without_a_time_for_handing_over_calls_go_one_by_one() -> None:
    queue = CallQueue(10)
    queue.put(call("first"))
    queue.put(call("second"))
    assert [started(queue, now) for now in (0.0, 1e6)] == ["first", ""] and queue.pause(1e6) is None
    queue.ended(1)
    assert started(queue, 1e6) == "second"


def test_when_it_is_full_the_oldest_is_lost() -> None:
    queue = CallQueue(2)
    assert [queue.put(call(name)) for name in ("first", "second", "third")] == [True, True, False]
    assert started(queue, 0.0) == "second"


@given(st.lists(st.tuples(st.sampled_from(["put", "end", "wait"]), st.integers(1, 8)), max_size=60))
def test_calls_start_in_order_and_apart(steps: List[Tuple[str, int]]) -> None:
    queue, now, given_, ended = CallQueue(1000, handover=0.5), 0.0, 0, set()
    starts: List[Tuple[str, float]] = []
    for step, number in steps:
        if step == "put":
            given_ += 1
            queue.put(call(str(given_)))
        elif step == "end" and number <= len(starts):
            ended.add(number)
            queue.ended(number)
        elif step == "wait":
            now += 0.1 * number
        name = started(queue, now)
        if name:
            assert not starts or len(starts) in ended or now - starts[-1][1] >= 0.5 - 1e-9
            starts.append((name, now))
    assert [name for name, _ in starts] == [str(number + 1) for number in range(len(starts))]
