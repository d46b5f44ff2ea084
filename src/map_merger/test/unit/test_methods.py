"""Methods of registration outside of this package: their transforms are verified like those of the search."""

import math
from pathlib import Path

import numpy as np
import pytest

from map_merger import features, registration
from map_merger.benchmark import overlap
from map_merger.job import Job, LandmarkCache, Versioned
from map_merger.methods import METHODS, method_of
from map_merger.options import OptionError, options_of
from map_merger.registration import Limits, Verdict
from map_merger.robot_size import USUAL_SIZE
from map_merger.surface import landmarks_of
from map_merger.synthetic import Survey, Surveyor, office_plan, pair_of
from map_merger.transform import displacement
from mr_grid import Pose

EXAMPLE = Path(__file__).resolve().parents[4] / "docs" / "examples" / "akaze_registration.py"


@pytest.fixture(scope="module")
def pair():
    """Two maps that share much, and the truth."""
    random = np.random.default_rng(5)
    surveyor = Surveyor(office_plan(random))
    survey = Survey(path_length=25.0)
    target = surveyor.explore(random, survey)
    return pair_of(target, surveyor.explore(random, survey, start=tuple(target.path[0, :2]), yaw=2.4))


def error(pair, transform):
    return displacement(pair.truth, transform, overlap(pair.target.grid, pair.source.grid, pair.truth)).max()


def own_method(folder, text):
    """Place of a function that gives these transforms."""
    file = folder / "mine.py"
    file.write_text(f"def candidates(target, source):\n    return {text}\n")
    return f"{file}:candidates"


def test_methods_of_the_package_go_by_name():
    assert set(METHODS) == {"correlation", "features"}
    assert method_of("correlation") is registration.register and method_of("features") is features.register


def test_a_right_candidate_is_refined_and_accepted_a_wrong_one_declined(pair, tmp_path):
    near = Pose(0.1, -0.05, 0.01).compose(pair.truth)
    wrong = Pose(3.0, 1.0, math.pi).compose(pair.truth)
    place = own_method(tmp_path, f"[{tuple(wrong)}, {tuple(near)}]")
    target, source = Versioned("target", pair.target.grid), Versioned("source", pair.source.grid)
    result = Job("source", target, source, (), None, None, Limits(), place, LandmarkCache(USUAL_SIZE), USUAL_SIZE).run()
    assert result.accepted, result.verdict
    assert error(pair, result.transform) < 0.1


def test_without_a_candidate_nothing_is_believed(pair, tmp_path):
    target, source = landmarks_of(pair.target.grid), landmarks_of(pair.source.grid)
    assert method_of(own_method(tmp_path, "[]"))(target, source).verdict is Verdict.NO_CANDIDATE


def test_the_example_gives_a_right_transform_that_is_accepted(pair):
    target, source = landmarks_of(pair.target.grid), landmarks_of(pair.source.grid)
    result = method_of(f"{EXAMPLE}:candidates")(target, source)
    assert result.accepted, result.verdict
    assert error(pair, result.transform) < 0.1


def test_the_parameter_takes_a_place(tmp_path):
    place = own_method(tmp_path, "[]")
    assert options_of({"registration": place}, "joy").registration == place
    with pytest.raises(OptionError, match=r"parameter registration: .*mine.py has no other"):
        options_of({"registration": place.replace(":candidates", ":other")}, "joy")
    with pytest.raises(OptionError, match=r"parameter registration: .*No module named 'no_such_module'"):
        options_of({"registration": "no_such_module:candidates"}, "joy")
