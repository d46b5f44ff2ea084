"""Two maps alone: what is believed, what is sure, and what the README says of it."""

import os
from dataclasses import replace

import numpy as np
import pytest

from map_merger.confidence import place_of_two_maps
from map_merger.evidence import Evidence
from map_merger.one_shot import (
    ONCE_PRIOR_RULE,
    ONCE_RULE,
    SURE_CRITERIA,
    SURE_LOOKALIKE,
    decide,
    doubt_of,
    sure,
)
from map_merger.registration import Prior, Registration, Verdict, verdict_of
from map_merger.surface import landmarks_of
from map_merger.synthetic import Survey, Surveyor, generated, office_plan, pair_of
from map_merger.transform import displacement
from mr_grid import GridInfo, OccupancyGrid, Pose


@pytest.fixture(scope="module")
def overlapping():
    """Two maps that share much, and the truth."""
    random = np.random.default_rng(5)
    surveyor = Surveyor(office_plan(random))
    survey = Survey(path_length=25.0)
    target = surveyor.explore(random, survey)
    return pair_of(target, surveyor.explore(random, survey, start=tuple(target.path[0, :2]), yaw=2.4))


def test_two_maps_alone_need_less_wall_where_nothing_rivals():
    random = np.random.default_rng(9)
    surveyor = Surveyor(office_plan(random))
    first = surveyor.explore(random, Survey(path_length=2.0), start=(2.0, 2.4))
    pair = pair_of(first, surveyor.explore(random, Survey(path_length=2.0), start=(2.6, 3.0)))
    target, source = landmarks_of(pair.target.grid), landmarks_of(pair.source.grid)
    once = decide(target, source)
    assert 7.0 <= once.evidence.matched < 20.0
    assert once.accepted, once
    assert displacement(pair.truth, once.transform, source.surface.points).max() < 0.1


def test_a_longer_fit_by_chance_makes_a_shorter_one_doubtful():
    """In a maze of corridors 8 m without a contradiction were believed beside 16 m with some; both were wrong."""
    short, long = Evidence(8.0, 3.2, 0.024, 0.56, 0.02, 0.2), Evidence(15.7, 6.7, 0.163, 0.73, 0.02, 3.1)
    assert verdict_of(short, [], ONCE_RULE) is Verdict.ACCEPTED
    assert verdict_of(short, [long], ONCE_RULE) is Verdict.AMBIGUOUS


def test_walls_with_contradictions_are_believed_alone_only_if_nothing_else_fits():
    """Two unlike rooms agreed in 15 m of wall; one wall in twenty stood in free space."""
    unlike, longer = Evidence(14.7, 7.0, 0.053, 0.55, 0.02, 0.8), Evidence(28.5, 12.3, 0.187, 0.62, 0.02, 6.5)
    assert verdict_of(unlike, [longer], ONCE_RULE) is not Verdict.ACCEPTED
    pillars = Evidence(16.0, 7.8, 0.149, 0.53, 0.02, 2.8)
    assert verdict_of(pillars, [], ONCE_RULE) is not Verdict.ACCEPTED, "the lattices of two halls"
    moved = Evidence(30.0, 9.0, 0.09, 0.6, 0.02, 3.3)
    assert verdict_of(moved, [], ONCE_RULE) is Verdict.ACCEPTED, "people move things"
    assert verdict_of(moved, [replace(moved, matched=7.0, conflict=0.0)], ONCE_RULE) is Verdict.AMBIGUOUS


def test_the_rival_of_a_square_room_is_as_good():
    cells = np.zeros((200, 200), np.int8)
    cells[[0, -1]] = 100
    cells[:, [0, -1]] = 100
    square = landmarks_of(OccupancyGrid(GridInfo(200, 200, 0.05), cells))
    once = decide(square, square)
    assert once.verdict is Verdict.AMBIGUOUS
    assert once.rival.evidence.score > 0.95 * once.evidence.score


