"""One registration: a meeting chooses between rivals, a jump is followed, the covariance tells what the walls fix."""

import math

import numpy as np
import pytest

from map_merger.alignment import Alignment
from map_merger.benchmark import FAMILIES, draw_case, overlap
from map_merger.covariance import covariance_of, prior_from
from map_merger.evidence import compare
from map_merger.job import Job, LandmarkCache, Versioned
from map_merger.reasons import reason_of
from map_merger.registration import DEFAULT_CRITERIA, STRONG_CRITERIA, Limits, Registration, Verdict, register
from map_merger.robot_size import USUAL_SIZE
from map_merger.sighting import Sighting, view_of
from map_merger.surface import landmarks_of
from map_merger.synthetic import Survey, Surveyor, office_plan, pair_of
from map_merger.transform import displacement
from mr_grid import FREE, OCCUPIED, GridInfo, OccupancyGrid, Pose, normalized


def job(target, source, current=None, **more):
    return Job(
        "source",
        Versioned("target", target),
        Versioned("source", source),
        (),
        current,
        None,
        Limits(),
        "correlation",
        LandmarkCache(USUAL_SIZE),
        USUAL_SIZE,
        **more,
    )


PLACE, AWAY = (2.0, 3.0), (-2.0, 0.0)


def square_room(robot=None):
    """10 m x 10 m: four transforms fit equally well."""
    cells = np.full((200, 200), FREE, np.int8)
    cells[[0, -1]] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    if robot is not None:
        for angle in np.linspace(0.0, 2.0 * math.pi, 40):
            x, y = robot[0] + 0.2 * math.cos(angle), robot[1] + 0.2 * math.sin(angle)
            cells[int((y + 5.0) / 0.05), int((x + 5.0) / 0.05)] = OCCUPIED
    return OccupancyGrid(GridInfo(200, 200, 0.05, Pose(-5.0, -5.0, 0.0)), cells)


def meeting(*places):
    """What a job is told when the source's robot stood at these places, seen by the other one, and drove off."""
    return {
        "source_track": np.array([(*PLACE, 5.0), (*AWAY, 9.0)]),
        "seen": tuple(Sighting(view_of(square_room(place), None), *PLACE, 5.0) for place in places),
    }


def test_maps_with_too_little_wall_are_not_searched(monkeypatch):
    """Most searches at the start were of maps in which no transform could be believed."""
    cells = square_room().cells.copy()
    cells[50:] = -1
    cells[:, 0] = -1
    short = OccupancyGrid(square_room().info, cells)
    long = landmarks_of(square_room()).surface.length
    assert landmarks_of(short).surface.length < DEFAULT_CRITERIA.matched < long
    with monkeypatch.context() as patch:
        patch.setattr("map_merger.registration.register", lambda *_: pytest.fail("searched"))
        result = job(square_room(), short).run()
    assert result.verdict is Verdict.TOO_LITTLE_SHARED_WALL
    assert "less than the 14 m of wall" in reason_of(result, DEFAULT_CRITERIA)
    assert job(square_room(), square_room()).run().verdict is Verdict.AMBIGUOUS


def test_rivals_are_told():
    square = landmarks_of(square_room())
    result = register(square, square)
    assert result.verdict is Verdict.AMBIGUOUS
    found = sorted(round(normalized(each.yaw) / (math.pi / 2)) % 4 for each in (result.transform, *result.rivals))
    assert found == [0, 1, 2, 3]


def test_a_meeting_chooses_between_rivals():
    """The verdict "ambiguous" used to end the matter before anybody asked whether the robots had met."""
    alone = job(square_room(), square_room()).run()
    assert alone.verdict is Verdict.AMBIGUOUS
    result = job(square_room(), square_room(), **meeting(PLACE)).run()
    assert result.accepted and result.met
    assert displacement(result.transform, Pose(), np.array([[5.0, 5.0]]))[0] < 0.05
    assert Alignment().finished(result) == "accepted"


@pytest.mark.parametrize("places", [[(-4.0, -4.0)], [PLACE, (-3.0, 2.0)]], ids=["by none", "by two"])
def test_a_meeting_by_none_or_several_of_the_rivals_chooses_nothing(places):
    assert job(square_room(), square_room(), **meeting(*places)).run().verdict is Verdict.AMBIGUOUS


@pytest.fixture(scope="module")
def overlapping():
    """Two maps that share much, and the truth."""
    random = np.random.default_rng(5)
    surveyor = Surveyor(office_plan(random))
    survey = Survey(path_length=25.0)
    target = surveyor.explore(random, survey)
    source = surveyor.explore(random, survey, start=tuple(target.path[0, :2]), yaw=2.4)
    return pair_of(target, source)


