"""Transforms that robots of the ROS stack believed, against the truth."""

from dataclasses import replace

import numpy as np
import pytest

from mr_grid import Pose
from mr_launch.judging import Judge, Witness
from mr_launch.truth import Track
from mr_measures.record.robot_record import Merge

BEGIN = 5.0  # s of simulation time
START = Pose(2.0, 1.0, 0.5)
OTHER = Pose(-4.0, -1.0, 0.3)
TRUE = START.between(OTHER)
PLACES = np.random.default_rng(1).uniform(-6.0, 6.0, (300, 2))  # world frame
DRIFT = Pose(0.4, 0.0, 0.0)  # of a map from 20 s on


def witness(start, known_from=0.0, drifts=False):
    """Goes ahead at 0.1 m/s."""

    def true(time):
        return start.compose(Pose(0.1 * time, 0.0, 0.0))

    def believed(time):
        here = start.between(true(time))
        return DRIFT.compose(here) if drifts and time >= 20.0 else here

    poses = [(2.0 * number, believed(2.0 * number)) for number in range(60)]
    return Witness(start, poses, true, np.full(len(PLACES), known_from))


def only(transform, at=20.0, **robots):
    judge = Judge(PLACES, {"a": witness(START), "b": witness(OTHER), **robots})
    (entry,) = judge.judge("a", [Merge("b", at, transform)], BEGIN)
    return entry


@pytest.mark.parametrize(("shift", "kind", "right"), [
    (0.0, "right", True), (0.2, "imprecise", True), (0.3, "wrong", False),
])  # fmt: skip
def test_an_error_against_the_true_starts(shift, kind, right):
    entry = only(TRUE._replace(x=TRUE.x + shift))
    assert (entry.kind, entry.right, entry.at) == (kind, right, 20.0)
    assert entry.offset == pytest.approx(shift, abs=1e-3) and entry.turn == 0.0


def test_a_map_that_has_drifted_lies_elsewhere_from_then_on():
    """The robot of map b believes to be 0.4 m off since 20 s, when it was 2 m ahead: what lies there is elsewhere in
    its map, and another transform is right."""
    ahead = OTHER.apply_inverse(PLACES)[:, 0] > 3.0
    late = replace(witness(OTHER, drifts=True), known=np.where(ahead, 0.0, np.inf))
    drifted = TRUE.compose(DRIFT.inverse())
    assert only(TRUE, at=10.0, b=late).right and not only(drifted, at=10.0, b=late).right
    assert only(drifted, at=110.0, b=late).offset < 0.01 and not only(TRUE, at=110.0, b=late).right


def test_what_was_not_known_then_does_not_count():
    """Nothing was shared: the starts tell, for all that b knew then."""
    assert only(TRUE, at=20.0, a=witness(START, known_from=90.0)).offset == 0.0
    turned = TRUE._replace(yaw=TRUE.yaw + 0.02)
    nothing = witness(OTHER, known_from=90.0)
    assert only(turned, at=20.0, b=nothing).offset == 0.0 < only(turned, at=90.0, b=nothing).offset


def test_a_robot_without_a_witness_and_a_loss_are_not_judged():
    judge = Judge(PLACES, {"a": witness(START)})
    entries = (Merge("b", 1.0, TRUE), Merge("b", 2.0, None))
    assert judge.judge("a", entries, BEGIN) == entries and judge.judge("b", entries, BEGIN) == entries


def test_the_true_pose_at_a_time_lies_between_two_rows():
    track = Track()
    assert track.at(1.0) is None
    for step in range(3):
        track.add((0.05 * step, 0.0, float(step), 0.0, 0.4 * step, 0.0, 0.0, 0, 0))
    assert [track.at(time) for time in (-1.0, 0.2)] == [None, None]
    assert [track.at(time).x for time in (0.0, 0.02, 0.05, 0.1)] == pytest.approx([0.0, 0.4, 1.0, 2.0])
    assert track.at(0.075).yaw == pytest.approx(0.6)
