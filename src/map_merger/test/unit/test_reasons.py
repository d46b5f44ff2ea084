"""Verdicts in words: each with the figure that decided and its bound."""

import math

import pytest

from map_merger.confidence import confidence_of, place_of_two_maps
from map_merger.evidence import Evidence
from map_merger.one_shot import confidence_in
from map_merger.reasons import reason_of, waiting_reason
from map_merger.registration import DEFAULT_CRITERIA, Registration, Rival, Verdict, judge
from mr_grid import Pose

GOOD = {"matched": 30.0, "minor": 9.0, "conflict": 0.01, "explained": 0.9, "error": 0.02, "against": 0.3}


@pytest.mark.parametrize(
    "changes, text",
    [
        ({}, "shared wall 30.0 m"),
        ({"matched": 7.2}, "shared wall 7.2 m of 14 m"),
        ({"minor": 2.5}, "shared wall in the weaker direction 2.5 m of 4 m"),
        (
            {"conflict": 0.081, "against": 2.4},
            "2.4 m of wall in free space of the other map: 8.1 % of the walls, at most 6 %",
        ),
        ({"explained": 0.42}, "42 % of the walls found in the other map of 50 %"),
    ],
)
def test_what_decided_is_told_with_its_bound(changes, text):
    evidence = Evidence(**{**GOOD, **changes})
    result = Registration(judge(evidence, DEFAULT_CRITERIA), Pose(), evidence)
    assert reason_of(result, DEFAULT_CRITERIA) == text


def test_two_solutions_are_told_with_their_distance():
    rival = Rival(Pose(2.1, 0.0, 3.0), Evidence(**{**GOOD, "matched": 27.0}), 2.1)
    result = Registration(Verdict.AMBIGUOUS, Pose(), Evidence(**GOOD), rival=rival)
    text = "two solutions 2.1 m and 172 deg apart, with 30.0 m and 27.0 m of shared wall"
    assert reason_of(result, DEFAULT_CRITERIA) == text


@pytest.mark.parametrize("verdict", list(Verdict))
def test_every_verdict_has_words(verdict):
    assert reason_of(Registration(verdict), DEFAULT_CRITERIA)
    assert reason_of(Registration(verdict, Pose(), Evidence(**GOOD)), DEFAULT_CRITERIA)


def test_a_robot_that_waits_says_for_what():
    found = Registration(Verdict.ACCEPTED, Pose(), Evidence(**GOOD))
    thin = found._replace(evidence=Evidence(**{**GOOD, "matched": 50.0}))
    told = {
        "shared wall in the weaker direction 9.0 m of 10 m; waits to see robot_2 move": (thin, ""),
        "no map to compare yet": (None, ""),
        "no map to compare yet; seen for 2 s of 4 s": (None, "seen for 2 s of 4 s"),
        "shared wall 30.0 m of 40 m; waits to see robot_2 move": (found, ""),
        "shared wall 30.0 m of 40 m; seen for 2 s of 4 s": (found, "seen for 2 s of 4 s"),
        "shared wall 30.0 m at the given pose; waits until more is shared": (found._replace(prior=True), ""),
    }
    for text, (result, sightings) in told.items():
        assert waiting_reason("robot_2", result, DEFAULT_CRITERIA, sightings) == text


def test_confidence_falls_with_less_wall_more_contradiction_and_a_closer_rival():
    def confidence(rival=0.0, **changes):
        evidence = Evidence(**{**GOOD, **changes})
        other = Rival(Pose(2.0, 0.0, 0.0), Evidence(**{**GOOD, "matched": rival * GOOD["matched"]}), 2.0)
        return place_of_two_maps(Registration(Verdict.ACCEPTED, Pose(), evidence, rival=other))

    assert 0.0 < confidence(matched=14.0) < confidence() < confidence(matched=60.0) < 1.0
    assert confidence(conflict=0.05) < confidence(conflict=0.01)
    assert confidence(rival=0.7) < confidence(rival=0.5) < confidence(rival=0.2) == confidence()
    assert confidence_in(Registration(Verdict.AMBIGUOUS, Pose(), Evidence(**GOOD))) == 0.0


def test_confidence_is_one_thing_for_robots_and_for_two_maps():
    """They were two formulas: one forgot how exact a transform is, the other took a turn for a shift of the origin."""

    def along(deviation):
        return ((deviation**2, 0.0, 0.0), (0.0, 0.04**2, 0.0), (0.0, 0.0, 1e-4))

    found = Registration(Verdict.ACCEPTED, Pose(), Evidence(**GOOD))
    for deviation in (0.04, 0.2, 2.0):
        believed = confidence_of(along(deviation))
        assert confidence_in(found._replace(covariance=along(deviation))) == place_of_two_maps(found) * believed
    assert confidence_of(along(0.04)) > 0.99 > 0.6 > confidence_of(along(0.2)) > 0.1 > confidence_of(along(2.0))
    arm, turn = 30.0, math.radians(0.5) ** 2
    far = ((0.0016, 0.0, 0.0), (0.0, 0.0016 + arm**2 * turn, arm * turn), (0.0, arm * turn, turn))
    assert confidence_of(far) > 0.99, "where the walls are, it is exact, however far the origin is"
