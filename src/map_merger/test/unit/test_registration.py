"""Registration: right where maps overlap, declined where they do not or where rooms repeat, never wrong."""

import importlib.util
import math
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from map_merger import benchmark, features, fourier, registration, search
from map_merger.alignment import Alignment
from map_merger.evidence import Evidence, compare, compare_samples
from map_merger.job import Job, LandmarkCache, Member, Versioned
from map_merger.refine import FINE_REACH, refined
from map_merger.registration import (
    KEEP_CRITERIA,
    LARGEST_LOOKALIKE,
    STRONG_CRITERIA,
    Limits,
    Prior,
    Registration,
    Verdict,
    believed_alone,
    follow,
    register,
)
from map_merger.robot_size import USUAL_SIZE
from map_merger.surface import landmarks_of, subsample
from map_merger.synthetic import Survey, Surveyor, generated, office_plan, pair_of
from map_merger.transform import displacement, rotation_between
from mr_grid import GridInfo, OccupancyGrid, Pose, empty_grid


@pytest.fixture(scope="module")
def overlapping():
    """Two maps that share much, and the truth."""
    random = np.random.default_rng(5)
    surveyor = Surveyor(office_plan(random))
    survey = Survey(path_length=25.0)
    target = surveyor.explore(random, survey)
    source = surveyor.explore(random, survey, start=tuple(target.path[0, :2]), yaw=2.4)
    return pair_of(target, source)


def error(pair, transform):
    return displacement(pair.truth, transform, benchmark.overlap(pair.target.grid, pair.source.grid, pair.truth)).max()


def moved(grid, transform):
    """The same map in a frame that is displaced: a point p becomes transform(p)."""
    return OccupancyGrid(replace(grid.info, origin=transform.compose(grid.info.origin)), grid.cells)


def test_the_search_needs_no_later_scipy_than_1_3(overlapping, monkeypatch):
    """Ubuntu 20.04 has 1.3.3, in which scipy.fft is no module."""
    monkeypatch.setitem(sys.modules, "scipy.fft", None)
    spec = importlib.util.spec_from_file_location("map_merger.fourier_of_scipy_1_3", fourier.__file__)
    old = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(old)
    assert old.rfft2 is np.fft.rfft2
    target, source = (landmarks_of(part.grid) for part in (overlapping.target, overlapping.source))
    expected = search.candidates(target, source, 3)
    monkeypatch.setattr("map_merger.fourier", old)
    found = search.candidates(target, source, 3)
    assert [each.score for each in found] == pytest.approx([each.score for each in expected], rel=1e-4)
    assert [each.transform for each in found] == [each.transform for each in expected]


@settings(max_examples=12)
@given(st.floats(-30, 30), st.floats(-30, 30), st.floats(-math.pi, math.pi))
def test_any_displacement_of_the_frames_is_found(overlapping, x, y, yaw):
    frame = Pose(x, y, yaw)
    source = landmarks_of(moved(overlapping.source.grid, frame))
    result = register(landmarks_of(overlapping.target.grid), source)
    assert result.accepted, result.verdict
    found = result.transform.compose(frame)
    assert error(overlapping, found) < 0.1
    assert rotation_between(found, overlapping.truth) < math.radians(0.5)


def test_it_is_precise_both_ways_and_repeatable(overlapping):
    target, source = landmarks_of(overlapping.target.grid), landmarks_of(overlapping.source.grid)
    there, back = register(target, source), register(source, target)
    assert error(overlapping, there.transform) < 0.05
    assert error(overlapping, back.transform.inverse()) < 0.05
    assert register(target, source).transform == there.transform


def test_different_resolutions_register(overlapping):
    random = np.random.default_rng(5)
    surveyor = Surveyor(office_plan(random))
    target = surveyor.explore(random, Survey(path_length=25.0))
    coarse = surveyor.explore(random, Survey(path_length=25.0, resolution=0.1), start=tuple(target.path[0, :2]))
    result = register(landmarks_of(target.grid), landmarks_of(coarse.grid))
    assert result.accepted, result.verdict
    assert error(pair_of(target, coarse), result.transform) < 0.25