def test_a_copy_beyond_the_bounds_of_the_prior_is_declined(overlapping):
    """It was accepted up to 4.1 m from a prior of 3 m: in the next room of a row of equal ones."""
    target, source = landmarks_of(overlapping.target.grid), landmarks_of(overlapping.source.grid)
    for distance, accepted in ((2.5, True), (3.8, False)):
        prior = Prior(Pose(distance, 0.0, 0.0).compose(overlapping.truth), 3.0)
        assert decide(target, source, prior).accepted == accepted


def test_furniture_that_was_moved_does_not_hide_where_a_prior_leads():
    """5 m of wall with an eighth in free space, and nothing else near the prior that fits, were declined."""
    moved = Evidence(5.2, 0.38, 0.132, 0.48, 0.02, 0.8)
    assert verdict_of(moved, [], ONCE_PRIOR_RULE) is Verdict.ACCEPTED
    assert verdict_of(moved, [replace(moved, conflict=0.0)], ONCE_PRIOR_RULE) is not Verdict.ACCEPTED
    assert place_of_two_maps(Registration(Verdict.ACCEPTED, Pose(), moved, prior=True)) > 0.0
    assert verdict_of(moved, [], ONCE_RULE) is not Verdict.ACCEPTED


STRONG = Registration(Verdict.ACCEPTED, Pose(), Evidence(SURE_CRITERIA.matched + 1.0, 9.0, 0.0, 0.8, 0.02))


@pytest.mark.parametrize(
    "change, words",
    [
        ({"evidence": replace(STRONG.evidence, matched=20.0)}, "20.0 m of 28 m"),
        ({"evidence": replace(STRONG.evidence, conflict=0.05, against=1.5)}, "1.5 m of wall in free space"),
        ({"lookalike": 0.7}, "70 % of the shared wall fits elsewhere"),
        ({"prior": True}, "prior"),
    ],
)
def test_what_may_be_a_copy_is_not_sure(change, words):
    assert sure(STRONG) and not doubt_of(STRONG)
    assert not sure(STRONG._replace(**change)) and words in doubt_of(STRONG._replace(**change))
    assert not sure(STRONG._replace(verdict=Verdict.AMBIGUOUS))


def test_the_halves_of_a_symmetric_building_are_never_sure():
    """Two robots at places that are images of one another: 27 m without a contradiction are believed, and wrong."""
    random = np.random.default_rng(1)
    surveyor = Surveyor(generated("symmetric", 5, 26.0))
    (image,) = surveyor.plan.aliases
    first = surveyor.explore(random, Survey(path_length=20.0), start=(3.0, 2.0))
    second = surveyor.explore(random, Survey(path_length=20.0), start=tuple(Pose(*image).apply(first.path[:1, :2])[0]))
    result = decide(landmarks_of(first.grid), landmarks_of(second.grid))
    error = displacement(pair_of(first, second).truth, result.transform, landmarks_of(second.grid).surface.points)
    assert error.max() > 5.0 and result.evidence.matched > 20.0, "walls cannot tell the halves"
    assert not sure(result)


def test_the_readme_tells_the_rules():
    with open(os.path.join(os.path.dirname(__file__), "..", "..", "README.md"), encoding="utf-8") as file:
        readme = " ".join(file.read().split())
    short, long, moved = ONCE_RULE
    least = min(criteria.matched for criteria in ONCE_PRIOR_RULE)
    for words in (
        f"believed with {short.matched:g} m of shared wall and no rival of half the length",
        f"with {long.matched:g} m unless a rival scores {100 * long.rival:g} %",
        f"with {moved.matched:g} m and up to {100 * moved.conflict:g} % of contradictions",
        f"with a prior from {least:g} m on",
        f"`sure` is an answer with {SURE_CRITERIA.matched:g} m of shared wall, at most "
        f"{100 * SURE_CRITERIA.conflict:g} % of contradictions",
        f"fits elsewhere for more than {100 * SURE_LOOKALIKE:g} % of that length",
    ):
        assert words in readme, words
    assert short.plausible == 0.5
