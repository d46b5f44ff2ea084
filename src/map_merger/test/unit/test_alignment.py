"""When a transform is tried, believed, followed and given up."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from map_merger.alignment import Alignment
from map_merger.attempts import LONGEST_PAUSE_S
from map_merger.evidence import Evidence
from map_merger.job import Versioned
from map_merger.registration import STRONG_CRITERIA, Registration, Verdict
from mr_grid import GridInfo, OccupancyGrid, Pose, empty_grid

HERE = Pose(1.0, 2.0, 0.5)
COVARIANCE = ((0.01, 0.0, 0.0), (0.0, 0.01, 0.0), (0.0, 0.0, 0.001))


def look(matched, transform=HERE, surveyed=100.0, verdict=Verdict.ACCEPTED, **more):
    evidence = Evidence(matched, matched / 3, 0.0, 0.8, 0.02)
    return Registration(verdict, transform, evidence, surveyed, covariance=COVARIANCE, **more)


def with_prior(matched, surveyed=100.0):
    return look(matched, surveyed=surveyed, prior=True)


def believed():
    alignment = Alignment()
    assert alignment.finished(look(STRONG_CRITERIA.matched + 1.0)) == "accepted"
    return alignment


def looks_until_revoked(alignment, verdicts, most=1000):
    for number in range(1, most + 1):
        if alignment.finished(look(20.0, verdict=verdicts[(number - 1) % len(verdicts)])) == "revoked":
            return number
    return None


def test_strong_evidence_is_believed_at_once_with_its_covariance():
    belief = believed().belief
    assert belief.transform == HERE and belief.covariance == COVARIANCE and not belief.met


def test_weak_evidence_with_a_prior_needs_a_second_look_at_grown_maps():
    alignment = Alignment()
    assert alignment.finished(with_prior(18.0)) == "" and alignment.transform is None
    assert alignment.finished(with_prior(18.0)) == "", "the same maps tell nothing new"
    assert alignment.finished(with_prior(20.5)) == "", "too little growth"
    assert alignment.finished(with_prior(21.5)) == "accepted"


def test_growth_elsewhere_without_a_contradiction_confirms_as_well():
    alignment = Alignment()
    alignment.finished(with_prior(21.0, surveyed=60.0))
    assert alignment.finished(with_prior(21.0, surveyed=90.0)) == "accepted"


def test_weak_evidence_without_a_prior_is_believed_only_after_a_meeting():
    alignment = Alignment()
    alignment.finished(look(22.0, surveyed=52.0))
    assert alignment.finished(look(34.0, surveyed=90.0)) == ""
    assert alignment.finished(look(34.0, surveyed=90.0, met=True)) == "accepted"
    assert alignment.belief.met


@pytest.mark.parametrize("between", [Verdict.AMBIGUOUS, Verdict.CONTRADICTED, Verdict.CONTRADICTS_TEAM])
def test_a_candidate_that_meets_doubt_starts_anew(between):
    without, doubted = Alignment(), Alignment()
    for alignment in (without, doubted):
        alignment.finished(with_prior(15.0))
    doubted.finished(look(16.0, verdict=between))
    assert without.finished(with_prior(20.0)) == "accepted"
    assert doubted.finished(with_prior(20.0)) == ""


def test_another_transform_does_not_confirm():
    alignment = Alignment()
    alignment.finished(with_prior(15.0))
    elsewhere = with_prior(20.0)._replace(transform=Pose(5.0, 2.0, 0.5))
    assert alignment.finished(elsewhere) == "" and alignment.transform is None
    assert alignment.finished(elsewhere._replace(evidence=Evidence(25.0, 8.0, 0.0, 0.8, 0.02))) == "accepted"


def test_two_contradictions_revoke_a_young_transform():
    assert looks_until_revoked(believed(), [Verdict.CONTRADICTED]) == 2


def test_an_old_transform_survives_two_contradictions_but_not_three():
    alignment = believed()
    for _ in range(100):
        alignment.finished(look(20.0))
    assert looks_until_revoked(alignment, [Verdict.CONTRADICTED]) == 3


def test_a_transform_that_is_contradicted_on_and_off_is_revoked():
    """Any other verdict in between used to take all strikes back, so it stayed for good."""
    assert looks_until_revoked(believed(), [Verdict.CONTRADICTED, Verdict.ACCEPTED]) <= 6
    assert looks_until_revoked(believed(), [Verdict.CONTRADICTED, Verdict.TOO_LITTLE_SHARED_WALL]) == 3


def test_a_transform_that_stays_unexplained_is_revoked():
    """It used to stay in force for good."""
    alignment = believed()
    assert looks_until_revoked(alignment, [Verdict.UNEXPLAINED]) == 4
    assert alignment.transform is None and "of the walls found" in alignment.reason


@pytest.mark.parametrize(
    "verdict", [Verdict.FAILED, Verdict.TOO_LITTLE_SHARED_WALL, Verdict.ONE_DIRECTION_ONLY, Verdict.NO_CANDIDATE]
)
def test_a_fault_or_too_little_wall_changes_nothing(verdict):
    """A fault between two contradictions used to save the transform."""
    alignment = believed()
    assert looks_until_revoked(alignment, [verdict], 200) is None
    assert alignment.finished(look(20.0, verdict=Verdict.CONTRADICTED)) == ""
    assert looks_until_revoked(alignment, [verdict], 200) is None
    assert alignment.transform == HERE
    assert alignment.finished(look(20.0, verdict=Verdict.CONTRADICTED)) == "revoked"


def test_shared_walls_that_vanish_take_the_transform_with_them():
    """A wrong transform under which the maps do not overlap stayed in force for good."""
    alignment = believed()
    nothing = look(2.0, verdict=Verdict.TOO_LITTLE_SHARED_WALL)
    assert [alignment.finished(nothing) for _ in range(4)] == ["", "", "", "revoked"]


@given(st.lists(st.sampled_from([each for each in Verdict if each is not Verdict.CONTRADICTED]), max_size=60))
def test_more_contradictions_never_help(verdicts):
    doubted, plain = believed(), believed()
    for index, verdict in enumerate(verdicts):
        if index % 3 == 0 and doubted.transform is not None:
            doubted.finished(look(20.0, verdict=Verdict.CONTRADICTED))
        for alignment in (doubted, plain):
            if alignment.transform is not None:
                alignment.finished(look(20.0, verdict=verdict))
    assert doubted.transform is None or plain.transform is not None


def test_a_jump_is_followed_and_starts_with_fresh_credit():
    alignment = believed()
    alignment.finished(look(20.0, verdict=Verdict.CONTRADICTED))
    there = Pose(3.0, 2.0, 0.6)
    assert alignment.finished(look(20.0, there, prior=True)) == "moved"
    assert alignment.transform == there
    assert looks_until_revoked(alignment, [Verdict.CONTRADICTED]) == 2


def test_a_refinement_is_no_news():
    alignment = believed()
    near = Pose(1.05, 2.0, 0.5)
    assert alignment.finished(look(20.0, near)) == "" and alignment.transform == near


def test_what_the_team_refutes_is_revoked_with_its_words_and_searched_again():
    alignment = believed()
    map_ = Versioned("map", square(20))
    alignment.started(0.0, map_, map_, 5.0)
    assert alignment.refuted("contradicts robot_0 - robot_2 - robot_3 by 1.8 m, 4 deg") == "revoked"
    assert alignment.transform is None and alignment.proposed is None
    assert alignment.reason == "contradicts robot_0 - robot_2 - robot_3 by 1.8 m, 4 deg"
    assert alignment.due(0.1, map_, map_)
    assert alignment.refuted("again") == ""


def test_the_refuted_transform_is_not_believed_again_without_more_evidence_but_another_one_is():
    """Else it would come and go for ever: the same maps have the same walls."""
    found, elsewhere = believed(), believed()
    for alignment in (found, elsewhere):
        alignment.refuted("contradicts robot_1 - robot_0 by 3.0 m, 0 deg")
    wall = STRONG_CRITERIA.matched + 1.0
    for _ in range(3):
        assert found.finished(look(1.4 * wall, met=True)) == "" and found.transform is None
    assert found.finished(look(1.6 * wall)) == "accepted"
    assert elsewhere.finished(look(wall, Pose(4.0, 2.0, 0.5))) == "accepted"


def test_a_refuted_meeting_without_walls_is_not_believed_again_at_once():
    alignment = Alignment()
    assert alignment.finished(look(0.0, met=True)) == "accepted"
    alignment.refuted("contradicts robot_1 - robot_0 by 3.0 m, 0 deg")
    assert alignment.finished(look(0.0, met=True)) == ""
    assert alignment.finished(look(6.0, met=True)) == "accepted"


def test_a_robot_with_a_new_frame_starts_with_nothing():
    alignment = believed()
    alignment.refuted("contradicts robot_1 - robot_0 by 3.0 m, 0 deg")
    alignment.forget()
    assert alignment.finished(look(STRONG_CRITERIA.matched + 1.0)) == "accepted"


def square(size):
    return OccupancyGrid(GridInfo(size, size, 0.05), np.zeros((size, size), np.int8))


def tries(alignment, seconds, maps_at, news_at, period=3.0):
    """Times at which a job starts when all of them fail."""
    times = []
    for tenth in range(int(seconds * 10)):
        now = 0.1 * tenth
        map_ = maps_at(now)
        if alignment.due(now, map_, map_, news_at(now)):
            alignment.started(now, map_, map_, period, news_at(now))
            alignment.finished(Registration(Verdict.AMBIGUOUS))
            times.append(now)
    return times


def growing(now):
    size = 100 + int(20.0 * now)
    return Versioned(size, square(size))


def test_pauses_grow_while_tries_are_in_vain():
    times = tries(Alignment(), 100.0, growing, lambda now: 0)
    assert np.diff(times)[0] < 5.0 and np.diff(times)[-1] >= LONGEST_PAUSE_S - 0.2


def test_no_growing_pauses_while_new_sightings_come_in():
    """They used to grow while the robots saw one another."""
    times = tries(Alignment(), 100.0, growing, lambda now: int(now))
    assert np.diff(times).max() <= 3.3


def test_a_new_sighting_is_worth_a_try_though_the_maps_are_the_same():
    same = Versioned("map", square(100))
    assert len(tries(Alignment(), 60.0, lambda now: same, lambda now: 0)) == 1
    times = tries(Alignment(), 60.0, lambda now: same, lambda now: int(now >= 20.0))
    assert len(times) == 2 and times[1] == pytest.approx(20.0)


def test_a_disputed_transform_is_looked_at_again_though_the_maps_are_the_same():
    same, alignment = Versioned("map", square(100)), believed()
    alignment.started(0.0, same, same, 5.0)
    assert not alignment.due(100.0, same, same)
    assert alignment.due(5.0, same, same, disputed=True) and not alignment.due(4.9, same, same, disputed=True)
    alignment.forget()
    alignment.started(100.0, same, same, 5.0)
    assert not alignment.due(200.0, same, same, disputed=True), "there is nothing to dispute"


def test_robots_that_see_something_move_are_searched_at_once_until_they_are_placed():
    same, alignment = Versioned("map", square(100)), Alignment()
    alignment.started(0.0, same, same, 5.0)
    assert not alignment.due(100.0, same, same)
    assert alignment.due(5.0, same, same, in_sight=True) and not alignment.due(4.9, same, same, in_sight=True)
    placed = believed()
    placed.started(0.0, same, same, 5.0)
    assert not placed.due(5.0, same, same, in_sight=True)


def test_only_what_the_walls_do_not_contradict_is_suggested():
    alignment = Alignment()
    alignment.finished(look(5.0, verdict=Verdict.TOO_LITTLE_SHARED_WALL))
    assert alignment.suggested == HERE
    alignment.finished(Registration(Verdict.CONTRADICTED, HERE, Evidence(30.0, 10.0, 0.1, 0.8, 0.02)))
    assert alignment.suggested is None


def test_walls_that_leave_rivals_wait_for_a_meeting():
    alignment = Alignment()
    assert not alignment.awaits_meeting
    alignment.finished(Registration(Verdict.AMBIGUOUS))
    assert alignment.awaits_meeting
    alignment.finished(look(STRONG_CRITERIA.matched + 1.0))
    assert not alignment.awaits_meeting


def test_a_clock_that_jumps_back_does_not_stop_the_tries():
    alignment = Alignment()
    alignment.started(600.0, growing(0.0), growing(0.0), 3.0)
    assert alignment.started_before(600.0) == 600.0 and alignment.started_before(5.0) == -math.inf
    assert alignment.due(5.0, growing(20.0), growing(20.0))


def test_nothing_known_is_not_worth_a_try():
    nothing = Versioned("nothing", empty_grid(GridInfo(30, 30, 0.05)))
    assert not Alignment().due(0.0, nothing, nothing)