AGENTS = benchmark.RULES["agents, no sighting"]
ALONE = benchmark.RULES["two maps"]


@pytest.mark.parametrize("family", benchmark.FAMILIES, ids=lambda family: family.name)
def test_never_wrong(family):
    """The symmetric building was left out: its halves are exact images, so that only a meeting can tell them apart."""
    cases = [benchmark.draw_case(seed, family) for seed in range(500, 503)]
    outcomes = [benchmark.measured(AGENTS, case) for case in cases]
    assert benchmark.counts(outcomes)["wrong"] == 0, outcomes


def test_right_where_enough_is_shared():
    family = benchmark.FAMILIES[0]
    cases = [benchmark.draw_case(seed, family) for seed in range(600, 612)]
    enough = [case for case in cases if case.shared >= 25.0 and not case.alias]
    assert len(enough) >= 3
    outcomes = [benchmark.measured(ALONE, case) for case in enough]
    assert sum(outcome.kind == "right" for outcome in outcomes) >= 0.7 * len(enough), outcomes


def test_other_rooms_of_the_same_building_are_declined():
    random = np.random.default_rng(3)
    surveyor = Surveyor(office_plan(random, same=True))
    survey = Survey(path_length=3.0)
    first = surveyor.explore(random, survey, start=(2.0, 2.4))
    second = surveyor.explore(random, survey, start=(14.3, 2.4))
    result = register(landmarks_of(first.grid), landmarks_of(second.grid))
    assert Alignment().finished(result) == ""


@pytest.mark.parametrize(
    "grid",
    [
        empty_grid(GridInfo(0, 0, 0.05)),
        empty_grid(GridInfo(30, 30, 0.05)),
        OccupancyGrid(GridInfo(30, 30, 0.05), np.zeros((30, 30), np.int8)),
        OccupancyGrid(GridInfo(30, 30, 0.05), np.full((30, 30), 100, np.int8)),
        OccupancyGrid(GridInfo(1, 1, 0.05), np.zeros((1, 1), np.int8)),
    ],
)
@pytest.mark.parametrize("method", [registration.register, features.register])
def test_maps_without_walls_are_declined(overlapping, grid, method):
    full = landmarks_of(overlapping.target.grid)
    assert not method(full, landmarks_of(grid)).accepted
    assert not method(landmarks_of(grid), full).accepted
    assert not method(landmarks_of(grid), landmarks_of(grid)).accepted


def test_a_lone_corridor_is_declined():
    cells = np.zeros((40, 400), np.int8)
    cells[[0, -1]] = 100
    corridor = landmarks_of(OccupancyGrid(GridInfo(400, 40, 0.05), cells))
    assert not register(corridor, corridor).accepted


def test_a_square_room_is_ambiguous():
    cells = np.zeros((200, 200), np.int8)
    cells[[0, -1]] = 100
    cells[:, [0, -1]] = 100
    square = landmarks_of(OccupancyGrid(GridInfo(200, 200, 0.05), cells))
    assert register(square, square).verdict is Verdict.AMBIGUOUS


def test_a_prior_helps_where_little_is_shared_and_a_false_one_does_not_mislead():
    helped = 0
    for seed in range(700, 706):
        random = np.random.default_rng(seed)
        surveyor = Surveyor(office_plan(random))
        first = surveyor.explore(random, Survey(path_length=4.0))
        pair = pair_of(first, surveyor.explore(random, Survey(path_length=4.0), start=tuple(first.path[0, :2] + 1.0)))
        target, source = landmarks_of(pair.target.grid), landmarks_of(pair.source.grid)
        rough = pair.truth.compose(Pose(*random.uniform(-1.4, 1.4, 2), random.uniform(-0.35, 0.35)))
        result = register(target, source, registration.PRIOR_CRITERIA, prior=Prior(rough))
        assert not result.accepted or error(pair, result.transform) < 0.25
        helped += result.accepted and not register(target, source).accepted
        false = rough.compose(Pose(12.0, 5.0, 1.5))
        misled = register(target, source, registration.PRIOR_CRITERIA, prior=Prior(false))
        assert not misled.accepted
    assert helped >= 1


