"""What follows from the description of a robot for the parameters of the nodes."""

import math
import re
import subprocess
from dataclasses import MISSING, fields, replace
from pathlib import Path

import pytest
import yaml

from mr_robot.navigation.options import NavigationOptions
from mr_robot.platforms import files
from mr_robot.platforms.alternatives import check_alternative
from mr_robot.platforms.engines import defaults_of
from mr_robot.platforms.files import main, parameters_of
from mr_robot.platforms.parameters import explorer_parameters, merger_parameters, navigation_parameters, slam_parameters
from mr_robot.platforms.platform import Footprint, PlatformError
from mr_robot.platforms.preset import load_platform
from mr_robot.platforms.ros_stack import (
    gmapping_parameters,
    hector_parameters,
    move_base_parameters,
    slam_toolbox_parameters,
)
from mr_robot.slam.engine import SlamOptions

PIONEER, TURTLEBOT = load_platform("pioneer"), load_platform("turtlebot")
DOCUMENTATION = (Path(__file__).parents[1] / "docs/slam_and_navigation.md").read_text()


def of_engine(options, parameters):
    return options(**{field.name: parameters[field.name] for field in fields(options) if field.name in parameters})


@pytest.mark.parametrize("options", [SlamOptions, NavigationOptions])
def test_a_node_that_is_told_nothing_drives_a_pioneer(options):
    parameters = {**slam_parameters(PIONEER, (PIONEER,)), **navigation_parameters(PIONEER, (PIONEER,))}
    told = {field.name for field in fields(options) if field.default is MISSING}
    defaults = defaults_of(options)
    assert {name: defaults[name] for name in told} == {name: parameters[name] for name in told}
    assert options(**defaults) == options(**{name: defaults[name] for name in told})


@pytest.mark.parametrize("options", [SlamOptions, NavigationOptions])
def test_the_documentation_has_the_defaults_of_the_nodes(options):
    documented = {}
    for names, values in re.findall(r"^\| ((?:`~\w+`(?:, )?)+) \| ([^|]+) \|", DOCUMENTATION, re.M):
        documented.update(zip(re.findall(r"\w+", names), values.split(", ")))
    shown = {name: yaml.safe_load(value.strip()) for name, value in documented.items()}
    assert {name: shown[name] for name in defaults_of(options)} == defaults_of(options)


def test_parameters_of_a_pioneer():
    parameters = parameters_of(PIONEER, ())
    assert parameters["explorer"] == {
        "base_link": "base_footprint", "inflation_radius": 0.25, "largest_robot_radius": 0.29, "field_of_view": 4.71,
        "view_distance": 1.5,
    }  # fmt: skip
    assert parameters["map_merger"] == {
        "scan_topic": "base_scan", "position_local_robot_topic": "odom", "body_radius": 0.2,
        "largest_robot_radius": 0.29,
    }  # fmt: skip


def test_parameters_of_a_turtlebot():
    parameters = parameters_of(TURTLEBOT, ())
    assert parameters["explorer"]["field_of_view"] == 0.99 and parameters["explorer"]["inflation_radius"] == 0.237
    assert parameters["move_base"]["yaw_goal_tolerance"] == 0.25
    assert parameters["move_base"]["velocity_topic"] == "cmd_vel_mux/input/navi"
    assert parameters["move_base"]["footprint_length"] == 0.354 and parameters["move_base"]["footprint_radius"] == 0.177
    assert parameters["slam"]["free_radius"] == 0.157 and parameters["slam"]["surface_deviation"] == 0.022
    assert {parameters[node]["scan_topic"] for node in ("slam", "move_base", "map_merger")} == {"scan"}


def test_the_largest_robot_of_the_team_counts_wherever_others_are_looked_at():
    mixed, alone = parameters_of(TURTLEBOT, (PIONEER, TURTLEBOT)), parameters_of(TURTLEBOT, ())
    assert {mixed[node]["largest_robot_radius"] for node in ("explorer", "move_base", "map_merger")} == {0.29}
    assert {alone[node]["largest_robot_radius"] for node in ("explorer", "move_base", "map_merger")} == {0.18}
    assert (mixed["slam"]["small_object_size"], alone["slam"]["small_object_size"]) == (0.7, 0.48)
    same = [name for name in mixed["move_base"] if mixed["move_base"][name] == alone["move_base"][name]]
    assert set(mixed["move_base"]) - set(same) == {"largest_robot_radius"}


@pytest.mark.parametrize(("range_max", "free"), [(8.0, 8.0), (100.0, defaults_of(SlamOptions)["free_range"])])
def test_a_beam_frees_no_more_than_the_sensor_sees_nor_than_slam_takes(range_max, free):
    robot = replace(PIONEER, sensor=replace(PIONEER.sensor, range_max=range_max))
    assert slam_parameters(robot, (robot,))["free_range"] == free


def test_a_short_sighted_robot_looks_from_nearer():
    near = replace(PIONEER, sensor=replace(PIONEER.sensor, range_max=2.0))
    assert explorer_parameters(near, (near,))["view_distance"] == 1.0


@pytest.mark.parametrize("footprint", [Footprint.box(0.1, 0.06), Footprint.box(1.4, 1.0), Footprint.disc(3.0)])
def test_engines_take_what_follows_from_any_robot(footprint):
    robot = replace(PIONEER, footprint=footprint)
    of_engine(SlamOptions, slam_parameters(robot, (robot,)))
    options = of_engine(NavigationOptions, navigation_parameters(robot, (robot,)))
    assert options.inflation_radius > options.inscribed_radius
    assert merger_parameters(robot, (robot, PIONEER))["body_radius"] >= 0.04


