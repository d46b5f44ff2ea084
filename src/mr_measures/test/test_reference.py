"""P_ref beside the world."""

import json

import numpy as np
import pytest

from mr_grid import OccupancyGrid
from mr_measures.reference import (
    MapReferenceError,
    Reference,
    error_of_map,
    load_reference,
    reference_path,
    write_reference,
)

CELLS = {seed: 1000 + seed for seed in range(11)}


def reference(**changes):
    return Reference(**{"world": "flat", "resolution": 0.05, "slam": "ours", "host": "here", "code": "c0de",
                        "free_cells": CELLS, **changes})  # fmt: skip


def map_of(free_cells, resolution=0.05):
    return OccupancyGrid.of(np.zeros((1, free_cells), np.int8), resolution)


def test_what_is_written_is_read(tmp_path):
    world = tmp_path / "flat.world"
    assert load_reference(world) is None
    write_reference(world, reference(free_cells={7: 1}))
    assert write_reference(world, reference()) == reference_path(world) == tmp_path / "flat.reference.json"
    assert load_reference(world) == reference() and reference().median == 1005 and reference().is_sufficient
    document = json.loads(reference_path(world).read_text())
    assert document["median"] == 1005 and document["missions"][0] == {"seed": 0, "free_cells": 1000}
    assert list(tmp_path.iterdir()) == [reference_path(world)]


def test_error_is_taken_against_the_median(tmp_path):
    write_reference(tmp_path / "flat.world", reference())
    error, reason = error_of_map(tmp_path / "flat.world", map_of(2010), "ours", "here")
    assert (error, reason) == (pytest.approx(100.0), "")


@pytest.mark.parametrize(
    "changes, reason",
    [
        ({"host": "elsewhere"}, "of another host: elsewhere, not here"),
        ({"slam": "gmapping"}, "with gmapping at 0.05 m"),
        ({"resolution": 0.1}, "with ours at 0.1 m"),
        ({"free_cells": {1: 1000}}, "only 1 of 10"),
    ],
)
def test_what_cannot_be_compared_is_refused_in_words(tmp_path, changes, reason):
    write_reference(tmp_path / "flat.world", reference(**changes))
    error, told = error_of_map(tmp_path / "flat.world", map_of(1005), "ours", "here")
    assert error is None and reason in told


@pytest.mark.parametrize(
    "text, reason",
    [
        ("", "Expecting value"),
        ("[]", "indices"),
        ("{}", "'missions' is missing"),
        ('{"world": "x", "resolution": 0.05, "slam": "y", "missions": []}', "'host' is missing"),
        ('{"world": "x", "resolution": 0.05, "slam": "y", "host": "z", "code": "", "missions": []}', "no missions"),
    ],
)
def test_broken_reference(tmp_path, text, reason):
    world = tmp_path / "flat.world"
    reference_path(world).write_text(text)
    with pytest.raises(MapReferenceError, match=rf"flat\.reference\.json.*{reason}"):
        load_reference(world)