def test_limits(overlapping):
    target, source = landmarks_of(overlapping.target.grid), landmarks_of(overlapping.source.grid)
    assert register(target, source, limits=Limits(rotation=1.0)).verdict is Verdict.BEYOND_LIMITS
    assert register(target, source, limits=Limits(rotation=math.pi)).accepted


def test_features_are_verified_too(overlapping):
    target, source = landmarks_of(overlapping.target.grid), landmarks_of(overlapping.source.grid)
    result = features.register(target, source)
    assert result.accepted, result.verdict
    assert error(overlapping, result.transform) < 0.1


@settings(max_examples=10)
@given(st.floats(-0.15, 0.15), st.floats(-0.15, 0.15), st.floats(-0.02, 0.02))
def test_refinement_draws_in_small_errors(overlapping, x, y, yaw):
    target, source = landmarks_of(overlapping.target.grid), landmarks_of(overlapping.source.grid)
    start = Pose(x, y, yaw).compose(overlapping.truth)
    better, evidence = follow(target, source, start)
    assert error(overlapping, better) < 0.06
    assert evidence.conflict < 0.02


def test_refinement_without_partners_changes_nothing(overlapping):
    target, source = landmarks_of(overlapping.target.grid), landmarks_of(overlapping.source.grid)
    far = Pose(500.0, 0.0, 0.0)
    assert refined(target.surface, source.surface, far, FINE_REACH) == far
    assert compare(target, source, far) == Evidence()


def test_walls_in_free_space_are_conflicts(overlapping):
    target, source = landmarks_of(overlapping.target.grid), landmarks_of(overlapping.source.grid)
    assert compare(target, source, overlapping.truth).conflict < 0.02
    assert compare(target, source, Pose(1.0, 1.0, 0.0).compose(overlapping.truth)).conflict > 0.3


def look(matched, transform=None, conflict=0.0, surveyed=100.0, verdict=Verdict.ACCEPTED):
    return Registration(
        verdict, transform or Pose(1.0, 2.0, 0.5), Evidence(matched, matched / 3, conflict, 0.8, 0.02), surveyed
    )


def with_prior(matched, transform=None, surveyed=100.0, verdict=Verdict.ACCEPTED):
    return look(matched, transform, surveyed=surveyed, verdict=verdict)._replace(prior=True)


def test_weak_evidence_needs_a_second_look_at_grown_maps():
    alignment = Alignment()
    assert alignment.finished(with_prior(18.0)) == "" and alignment.transform is None
    assert alignment.finished(with_prior(18.0)) == "", "the same maps tell nothing new"
    assert alignment.finished(with_prior(20.5)) == "", "too little growth"
    assert alignment.finished(with_prior(21.5)) == "accepted"


def test_two_rooms_are_not_enough_without_prior_or_meeting():
    """Buildings of exact copies of rooms made wrong merges with 22 m to 34 m of shared wall."""
    alignment = Alignment()
    alignment.finished(look(22.0, surveyed=52.0))
    assert alignment.finished(look(34.0, surveyed=90.0)) == ""
    assert alignment.finished(look(34.0, surveyed=90.0)._replace(met=True)) == "accepted"


def test_growth_elsewhere_without_a_contradiction_confirms_as_well():
    alignment = Alignment()
    alignment.finished(with_prior(21.0, surveyed=60.0))
    assert alignment.finished(with_prior(21.0, surveyed=90.0)) == "accepted"


