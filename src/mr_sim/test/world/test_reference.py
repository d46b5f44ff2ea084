"""P_ref beside the world."""

import json

import pytest

from mr_sim.reference import MapReferenceError, add_to_reference, load_reference, reference_path


def test_missions_are_added_and_their_median_is_kept(tmp_path):
    world = tmp_path / "flat.world"
    assert load_reference(world) is None
    for seed, cells in ((1, 1000), (2, 1100), (3, 1010)):
        reference = add_to_reference(world, seed, cells, 0.05, "mr_sim")
    assert reference == load_reference(world)
    assert reference.median == 1010 and not reference.is_sufficient
    assert reference_path(world).name == "flat.reference.json"
    document = json.loads(reference_path(world).read_text())
    assert document["median"] == 1010 and document["missions"][0] == {"seed": 1, "free_cells": 1000}
    assert list(tmp_path.iterdir()) == [reference_path(world)]


def test_same_seed_replaces_and_ten_suffice(tmp_path):
    world = tmp_path / "flat.world"
    for seed in (*range(10), 0):
        reference = add_to_reference(world, seed, 1000 + seed, 0.05, "mr_sim")
    assert len(reference.free_cells) == 10 and reference.is_sufficient


def test_what_cannot_be_compared_is_refused(tmp_path):
    world = tmp_path / "flat.world"
    add_to_reference(world, 1, 1000, 0.05, "mr_sim")
    with pytest.raises(MapReferenceError, match="cannot be compared"):
        add_to_reference(world, 2, 1000, 0.1, "mr_sim")
    with pytest.raises(MapReferenceError, match="cannot be compared"):
        add_to_reference(world, 2, 1000, 0.05, "gmapping")
    with pytest.raises(MapReferenceError, match="more than 0 free cells"):
        add_to_reference(world, 2, 0, 0.05, "mr_sim")


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"world": "x", "resolution": 0.05, "slam": "y", "missions": []}'])
def test_broken_reference(tmp_path, text):
    world = tmp_path / "flat.world"
    reference_path(world).write_text(text)
    with pytest.raises(MapReferenceError, match=r"flat\.reference\.json"):
        load_reference(world)
