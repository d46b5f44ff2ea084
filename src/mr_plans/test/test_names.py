"""Names of generated worlds and the files they stand for."""

import re

import cv2
import numpy as np
import pytest

from mr_plans import WorldName, is_generated, parse_name, world_files, world_plan


@pytest.mark.parametrize(
    ("name", "meant", "stem"),
    [
        ("generated:office:7", WorldName("office", 7, (26, 15)), "generated-office-7-26x15"),
        ("generated:hall:3:37.5x22", WorldName("hall", 3, (37.5, 22.0)), "generated-hall-3-37.5x22"),
        ("generated:cave:0:anywhere", WorldName("cave", 0, (26, 18), True), "generated-cave-0-26x18-anywhere"),
        ("generated:loop:1:20x18:anywhere", WorldName("loop", 1, (20, 18), True), "generated-loop-1-20x18-anywhere"),
        (
            "generated:office:7:mixed",
            WorldName("office", 7, (26, 15), False, "mixed"),
            "generated-office-7-26x15-mixed",
        ),
        (
            "generated:cave:0:20x18:anywhere:turtlebots",
            WorldName("cave", 0, (20, 18), True, "turtlebots"),
            "generated-cave-0-20x18-anywhere-turtlebots",
        ),
        (
            "generated:hall:1:anywhere:robots/husky.inc",
            WorldName("hall", 1, (30, 20), True, "robots/husky.inc"),
            "generated-hall-1-30x20-anywhere-husky",
        ),
    ],
)
def test_names_are_read(name, meant, stem):
    assert is_generated(name) and parse_name(name) == meant and meant.stem == stem


@pytest.mark.parametrize(
    "name",
    ["generated:", "generated:office", "generated:office:x", "generated:office:-1", "generated:office:1:30",
     "generated:office:1:3..0x20", "generated:office:1:5x20", "generated:castle:1", "generated:castle:1:30x20",
     "generated:office:1:nowhere", "generated:office:1:30x20:", "generated:office:1:turtles",
     "generated:office:1:mixed:anywhere", "generated:office:1:.inc", "generated:office:1:folder/.inc",
     "generated:office:1:husky.inc:anywhere"],
)  # fmt: skip
def test_bad_names_are_refused(name):
    assert is_generated(name)
    with pytest.raises(ValueError, match=r"generated:KIND:SEED|castle|5 m|size"):
        parse_name(name)


def test_other_worlds_are_not_generated():
    assert not is_generated("office26x15") and not is_generated("generated.world")


def test_files_hold_the_plan_and_sixteen_robots():
    files = world_files(parse_name("generated:rooms:4:20x15"), 0.29)
    picture = cv2.imdecode(np.frombuffer(files.picture, np.uint8), cv2.IMREAD_GRAYSCALE)
    assert np.array_equal(np.flipud(picture) < 128, world_plan("rooms", 4, (20.0, 15.0)).walls)
    assert files.text.count("pioneer (") == 16 and f'bitmap "{files.stem}.png"' in files.text
    assert files == world_files(parse_name("generated:rooms:4:20x15"), 0.29)


@pytest.mark.parametrize(("robots", "pioneers", "turtlebots"), [("turtlebots", 0, 16), ("mixed", 8, 8)])
def test_other_robots_start_at_the_same_places(robots, pioneers, turtlebots):
    usual = world_files(parse_name("generated:rooms:4:20x15"), 0.29)
    files = world_files(parse_name(f"generated:rooms:4:20x15:{robots}"), 0.29)
    assert (files.text.count("pioneer ("), files.text.count("turtlebot (")) == (pioneers, turtlebots)
    assert all(f'include "{model}.inc"' in files.text for model in files.models)
    assert files.text.index('include "pioneer.inc"') < files.text.index("floorplan")  # which that defines
    assert re.findall(r"pose .*", files.text) == re.findall(r"pose .*", usual.text)


def test_a_robot_of_ones_own_starts_where_there_is_room_for_it():
    usual = world_files(parse_name("generated:rooms:4:20x15"), 0.29)
    name = parse_name("generated:rooms:4:20x15:robots/husky.inc")
    small, large = world_files(name, 0.29, "ab12"), world_files(name, 0.9, "cd34")
    assert small.stem == "generated-rooms-4-20x15-husky-ab12" and small.models == ("pioneer", "husky-ab12")
    assert 'include "husky-ab12.inc"' in small.text and small.text.count("\nhusky (") == 16
    assert re.findall(r"pose .*", small.text) == re.findall(r"pose .*", usual.text)
    assert 1 <= large.text.count("\nhusky (") < 16
    with pytest.raises(ValueError, match="1 robot"):
        world_files(name, 4.0)
