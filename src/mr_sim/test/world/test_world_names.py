"""One world has one name, however it is given."""

import cv2
import numpy as np
import pytest

from mr_sim.world_names import name_of, told_here
from mr_sim.worlds import find_world

FLAT = 'model ( bitmap "plan.png" size [ 8 8 1 ] )\n'


def flat(folder, name="flat.world"):
    """A world with a picture beside it."""
    folder.mkdir(parents=True, exist_ok=True)
    picture = np.full((20, 20), 255, np.uint8)
    picture[[0, -1]] = picture[:, [0, -1]] = 0
    cv2.imwrite(str(folder / "plan.png"), picture)
    (folder / name).write_text(FLAT)
    return folder / name


def other_plan(folder):
    picture = np.zeros((20, 20), np.uint8)
    picture[5:15, 5:15] = 255
    cv2.imwrite(str(folder / "plan.png"), picture)


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path.resolve()


def test_a_world_of_the_project_has_its_name(here):
    path = find_world("small8x8")
    (here / "linked.world").symlink_to(path)
    given = [
        "small8x8",
        "small8x8.world",
        str(path),
        f"{path.parent}/../{path.parent.name}/{path.name}",
        "linked.world",
    ]
    assert {name_of(world) for world in given} == {"small8x8"}


def test_a_file_has_its_whole_path_from_wherever_it_is_named(here, monkeypatch):
    world = flat(here / "worlds")
    (here / "link.world").symlink_to(world)
    (here / "folder").symlink_to(here / "worlds")
    ways = [
        "worlds/flat.world",
        "./worlds/flat.world",
        "worlds/../worlds/flat.world",
        "link.world",
        "folder/flat.world",
    ]
    assert {name_of(given) for given in [*ways, str(world)]} == {str(world)}
    monkeypatch.chdir(here / "worlds")
    assert {name_of(given) for given in ("flat.world", "./flat.world", "../link.world")} == {str(world)}


def test_a_file_that_is_called_like_a_world_of_the_project_is_another(here):
    assert name_of(str(flat(here, "small8x8.world"))) == str(here / "small8x8.world") == name_of("small8x8.world")


def test_a_link_beside_another_picture_is_another_world(here):
    world = flat(here / "one")
    (here / "two").mkdir()
    other_plan(here / "two")
    (here / "two" / "flat.world").symlink_to(world)
    assert name_of("two/flat.world") == str(here / "two" / "flat.world")


def test_a_map_through_a_link_is_the_map(here):
    flat(here / "one")
    (here / "one" / "map.yaml").write_text("image: plan.png\nresolution: 0.4\norigin: [0, 0, 0]\n")
    (here / "two").mkdir()
    (here / "two" / "map.yaml").symlink_to(here / "one" / "map.yaml")
    other_plan(here / "two")
    assert name_of("two/map.yaml") == str(here / "two" / "map.yaml")
    cv2.imwrite("two/plan.png", cv2.imread("one/plan.png"))
    assert name_of("two/map.yaml") == name_of("one/map.yaml") == str(here / "one" / "map.yaml")


@pytest.mark.parametrize("world", ["generated:office:7", "nowhere.world", "a/b.world", ".", "no such"])
def test_what_is_no_file_stays_as_it_is(here, world):
    assert name_of(world) == world


def test_a_name_is_told_as_one_gives_it_here(here):
    world = str(flat(here / "worlds"))
    assert told_here(world) == "worlds/flat.world"
    assert told_here("small8x8") == "small8x8" and told_here("/somewhere/else.world") == "/somewhere/else.world"
