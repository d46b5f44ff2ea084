"""Parameters: the contract's table, bounds and messages."""

import math

import pytest

from map_merger.options import PARAMETERS, WITHOUT_EFFECT, OptionError, Options, options_of, warnings_of
from map_merger.robot_size import USUAL_SIZE
from mr_grid import Pose

CONTRACT = {
    "robot_prefix": "",
    "local_map_frame_id": "map",
    "local_map_topic": "/map",
    "local_map_metadata_topic": "/map_metadata",
    "map_topic_over_network": "map_other",
    "control_topic": "control",
    "position_local_robot_topic": "slam_out_pose",
    "position_other_robots_topic": "position_other_robots",
    "has_local_map": True,
    "exchange_position": False,
    "splitted": True,
    "seconds_pub_timer": 3,
    "seconds_send_timer": 5,
    "seconds_recompute_transform": 5,
    "seconds_send_position": 2,
    "seconds_meta_timer": 5,
    "max_trans_robots": -1.0,
    "debug": True,
    "log_path": "",
}


def test_tiles_are_as_large_by_default_as_in_the_launch_file_of_the_original():
    """With its code's default of 32 cells the headers of the tiles weighed more than the cells."""
    assert options_of({}, "host").split_size == PARAMETERS["split_size"].default == 2048


def test_defaults_are_those_of_the_contract():
    options = options_of({}, "host")
    for name, value in CONTRACT.items():
        assert getattr(options, name) == value and type(getattr(options, name)) is type(value), name
        assert PARAMETERS[name].default == value, name
    assert options == Options("host", USUAL_SIZE.body_radius, USUAL_SIZE.largest_radius, initial_poses={})


def test_any_heading_is_accepted_unless_a_limit_is_given():
    """The contract's default of 5 degrees would never merge robots that start with different headings."""
    assert options_of({}, "host").max_rotation_robots == -1.0
    assert options_of({"max_rotation_robots": 5}, "host").max_rotation_robots == 5.0


def test_the_table_and_the_fields_agree():
    assert set(PARAMETERS) == set(Options.__dataclass_fields__)


def test_the_robot_name_is_the_host_name_unless_given():
    assert options_of({"robot_name": ""}, "host").robot_name == "host"
    assert options_of({"robot_name": "robot_1"}, "host").robot_name == "robot_1"
    assert options_of({"robot_name": 7}, "host").robot_name == "7"


@pytest.mark.parametrize(
    "name, value",
    [
        ("split_size", 0),
        ("split_size", 2049),
        ("split_size", "32"),
        ("split_size", 1.5),
        ("split_size", True),
        ("seconds_pub_timer", 0),
        ("seconds_send_timer", -1),
        ("seconds_send_position", 0),
        ("seconds_meta_timer", 0),
        ("seconds_recompute_transform", 0),
        ("seconds_recompute_transform", -2),
        ("max_trans_robots", -2.0),
        ("max_trans_robots", math.nan),
        ("max_rotation_robots", -0.5),
        ("max_rotation_robots", math.inf),
        ("has_local_map", 1),
        ("debug", "yes"),
        ("registration", "magic"),
        ("robot_name", "a/b"),
        ("robot_name", "a b"),
        ("map_topic_over_network", ""),
        ("map_topic_over_network", "not a topic"),
        ("map_topic_over_network", "control"),
        ("local_map_topic", "9lives"),
        ("scan_topic", "scan-1"),
        ("local_map_topic", 5),
        ("scan_topic", 1),
        ("local_priority", "always"),
        ("topology", "star"),
        ("base_station", "a/b"),
        ("initial_poses", {"robot_1": [1, 2]}),
        ("initial_poses", {"robot_1": "x"}),
        ("initial_poses", [1]),
        ("run", "7"),
        ("run", "0.000000000"),
        ("run", "4294967296.000000000"),
        ("unheard_of", 1),
    ],
)
def test_bad_values_are_refused_with_their_name(name, value):
    with pytest.raises(OptionError) as caught:
        options_of({name: value}, "host")
    assert name in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "name, value",
    [
        ("seconds_recompute_transform", -1),
        ("max_trans_robots", -1),
        ("max_trans_robots", 40),
        ("max_rotation_robots", 0.0),
        ("split_size", 2048),
    ],
)
def test_special_values_are_accepted(name, value):
    assert getattr(options_of({name: value}, "host"), name) == value


def test_a_run_has_the_name_that_it_is_given():
    assert options_of({"run": "1795866432.024270127"}, "host").boot == (1795866432, 24270127)
    assert options_of({}, "host").boot is None


def test_initial_poses_are_metres_and_radians():
    options = options_of({"initial_poses": {"robot_0": [1, 2, 0.5]}}, "host")
    assert options.initial_poses == {"robot_0": Pose(1.0, 2.0, 0.5)}


@pytest.mark.parametrize("name", [{"robot_name": "bob"}, {"robot_name": 7}, {}])
def test_start_poses_without_the_robots_own_give_one_warning_with_the_names_there_are(name):
    own = str(name.get("robot_name", "host"))
    poses = {"Host": [0, 0, 0], "Bob": [1, 0, 0], 8: [2, 0, 0]}
    (warning,) = warnings_of({**name, "initial_poses": poses}, "host")
    assert f"initial_poses has no effect: it has no pose of this robot, {own}, but of 8, Bob, Host" in warning
    own_pose = {name.get("robot_name", "host"): [3, 0, 0]}
    assert warnings_of({**name, "initial_poses": {**poses, **own_pose}}, "host") == []
    assert warnings_of({**name, "initial_poses": {}}, "host") == []


def test_a_base_without_a_map_needs_no_start_pose():
    assert warnings_of({"has_local_map": False, "initial_poses": {"bob": [0, 0, 0]}}, "base") == []


def test_a_parameter_without_effect_gives_one_warning_with_the_reason():
    for name, reason in WITHOUT_EFFECT.items():
        (warning,) = warnings_of({name: "x", "split_size": 4}, "host")
        assert name in warning and reason in warning
    assert warnings_of({"split_size": 4}, "host") == []


def test_the_centralized_topology_needs_a_base_and_every_robot_but_the_base_a_map():
    given = {"topology": "centralized", "base_station": "base"}
    robot, base = options_of(given, "robot_0"), options_of({**given, "has_local_map": False}, "base")
    assert (robot.centralized, robot.is_base) == (True, False) and (base.centralized, base.is_base) == (True, True)
    assert options_of({"topology": "centralized", "has_local_map": False}, "base") == base
    assert not options_of({"base_station": "host"}, "host").is_base
    with pytest.raises(OptionError, match="base_station must name the base"):
        options_of({"topology": "centralized"}, "robot_0")
    with pytest.raises(OptionError, match="has_local_map must be true on robot_0"):
        options_of({**given, "has_local_map": False}, "robot_0")


def test_a_base_in_the_distributed_topology_gives_one_warning():
    (warning,) = warnings_of({"base_station": "base"}, "host")
    assert "base_station has no effect: topology is distributed" in warning
    assert warnings_of({"base_station": "base", "topology": "centralized"}, "host") == []
    assert warnings_of({"base_station": ""}, "host") == []