@pytest.mark.parametrize("between", [Verdict.AMBIGUOUS, Verdict.CONTRADICTED, Verdict.CONTRADICTS_TEAM])
def test_a_candidate_that_meets_doubt_starts_anew(between):
    alignment = Alignment()
    alignment.finished(with_prior(15.0))
    alignment.finished(with_prior(16.0, verdict=between))
    assert alignment.finished(with_prior(20.0)) == "", "without the doubt this look would have confirmed the first one"
    assert alignment.finished(with_prior(25.0)) == "accepted"


def test_another_transform_does_not_confirm():
    alignment = Alignment()
    alignment.finished(with_prior(15.0))
    assert alignment.finished(with_prior(20.0, Pose(5.0, 2.0, 0.5))) == ""
    assert alignment.transform is None
    assert alignment.finished(with_prior(25.0, Pose(5.0, 2.0, 0.5))) == "accepted"


def test_strong_evidence_is_believed_at_once():
    alignment = Alignment()
    assert alignment.finished(look(STRONG_CRITERIA.matched + 1.0)) == "accepted"


def test_a_building_that_repeats_is_not_believed_by_walls_alone():
    """Robots in the two halves of a symmetric building matched 49 m to 73 m of wall without a contradiction."""
    strong = look(STRONG_CRITERIA.matched + 10.0)
    assert believed_alone(strong)
    assert not believed_alone(strong._replace(lookalike=0.6))
    assert not believed_alone(look(STRONG_CRITERIA.matched - 1.0))
    assert not believed_alone(look(STRONG_CRITERIA.matched + 10.0, verdict=Verdict.AMBIGUOUS))


@pytest.mark.parametrize("kind, repeats", [("equal_rooms", True), ("caves", False)])
def test_equal_rooms_look_alike(kind, repeats):
    random = np.random.default_rng(3)
    surveyor = Surveyor(generated(kind, 3, 26.0))
    first = surveyor.explore(random, Survey(path_length=25.0))
    second = surveyor.explore(random, Survey(path_length=25.0), start=tuple(first.path[0, :2]))
    result = register(landmarks_of(first.grid), landmarks_of(second.grid))
    assert (result.lookalike > LARGEST_LOOKALIKE) == repeats


def test_samples_tell_what_the_whole_surfaces_tell(overlapping):
    target, source = landmarks_of(overlapping.target.grid), landmarks_of(overlapping.source.grid)
    whole = compare(target, source, overlapping.truth)
    part = compare_samples(
        target, source, subsample(target.surface, 600), subsample(source.surface, 600), overlapping.truth
    )
    assert part.matched == pytest.approx(whole.matched, rel=0.1)
    assert part.explained == pytest.approx(whole.explained, abs=0.05)
    assert part.minor == pytest.approx(whole.minor, rel=0.2)


@pytest.fixture(scope="module")
def chain():
    """Three maps along a corridor: the first and the last share hardly anything, the middle one overlaps both."""
    random = np.random.default_rng(0)
    surveyor = Surveyor(office_plan(random))
    return [
        surveyor.explore(random, Survey(reach=5.0, beams=271, path_length=length), start=start)
        for length, start in ((10.0, (2.0, 6.0)), (60.0, (4.0, 6.0)), (14.0, (19.0, 6.0)))
    ]


def job(target, source, team=(), current=None):
    return Job(
        "source",
        Versioned("target", target),
        Versioned("source", source),
        tuple(team),
        current,
        None,
        Limits(),
        "correlation",
        LandmarkCache(USUAL_SIZE),
        USUAL_SIZE,
    )


def test_the_cache_of_landmarks_is_bounded_in_cells(monkeypatch):
    monkeypatch.setattr("map_merger.job._CACHED_CELLS", 2 * 32 * 32)
    cache, drawn = LandmarkCache(USUAL_SIZE), []
    for key in (1, 2, 2, 1, 3, 1, 2):
        cache.of(
            key, lambda key=key: drawn.append(key) or OccupancyGrid(GridInfo(30, 30, 0.05), np.zeros((30, 30), np.int8))
        )
    assert drawn == [1, 2, 3, 2]


