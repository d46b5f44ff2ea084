"""The time of what is dated by another clock."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from map_merger.timer import LONGEST_AGE_S, time_of

TIMES = st.floats(-1e6, 2e9)


@pytest.mark.parametrize(
    "stamp, found", [(99.8, 99.8), (100.0, 100.0), (100.3, 100.0), (1.7e9, 100.0), (0.0, 100.0 - LONGEST_AGE_S)]
)
def test_the_stamp_counts_unless_it_cannot_be(stamp, found):
    assert time_of(stamp, 100.0) == found


@given(TIMES, st.floats(0.0, 10.0), TIMES, st.floats(0.0, 10.0))
def test_what_was_measured_later_is_never_dated_earlier(stamp, later, now, passed):
    assert now - LONGEST_AGE_S <= time_of(stamp, now) <= now
    assert time_of(stamp, now) <= time_of(stamp + later, now + passed)
