"""The references of maps: made by this host, and the same again."""

import json
import re
import shutil
from dataclasses import replace

import pytest

from mr_experiments.sweep import map_reference, reference_command
from mr_experiments.sweep.map_reference import TOLERANCE, deviation, make_reference
from mr_experiments.trial.trial import TrialError
from mr_measures.reference import VIRTUAL_TIME, MapReferenceError, load_reference, write_reference
from mr_sim.worlds import find_world

WORLD, LIMIT = "small8x8", 300.0
FOREIGN = 1.003  # the share by which the references of a former host were off


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    """A copy of the world with its reference."""
    folder, source = tmp_path_factory.mktemp("worlds"), find_world(WORLD)
    for path in [source.with_suffix(".reference.json"), *source.parent.glob("*.inc"), source]:
        shutil.copy(path, folder)
    return folder / source.name


def altered(world, tmp_path, **changes):
    """The same world with another reference beside it."""
    shutil.copytree(world.parent, tmp_path, dirs_exist_ok=True)
    write_reference(tmp_path / world.name, replace(load_reference(world), **changes))
    return tmp_path / world.name


def test_references_are_of_this_host_and_of_seeds_that_nothing_else_uses():
    for path in find_world(WORLD).parent.glob("*.reference.json"):
        reference = load_reference(path.with_name(path.name.replace(".reference.json", ".world")))
        assert reference.host == VIRTUAL_TIME and reference.is_sufficient and reference.code, path
        assert min(reference.free_cells) >= 900001, path


def test_stored_mission_comes_out_the_same_again(world):
    assert abs(deviation(world, LIMIT)) <= TOLERANCE


def test_reference_that_is_off_by_as_much_as_a_former_one_is_found_out(world, tmp_path, capsys):
    off = {seed: round(FOREIGN * cells) for seed, cells in load_reference(world).free_cells.items()}
    other = altered(world, tmp_path, free_cells=off)
    assert reference_command.main([str(other), "--check", "--limit", str(LIMIT)]) == 1
    found = re.search(r"explores (-\d\.\d+) %.*store it anew", capsys.readouterr().out)
    assert found and float(found[1]) == pytest.approx(100 * (1 - FOREIGN), abs=0.02)


def test_reference_of_another_host_is_refused(world, tmp_path):
    with pytest.raises(MapReferenceError, match="another host: closed_loop, not mr_experiments"):
        deviation(altered(world, tmp_path, host="closed_loop"), LIMIT)


def test_command_stores_what_the_missions_explored(world, tmp_path, monkeypatch, capsys):
    def run(name, seeds, limit, jobs, progress):
        return replace(load_reference(world), free_cells={seed: 100 for seed in seeds})

    monkeypatch.setattr(reference_command, "make_reference", run)
    copy = altered(world, tmp_path)
    assert reference_command.main([str(copy), "--missions", "10", "--first-seed", "5"]) == 0
    assert sorted(load_reference(copy).free_cells) == list(range(5, 15))
    assert "before, median 100" in capsys.readouterr().out


def test_mission_that_does_not_finish_makes_no_reference():
    with pytest.raises(TrialError, match="seed 3: limit of 2 s"):
        make_reference(WORLD, [3], limit=2.0, jobs=1)


@pytest.mark.parametrize("bad", [["nowhere"], [WORLD, "--missions", "3"], [WORLD, "--jobs", "0"], []])
def test_bad_calls(bad, capsys):
    assert reference_command.main(bad) == 2
    assert capsys.readouterr().err.startswith("reference: ")


def test_reference_says_what_it_was_made_with():
    reference = make_reference(WORLD, [3], limit=LIMIT, jobs=1)
    assert (reference.world, reference.host, reference.slam) == (WORLD, VIRTUAL_TIME, "ours")
    assert reference.code == map_reference.code_version() and list(reference.free_cells) == [3]
    assert json.dumps(reference.resolution) == "0.05"