@pytest.mark.parametrize("jump", [Pose(1.5, 1.0, 0.1), Pose(-0.4, 1.8, -0.2), Pose(0.7, 0.0, 0.0)])
def test_a_loop_closure_is_followed(overlapping, jump):
    """The transform used to stay where it was until it was revoked, and was then searched from nothing."""
    target, source = overlapping.target.grid, overlapping.source.grid
    former = jump.compose(overlapping.truth)
    result = job(target, source, current=former).run()
    points = overlap(target, source, overlapping.truth)
    assert result.accepted and displacement(result.transform, overlapping.truth, points).max() < 0.06
    alignment = Alignment()
    evidence = compare(landmarks_of(target), landmarks_of(source), overlapping.truth)
    assert evidence.matched > STRONG_CRITERIA.matched
    alignment.finished(Registration(Verdict.ACCEPTED, former, evidence))
    assert alignment.finished(result) == "moved" and alignment.transform == result.transform


def test_what_is_farther_than_a_loop_closure_moves_a_map_is_contradicted(overlapping):
    far = Pose(7.0, 3.0, 0.0).compose(overlapping.truth)
    result = job(overlapping.target.grid, overlapping.source.grid, current=far).run()
    assert result.verdict is Verdict.CONTRADICTED


def test_a_transform_that_holds_is_refined_and_never_searched(overlapping, monkeypatch):
    monkeypatch.setattr("map_merger.registration.register", lambda *_: pytest.fail("searched"))
    result = job(overlapping.target.grid, overlapping.source.grid, current=overlapping.truth).run()
    assert result.accepted and not result.prior and result.covariance is not None


def test_the_covariance_covers_the_errors():
    """Squares of errors in standard deviations, three dimensions: 3 on average, above 16.3 once in a thousand."""
    squares = []
    for family in FAMILIES[:3]:
        for seed in range(2000, 2006):
            case = draw_case(seed, family)
            target, source = landmarks_of(case.target[-1]), landmarks_of(case.source[-1])
            result = register(target, source)
            if result.accepted:
                error = np.array(result.transform) - np.array(case.truth)
                error[2] = normalized(error[2])
                covariance = np.array(covariance_of(target, source, result.transform))
                squares.append(error @ np.linalg.solve(covariance, error))
    assert len(squares) >= 4
    assert max(squares) < 16.3


def test_the_shift_along_a_corridor_is_left_open():
    cells = np.zeros((40, 400), np.int8)
    cells[[0, -1]] = OCCUPIED
    corridor = landmarks_of(OccupancyGrid(GridInfo(400, 40, 0.05), cells))
    along, across, turn = np.sqrt(np.diag(covariance_of(corridor, corridor, Pose())))
    assert along > 1.5 and across < 0.2 and turn < math.radians(1.0)


def test_far_from_the_walls_a_turn_counts_more(overlapping):
    target, source = landmarks_of(overlapping.target.grid), landmarks_of(overlapping.source.grid)
    near = covariance_of(target, source, overlapping.truth)
    shifted = Pose(100.0, 0.0, 0.0)
    far_source = landmarks_of(
        OccupancyGrid(
            GridInfo(
                overlapping.source.grid.info.width,
                overlapping.source.grid.info.height,
                overlapping.source.grid.info.resolution,
                shifted.compose(overlapping.source.grid.info.origin),
            ),
            overlapping.source.grid.cells,
        )
    )
    far = covariance_of(target, far_source, overlapping.truth.compose(shifted.inverse()))
    assert np.linalg.det(far) == pytest.approx(np.linalg.det(near), rel=1e-3)
    assert np.trace(np.array(far)[:2, :2]) > 20.0 * np.trace(np.array(near)[:2, :2])


def test_a_prior_is_as_wide_as_the_covariance_where_it_counts():
    sharp = ((1e-4, 0.0, 0.0), (0.0, 1e-4, 0.0), (0.0, 0.0, 1e-6))
    vague = ((0.25, 0.0, 0.0), (0.0, 0.04, 0.0), (0.0, 0.0, 0.04**2))
    transform = Pose(3.0, 1.0, 0.4)
    assert prior_from(transform, sharp) == (transform, 1.0, math.radians(8.0))
    assert prior_from(transform, vague).distance == pytest.approx(1.5)
    assert prior_from(transform, vague, (20.0, 0.0)).distance == pytest.approx(math.sqrt(9 * (0.04 + 0.64)), rel=0.1)
    assert prior_from(transform, vague, (90.0, 0.0)).distance == 3.0
