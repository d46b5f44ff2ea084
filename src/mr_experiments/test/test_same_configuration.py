"""The ROS host and virtual time give each node of a robot the same configuration."""

import subprocess
from dataclasses import fields, replace

import pytest
import yaml

import explorer.options
import map_merger.options
from mr_experiments.host.mission import Mission
from mr_experiments.trial.trial import Trial
from mr_grid import Pose
from mr_launch.arguments import parse_arguments
from mr_launch.commands import make_output_folder
from mr_launch.plan import Plan, RobotPlan, launch_command
from mr_launch.world import find_world, presets_of
from mr_robot.navigation.options import NavigationOptions
from mr_robot.slam.engine import SlamOptions

WORLDS = {"pioneer": "office26x15", "turtlebot": "office26x15_turtlebots", "mixed": "office26x15_mixed"}
ROBOTS = 2


def plan_of(world, folder):
    """A mission of the team runner up to its first process."""
    names = [f"robot_{index}" for index in range(ROBOTS)]
    kinds, presets = presets_of(find_world(world), names)
    robots = [RobotPlan(name, index, 11311, Pose(0.0, 0.0, 0.0), kinds[name]) for index, name in enumerate(names)]
    options = parse_arguments(["--world", world, "--out", str(folder)])
    plan = Plan(options, world, robots, str(folder), "hub", {"roslaunch": "roslaunch"}, str(folder), presets=presets)
    make_output_folder(plan)
    return plan


def parameters_of(command, folder):
    """Private parameters of each node as roslaunch would set them: {node: {name: value}}."""
    arguments = [word for word in command if word.endswith(".launch") or ":=" in word]
    result = subprocess.run(
        ["roslaunch", "--dump-params", "mr_launch", *arguments, f"robot_parameters:={folder}"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    nodes = {}
    for name, value in yaml.safe_load(result.stdout).items():
        _, node, *words = name.split("/")
        if words:
            nodes.setdefault(node, {})["/".join(words)] = value
    return nodes


@pytest.fixture(scope="module", params=sorted(WORLDS))
def hosts(request, tmp_path_factory):
    """(what roslaunch sets, the robot in virtual time) for each robot of a team."""
    folder = tmp_path_factory.mktemp(request.param)
    plan = plan_of(WORLDS[request.param], folder / "out")
    mission = Mission(Trial(WORLDS[request.param], ROBOTS, 1))
    return [
        (parameters_of(launch_command(plan, robot), folder / robot.name), mission.robots[robot.index])
        for robot in plan.robots
    ]


def of_engine(options, given):
    return options(**{field.name: given[field.name] for field in fields(options) if field.name in given})


def test_slam(hosts):
    for parameters, robot in hosts:
        assert of_engine(SlamOptions, parameters["slam"]) == robot.body.slam.options


def test_navigation(hosts):
    for parameters, robot in hosts:
        assert of_engine(NavigationOptions, parameters["move_base"]) == robot.body.navigator.options


def test_explorer(hosts):
    for parameters, robot in hosts:
        given = dict(parameters["explorer"], log_path="")
        assert explorer.options.load(given, 1, "host") == robot.explorer._options


def test_map_merger(hosts):
    for parameters, robot in hosts:
        given = dict(parameters["map_merger"], log_path="", initial_poses={})
        assert replace(map_merger.options.options_of(given, "host")) == robot.merger._options


def test_robots_of_different_kinds_are_configured_differently(hosts, request):
    views = [parameters["explorer"]["field_of_view"] for parameters, _ in hosts]
    assert (
        views
        == {"pioneer": [4.71] * 2, "turtlebot": [0.99] * 2, "mixed": [4.71, 0.99]}[
            request.node.callspec.params["hosts"]
        ]
    )
