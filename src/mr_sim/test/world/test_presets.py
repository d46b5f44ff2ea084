"""Presets: those that come with the package are what the worlds' models say, and a bad one gives one clear message."""

import copy
from dataclasses import replace

import pytest
import yaml

from mr_robot.platforms.platform import Footprint, Frames, Mount, PlatformError, Topics
from mr_robot.platforms.preset import (
    TEMPLATE,
    WORDS,
    find_platform,
    load_platform,
    platform_folders,
    platform_from,
    text_of,
)
from mr_sim.simulated_platform import platform_of
from mr_sim.world_model import load_world
from mr_sim.worlds import find_world

GOOD = {
    "footprint": {"length": 0.44, "width": 0.38},
    "sensor": {"range_min": 0.0, "range_max": 8.0, "field_of_view": 4.71, "noise": 0.01},
    "drive": {
        "max_linear_velocity": 0.5, "max_angular_velocity": 1.57,
        "linear_acceleration": 1.0, "angular_acceleration": 3.14,
    },
    "frames": {"base": "base_footprint", "odom": "odom"},
    "topics": {"scan": "base_scan", "odometry": "odom", "velocity": "cmd_vel"},
}  # fmt: skip
NOTHING = object()


def changed(word, value):
    """GOOD with another value of a word, or without it."""
    given = copy.deepcopy(GOOD)
    *sections, name = word.split("/")
    values = given[sections[0]] if sections else given
    if value is NOTHING:
        del values[name]
    else:
        values[name] = value
    return given


@pytest.mark.parametrize(("preset", "world"), [("pioneer", "office26x15"), ("turtlebot", "office26x15_turtlebots")])
def test_presets_are_what_the_models_of_the_worlds_say(preset, world):
    modelled = {platform_of(robot) for robot in load_world(find_world(world)).robots}
    described = load_platform(preset)
    mount = replace(described.mount, frame=Mount.frame, z=Mount.z)  # the worlds are flat
    assert modelled == {replace(described, frames=Frames(), topics=Topics(), mount=mount)}


@pytest.mark.parametrize(
    ("model", "message"),
    [
        ('name "my robot"', "a name has 1 to 64 letters.* change it in the world file"),
        ('name "mc_robot"', "does not begin with mc_"),
        ("size [ 1000 1 1 ]", "footprint/length must be a number from 0.05 to 3 m, not 1000.0"),
        ("size [ 0 0 0 ]", "no body: give its model a size"),
        ("velocity_bounds [ -50 50 0 0 0 0 -90 90 ]", "drive/max_linear_velocity must be a number from 0.05 to 5 m/s"),
    ],
)
def test_a_simulated_robot_that_the_ros_stack_would_refuse_is_refused_in_every_host(tmp_path, model, message):
    laser = "ranger ( sensor ( range [ 0 8 ] fov 270 samples 271 ) )"
    (tmp_path / "one.world").write_text(f"position ( {model} {laser} )")
    robot = load_world(tmp_path / "one.world").robots[0]
    with pytest.raises(PlatformError, match=message):
        platform_of(robot)


def test_every_preset_of_the_package_loads():
    names = sorted(path.stem for folder in platform_folders() for path in folder.glob("*.yaml"))
    assert {"pioneer", "turtlebot", TEMPLATE} <= set(names)
    for folder in platform_folders():
        for path in folder.glob("*.yaml"):
            load_platform(str(path))


def test_the_template_explains_every_word():
    text = (platform_folders()[0] / f"{TEMPLATE}.yaml").read_text()
    for section, words in WORDS.items():
        assert f"\n{section}:" in text
        for word in words:
            assert f"{word}:" in text or f"`{word}`" in text, f"{section}/{word}"


@pytest.mark.parametrize(
    ("word", "value", "parts"),
    [
        ("sensor/field_of_view", 270, ["sensor/field_of_view", "0.1 to 6.2832 rad", "270 degrees are 4.71 rad"]),
        ("sensor/range_max", NOTHING, ["sensor/range_max is missing", "template.yaml"]),
        ("sensor/range_max", "far", ["sensor/range_max", "must be a number", "'far'"]),
        ("sensor/range_max", float("nan"), ["sensor/range_max", "nan"]),
        ("sensor/noise", True, ["sensor/noise", "True"]),
        ("footprint/length", 440, ["footprint/length", "440 mm are 0.44 m"]),
        ("footprint/length", NOTHING, ["either length and width, or diameter"]),
        ("footprint/diameter", 0.4, ["either length and width, or diameter"]),
        ("footprint/radius", 0.1, ["footprint/radius must be from half the longer side, 0.22 m", "not 0.1"]),
        ("drive/max_linear_velocity", -0.5, ["drive/max_linear_velocity", "0.05 to 5 m/s"]),
        ("drive/speed", 0.5, ["drive/speed is unknown", "max_linear_velocity"]),
        ("frames/base", "", ["frames/base must be a name, such as base_footprint"]),
        ("topics/scan", 5, ["topics/scan must be a name, such as base_scan"]),
        ("drive", NOTHING, ["drive is missing"]),
        ("drive", [1.0], ["drive must hold max_linear_velocity", "[1.0]"]),
        ("wheels", {}, ["wheels is unknown", "footprint, sensor, drive"]),
        ("mount", {"x": 50}, ["mount/x must be a number from -3 to 3 m", "50 mm are 0.05 m"]),
        ("mount", {"roll": 0.1}, ["mount/roll is unknown"]),
    ],
)
def test_a_bad_preset_gives_one_message(word, value, parts):
    with pytest.raises(PlatformError) as error:
        platform_from(changed(word, value))
    text = str(error.value)
    assert "\n" not in text and all(part in text for part in parts), text


def test_a_sensor_sees_farther_than_it_is_blind():
    given = changed("sensor/range_min", 1.5)
    given["sensor"]["range_max"] = 1.2
    with pytest.raises(PlatformError, match=r"sensor/range_min must be less than sensor/range_max, 1\.2 m"):
        platform_from(given)


@pytest.mark.parametrize("text", ["", "[1, 2]", "footprint: {length", "\xff"])
def test_a_file_that_is_no_preset_is_named(tmp_path, text):
    path = tmp_path / "mine.yaml"
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(PlatformError) as error:
        load_platform(str(path))
    assert str(path) in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("name", ["tank", TEMPLATE, ""])
def test_an_unknown_robot_is_told_which_there_are(name):
    with pytest.raises(PlatformError, match=r"there are pioneer, turtlebot; or give the path of a preset file"):
        find_platform(name)
    with pytest.raises(PlatformError, match="no such file"):
        find_platform("nowhere/mine.yaml")


@pytest.mark.parametrize("footprint", [Footprint.box(0.44, 0.38), Footprint.disc(0.354), Footprint(0.5, 0.4, 0.28)])
def test_what_is_written_is_what_is_read(footprint):
    platform = replace(platform_from(GOOD), footprint=footprint)
    assert platform_from(yaml.safe_load(text_of(platform))) == platform