def test_parameters_for_nodes_of_other_packages():
    assert gmapping_parameters(TURTLEBOT) == {
        "base_frame": "base_footprint", "odom_frame": "odom", "maxUrange": 3.9, "maxRange": 4.0,
    }  # fmt: skip
    assert slam_toolbox_parameters(TURTLEBOT) == {
        "base_frame": "base_footprint", "odom_frame": "odom", "scan_topic": "scan", "max_laser_range": 4.0,
    }  # fmt: skip
    assert hector_parameters(TURTLEBOT)["laser_min_dist"] == 0.45
    given = move_base_parameters(TURTLEBOT, (TURTLEBOT,))
    corners = given["local_costmap"]["footprint"]
    assert all(0.177 <= math.hypot(x, y) <= 0.181 and max(abs(x), abs(y)) <= 0.177 for x, y in corners)
    assert len(move_base_parameters(PIONEER, (PIONEER,))["local_costmap"]["footprint"]) == 4
    assert given["global_costmap"]["obstacle_layer"]["scan"]["topic"] == "scan"
    assert given["TrajectoryPlannerROS"]["yaw_goal_tolerance"] == 0.25


def test_files_hold_what_is_printed(tmp_path, capsys):
    arguments = [
        "--robot",
        "turtlebot",
        "--team",
        "pioneer, turtlebot",
        "--base-frame",
        "base_link",
        "--simulated",
        "true",
    ]
    assert main([*arguments, "--velocity-topic", "drive", "--out", str(tmp_path / "new")]) == 0
    printed = yaml.safe_load(capsys.readouterr().out)
    robot = printed.pop("robot")
    assert robot["topics"] == {"scan": "base_scan", "odometry": "odom", "velocity": "drive"}
    assert robot["frames"]["base"] == printed["slam"]["base_frame"] == printed["explorer"]["base_link"] == "base_link"
    assert {path.stem: yaml.safe_load(path.read_text()) for path in (tmp_path / "new").iterdir()} == printed


def test_frames_below_a_prefix(capsys):
    assert main(["--robot", "pioneer", "--prefix", "/robot_3"]) == 0
    printed = yaml.safe_load(capsys.readouterr().out)
    assert (
        printed["slam"]["odom_frame"] == "robot_3/odom" and printed["explorer"]["base_link"] == "robot_3/base_footprint"
    )


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        ([], "--robot pioneer"),
        (["--robot", "tank"], "no robot 'tank'"),
        (["--robot", "pioneer", "--team", "pioneer,tank"], "no robot 'tank'"),
        (["--colour", "red"], "--help"),
        (["--robot", "turtlebot", "--slam", "gmapping"], "add the argument scan_topic:=scan"),
        (["--robot", "turtlebot", "--navigation", "move_base"], "velocity_topic:=cmd_vel_mux/input/navi"),
        (["--robot", "pioneer", "--out", "/dev/null/x"], "/dev/null"),
    ],
)
def test_a_bad_call_gives_one_line(arguments, part, capsys):
    assert main(arguments) == 2
    text = capsys.readouterr().err
    assert part in text and text.count("\n") == 1 and text.startswith("robot_parameters: ")


def test_packages_of_others_have_to_be_installed():
    check_alternative("slam", "hector", {"hector_mapping": "/x"}.get)
    check_alternative("slam", "none", {}.get)
    with pytest.raises(PlatformError, match="navigation:=move_base needs the package move_base, which is not"):
        check_alternative("navigation", "move_base", {}.get)
    with pytest.raises(PlatformError, match=r"slam:=karto is unknown; there are ours, gmapping, .*, none"):
        check_alternative("slam", "karto", {}.get)


def test_launch_files_of_ones_own_have_to_be_there(tmp_path, capsys):
    own = tmp_path / "own.launch"
    own.touch()
    check_alternative("slam", str(own), {}.get)
    with pytest.raises(PlatformError, match=r"navigation:=/x\.launch: there is no such file"):
        check_alternative("navigation", "/x.launch", {}.get)
    assert main(["--robot", "turtlebot", "--slam", str(own)]) == 2, "it would listen to another topic"
    assert f"{own} does not read the topic 'scan' of the preset" in capsys.readouterr().err
    assert main(["--robot", "turtlebot", "--slam", str(own), "--scan-topic", "scan"]) == 0


def test_topics_that_are_renamed_by_the_launch_file_are_accepted(monkeypatch):
    monkeypatch.setattr(files, "find_package", lambda name: "/x")
    assert main(["--robot", "turtlebot", "--slam", "gmapping", "--scan-topic", "scan"]) == 0


def test_the_program_runs():
    result = subprocess.run(
        ["rosrun", "mr_robot", "robot_parameters", "--robot", "pioneer"], capture_output=True, check=False
    )
    assert result.returncode == 0 and set(yaml.safe_load(result.stdout)) == {"robot", *parameters_of(PIONEER, ())}


@pytest.mark.parametrize("options", [SlamOptions, NavigationOptions])
def test_the_documentation_has_every_parameter(options):
    named = set(re.findall(r"`~([a-z_]+)`", DOCUMENTATION))
    assert {field.name for field in fields(options)} <= named