def test_a_robot_without_shared_walls_is_registered_through_another_one(chain):
    first, middle, last = chain
    assert not job(first.grid, last.grid).run().accepted
    member = Member(Versioned("middle", middle.grid), pair_of(first, middle).truth)
    result = job(first.grid, last.grid, [member]).run()
    assert result.accepted
    assert error(pair_of(first, last), result.transform) < 0.1


def test_a_transform_that_contradicts_the_team_is_refused(chain):
    first, middle, _ = chain
    alone = job(first.grid, middle.grid).run()
    assert alone.accepted
    displaced = Member(Versioned("other", middle.grid), Pose(0.0, 1.2, 0.0).compose(alone.transform))
    assert job(first.grid, middle.grid, [displaced]).run().verdict is Verdict.CONTRADICTS_TEAM
    agreeing = Member(Versioned("other", middle.grid), alone.transform)
    assert job(first.grid, middle.grid, [agreeing]).run().accepted


def test_a_followed_transform_is_corrected_a_little(overlapping):
    target, source = overlapping.target.grid, overlapping.source.grid
    near = Pose(0.05, -0.05, 0.003).compose(overlapping.truth)
    result = job(target, source, current=near).run()
    assert result.accepted and not result.prior and error(overlapping, result.transform) < 0.06


@pytest.mark.parametrize("team", [False, True])
def test_a_followed_transform_is_revoked_when_walls_contradict_it_though_none_are_shared(overlapping, team):
    """With less than 4 m of shared wall it stayed in force for good, whatever stood in free space."""
    target, source = overlapping.target.grid, overlapping.source.grid
    wrong = overlapping.truth.compose(Pose(0.0, 0.0, 0.8))
    members = [Member(Versioned("other", target), Pose(0.02, 0.0, 0.0))] if team else []
    alignment = Alignment()
    assert alignment.finished(look(STRONG_CRITERIA.matched + 1.0, wrong)) == "accepted"
    result = job(target, source, members, current=wrong).run()
    assert result.evidence.matched < KEEP_CRITERIA.matched
    assert alignment.finished(result) == ""
    assert alignment.finished(job(target, source, members, current=wrong).run()) == "revoked"


def test_maps_that_do_not_overlap_any_more_say_nothing_about_a_followed_transform(overlapping):
    target, source = overlapping.target.grid, overlapping.source.grid
    far = Pose(500.0, 0.0, 0.0)
    assert job(target, source, current=far).run().verdict is Verdict.TOO_LITTLE_SHARED_WALL


@pytest.mark.parametrize("size, contradicts", [(9, False), (30, True)])
def test_what_may_be_a_robot_does_not_contradict_free_space(overlapping, size, contradicts):
    target, source = overlapping.target.grid, overlapping.source.grid
    clear = landmarks_of(source).clear
    cells, info = source.cells.copy(), landmarks_of(source).info
    corner = source.info.cells_of(info.origin.apply(np.zeros((1, 2)) + 0.5 * info.resolution))[0]
    rows, columns = np.nonzero(clear)
    middle = np.argmin(abs(rows - rows.mean()) + abs(columns - columns.mean()))
    row, column = int(corner[0]) + rows[middle], int(corner[1]) + columns[middle]
    cells[row : row + size, column : column + size] = 100
    cells[row + 1 : row + size - 1, column + 1 : column + size - 1] = -1
    before = compare(landmarks_of(target), landmarks_of(source), overlapping.truth)
    after = compare(landmarks_of(target), landmarks_of(OccupancyGrid(source.info, cells)), overlapping.truth)
    assert (after.conflict > before.conflict + 0.01) == contradicts
