"""Whether a believed transform was right, against the truth."""

import numpy as np

from mr_grid import Pose
from mr_measures.record.judgement import judged, true_transform
from mr_measures.record.robot_record import Merge

TRUE = Pose(3.0, -1.0, 0.5)
CORNERS = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 5.0], [0.0, 5.0]])


def kind_of(offsets, turn):
    return "wrong" if offsets.max() > 0.25 or turn > 0.04 else "right"


def test_a_shift_is_the_offset_everywhere():
    entry = judged("b", 12.34567, TRUE._replace(x=3.2), TRUE, CORNERS, kind_of)
    assert entry == Merge("b", 12.346, Pose(3.2, -1.0, 0.5), 0.2, 0.0, "right", True)


def test_of_a_turn_the_farthest_place_counts():
    entry = judged("b", 1.0, TRUE._replace(yaw=0.53), TRUE, CORNERS, kind_of)
    assert (entry.kind, entry.right, entry.turn) == ("wrong", False, 0.03)
    assert abs(entry.offset - 0.03 * np.hypot(10.0, 5.0)) < 1e-3


def test_the_truth_is_what_fits_the_places_that_both_know():
    """Both maps have drifted: the starts no longer say where one lies in the other."""
    source = np.random.default_rng(1).uniform(-5.0, 5.0, (20, 2))
    true, points = true_transform(Pose(), TRUE.apply(source), source, lambda: CORNERS)
    assert np.allclose(true, TRUE) and points is source


def test_where_too_few_are_shared_the_starts_say_it_for_all_of_the_others_map():
    few = np.zeros((19, 2))
    true, points = true_transform(TRUE, few + 1.0, few, lambda: CORNERS)
    assert true == TRUE and points is CORNERS
    _, points = true_transform(TRUE, few, few, lambda: np.zeros((0, 2)))
    assert len(points) == 1, "of nothing, the place where the other's map begins"
