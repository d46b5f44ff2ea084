"""What robots knew over time, and what of their beliefs is told."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mr_grid import OccupancyGrid, Pose
from mr_measures.knowledge import PERIOD, Knowledge, overlap_of, team_series
from mr_measures.record.beliefs import Beliefs
from mr_measures.truth import CELL_AREA, KnowableArea, Truth

moments = st.lists(st.floats(0.0, 60.0) | st.just(np.inf), min_size=6, max_size=6).map(np.array)


def test_a_cell_is_known_since_the_first_map_that_knows_it():
    walls = OccupancyGrid.of(np.zeros((2, 4), np.int8), 0.05)
    truth = Truth(walls, (), (), 0.0, lambda *_: np.empty(0), KnowableArea(np.empty((0, 2)), walls.cells == 0))
    knowledge = Knowledge(truth, Pose(0.1, 0.0))
    one = OccupancyGrid.of(np.array([[0], [-1]], np.int8), 0.05, Pose(-0.1, 0.0))
    knowledge.look(one, 3.0)
    knowledge.look(OccupancyGrid.of(np.zeros((1, 4), np.int8), 0.05, Pose(-0.1, 0.0)), 7.0)
    assert knowledge.since.tolist() == [3.0, 7.0, 7.0, 7.0, np.inf, np.inf, np.inf, np.inf]


def test_a_team_knows_what_one_of_it_knows():
    since = [np.array([10.0, 14.0, np.inf, np.inf]), np.array([12.0, 11.0, 20.0, np.inf])]
    series = team_series(since, 10.0, 22.0)
    assert series.time == (0.0, 5.0, 10.0, 12.0)
    assert series.coverage == (0.25, 0.5, 0.75, 0.75)
    assert series.explored == pytest.approx([share * 4 * CELL_AREA for share in series.coverage], abs=1e-3)
    assert overlap_of(since, 22.0) == pytest.approx(5 / 3 - 1, abs=1e-5)
    assert overlap_of(since, 11.0) == 0.0


@given(moments, moments)
def test_knowledge_never_falls_and_a_team_knows_more_than_one(first, second):
    alone, both = team_series([first], 0.0, 41.0), team_series([first, second], 0.0, 41.0)
    assert alone.time == both.time and alone.time[-1] == 41.0 and alone.time[1] == PERIOD
    assert list(both.coverage) == sorted(both.coverage)
    assert all(more >= less for more, less in zip(both.coverage, alone.coverage, strict=True))


def test_only_what_has_changed_is_told():
    beliefs, place = Beliefs(), Pose(1.0, 2.0, 3.14)
    assert beliefs.changes({"b": place}) == [("b", place)]
    assert beliefs.changes({"b": Pose(1.03, 2.0, -3.14)}) == []
    far = Pose(1.06, 2.0, 3.14)
    assert beliefs.changes({"b": far, "c": place}) == [("b", far), ("c", place)]
    assert beliefs.changes({"d": place}) == [("b", None), ("c", None), ("d", place)]
    assert beliefs.changes({"d": Pose(1.0, 2.0, 3.12)}) == [("d", Pose(1.0, 2.0, 3.12))]
