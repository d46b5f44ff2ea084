"""The command lines of a mission, as values."""

import json
import re
from dataclasses import replace

import pytest
import yaml
from test_launch_files import arguments_without_default, parameters_of

from mr_grid import Pose
from mr_launch import isolation
from mr_launch.arguments import parse_arguments
from mr_launch.begun import asked_settings
from mr_launch.errors import UserError
from mr_launch.plan import (
    Plan,
    RobotPlan,
    Walls,
    base_position,
    key_command,
    launch_command,
    link_commands,
    radio_command,
    robot_environment,
    world_command,
)
from mr_launch.world import find_world, presets_of

ROBOTS = [
    RobotPlan("robot_0", 0, 11311, Pose(1.0, 2.0, 0.5)),
    RobotPlan("a_robot_with_a_long_name", 1, 11311, Pose(1.0, 3.0, 0.0)),
]
PROGRAMS = {"radio": "/bin/radio", "team_key": "/bin/team_key", "world": "/bin/world", "roslaunch": "/bin/roslaunch"}


def plan(kind=isolation.NAMESPACES, *arguments):
    options = parse_arguments(["--out", "/o", *arguments])
    return Plan(options, "/w.world", ROBOTS, "/o", kind, PROGRAMS, "/private")


def launch_arguments(command):
    return dict(word.split(":=", 1) for word in command if ":=" in word)


def test_plan_survives_its_way_to_the_inner_process():
    original = plan(isolation.HUB, "--loss", "0.2", "--no-bag")
    assert Plan.from_json(original.to_json()) == original


def test_radio_gets_one_interface_per_robot():
    command = radio_command(plan(isolation.NAMESPACES, "--range", "7", "--loss", "0.25", "--seed", "4"))
    assert command[:5] == ["/bin/radio", "--interface", "robot_0=air0", "--interface", "a_robot_with_a_long_name=air1"]
    assert command[5:] == [
        "--range",
        "7",
        "--loss",
        "0.25",
        "--seed",
        "4",
        "--rtf",
        "1",
        "--control",
        "/private/radio",
        "--statistics",
        "/o/radio.json",
    ]


def test_radio_as_hub():
    assert radio_command(plan(isolation.HUB))[:3] == ["/bin/radio", "--hub", "/private/hub"]


@pytest.mark.parametrize(("rtf", "of_radio"), [("0.5", "0.5"), ("8", "8"), ("0", "1"), ("0.0001", "0.001")])
def test_radio_runs_at_the_speed_of_the_world(rtf, of_radio):
    command = radio_command(plan(isolation.NAMESPACES, "--rtf", rtf))
    assert command[command.index("--rtf") + 1] == of_radio


def test_radio_knows_the_walls_only_when_asked_to():
    assert not any(word.startswith("--wall") for word in radio_command(plan()))
    walled = plan(isolation.NAMESPACES, "--wall-attenuation", "12.5")
    command = radio_command(walled, Walls("/private/walls.pgm", 0.02, (-1.0, 2.5)))
    given = {word: command[command.index(word) + 1] for word in command if word.startswith("--wall")}
    assert given == {
        "--walls": "/private/walls.pgm",
        "--walls-resolution": "0.020000",
        "--walls-origin": "-1.000000,2.500000",
        "--wall-attenuation": "12.5",
    }


def test_interface_names_fit_the_kernel():
    for robot in [*ROBOTS, RobotPlan("r", 99, 1, Pose(0.0, 0.0, 0.0))]:
        assert len(robot.air) <= 15


def test_world_waits_for_the_whole_team_and_tells_the_radio():
    command = world_command(plan(isolation.NAMESPACES, "--rtf", "0"))
    assert command[command.index("--robots") + 1] == "2"
    assert command[command.index("--rtf") + 1] == "0"
    assert command[command.index("--radio-control") + 1] == "/private/radio"


def test_world_is_told_the_model_of_odometry():
    command = world_command(plan(isolation.NAMESPACES, "--odometry", "random_walk"))
    assert command[command.index("--odometry") + 1] == "random_walk"


def test_cable_ends_in_the_holders_namespace():
    first, *rest = link_commands(ROBOTS[0], 77)
    assert first == ["ip", "link", "add", "air0", "type", "veth", "peer", "name", "radio0", "netns", "77"]
    assert ["nsenter", "--target", "77", "--net", "--", "ip", "link", "set", "radio0", "up"] in rest
    assert ["ip", "link", "set", "air0", "up"] in rest


@pytest.mark.parametrize(("kind", "interface"), [(isolation.NAMESPACES, "radio0"), (isolation.HUB, "hub:/private/hub")])
def test_robot_gets_its_interface(kind, interface):
    arguments = launch_arguments(launch_command(plan(kind), ROBOTS[0]))
    assert arguments["interface"] == interface
    assert arguments["autostart"] == "false"
    assert key_command(plan(kind)) == ["/bin/team_key", "create", arguments["key_file"]]
    assert arguments["key_file"] == "/o/team.key"
    assert arguments["bag"] == "/o/robot_0/robot_0.bag"


def test_an_open_team_has_no_key():
    assert launch_arguments(launch_command(plan(isolation.HUB, "--open"), ROBOTS[0]))["key_file"] == ""


@pytest.mark.parametrize("words", [(), ("--open",), ("--no-bag",), ("--open", "--no-bag", "--respawn", "--page")])
def test_the_launch_files_are_given_what_they_have_no_default_for(words):
    """roslaunch passes over empty arguments: a team with open frames ended before it began."""
    of_base = centralized(isolation.HUB, *words)
    for command in (
        launch_command(plan(isolation.HUB, *words), ROBOTS[0]),
        launch_command(of_base, ROBOTS[0]),
        launch_command(of_base, CENTRALIZED),
    ):
        file = next(word for word in command if word.endswith(".launch"))
        given = {name for name, value in launch_arguments(command).items() if value}
        assert arguments_without_default(file) - given == set(), file


def test_robot_is_told_the_topic_of_the_laser_by_which_it_finds_its_way(tmp_path):
    world = tmp_path / "w.world"
    sonars, laser = "ranger ( scount 2 )", "ranger ( sensor ( samples 181 ) )"
    world.write_text(f'position ( name "a" {laser} ) position ( name "b" pose [ 2 0 0 0 ] {sonars} {laser} )')
    kinds, presets = presets_of(str(world), ["a", "b"])
    scans = {name: yaml.safe_load(presets[kinds[name]])["topics"]["scan"] for name in kinds}
    assert scans == {"a": "base_scan", "b": "base_scan_1"}
    robots = [RobotPlan(name, index, 11311, Pose(0.0, 0.0, 0.0), kinds[name]) for index, name in enumerate(kinds)]
    team = replace(plan(isolation.HUB), robots=robots, presets=presets)
    told = [launch_arguments(launch_command(team, robot))["scan_topic"] for robot in robots]
    assert told == ["base_scan", "base_scan_1"]
    assert launch_arguments(launch_command(plan(isolation.HUB), ROBOTS[0]))["scan_topic"] == ""


@pytest.mark.parametrize(("rangers", "number"), [(1, ""), (2, "_1")])
def test_all_nodes_listen_to_the_ranger_that_the_world_publishes(tmp_path, rangers, number):
    """Once robots with several rangers listened to base_scan, which nobody publishes then."""
    world = tmp_path / "w.world"
    sonars = "ranger ( scount 2 ) " if rangers == 2 else ""
    world.write_text(f'position ( name "a" {sonars}ranger ( sensor ( samples 181 ) ) )')
    kinds, presets = presets_of(str(world), ["a"])
    preset = tmp_path / "a.yaml"
    preset.write_text(presets[kinds["a"]])
    arguments = (f"robot:={preset}", f"robot_parameters:={tmp_path}", "bag:=/x")
    parameters = parameters_of("team_robot.launch", *arguments)
    assert {parameters[f"/{node}/scan_topic"] for node in ("slam", "move_base", "map_merger", "bag")} == {
        f"base_scan{number}"
    }
    description = yaml.safe_load(parameters["/description"])
    assert description["robot"]["mount"]["frame"] == f"base_laser_link{number}"


def test_start_poses_are_told_only_when_asked_for():
    assert launch_arguments(launch_command(plan(), ROBOTS[0]))["initial_poses"] == "{}"
    told = launch_arguments(launch_command(plan(isolation.NAMESPACES, "--initial-poses"), ROBOTS[0]))["initial_poses"]
    assert json.loads(told) == {"robot_0": [1.0, 2.0, 0.5], "a_robot_with_a_long_name": [1.0, 3.0, 0.0]}


def test_limits_reach_the_explorer_and_the_record():
    limited = plan(isolation.NAMESPACES, "--time-limit", "90", "--distance-limit", "40.5")
    given = launch_arguments(launch_command(limited, ROBOTS[0]))
    words = [f"{name}:={given[name]}" for name in ("time_limit", "distance_limit")]
    parameters = parameters_of("team_robot.launch", *words)
    assert [parameters[f"/explorer/{name}"] for name in ("time_limit", "distance_limit")] == [90.0, 40.5]
    settings = asked_settings(limited)
    assert (settings["time_limit"], settings["distance_limit"]) == (90.0, 40.5)
    old = json.loads(limited.to_json())
    del old["options"]["time_limit"], old["options"]["distance_limit"]
    assert Plan.from_json(json.dumps(old)).options.time_limit == 0.0, "recordings of before"


def test_every_robot_has_its_own_master_and_logs():
    robots = [RobotPlan("a", 0, 1001, Pose(0.0, 0.0, 0.0)), RobotPlan("b", 1, 1002, Pose(0.0, 0.0, 0.0))]
    one, two = (robot_environment(plan(isolation.HUB), robot) for robot in robots)
    assert one["ROS_MASTER_URI"] == "http://localhost:1001" != two["ROS_MASTER_URI"]
    assert one["ROS_HOME"] != two["ROS_HOME"] and one["ROS_LOG_DIR"] != two["ROS_LOG_DIR"]


def test_socket_paths_fit_the_kernel():
    for name in ("hub", "radio", "world", "reports"):
        assert len(Plan(plan().options, "", [], "", "", {}, isolation.PRIVATE_MOUNT).socket(name)) < 108


UNSET = ["--unset=ROS_IP", "--unset=ROS_NAMESPACE", "--unset=ROS_ROOT_LOG"]  # of whoever enters
ENV = ["env", "-C", "/here", *UNSET, "A=1", "rostopic", "list"]


def test_entering_a_robot():
    command = isolation.command_inside(isolation.USER_NAMESPACES, 500, 7, {"A": "1"}, "/here", ["rostopic", "list"])
    text = " ".join(command)
    assert re.match(r"nsenter --target 500 --user --preserve-credentials --mount --pid --", text)
    assert text.endswith("nsenter --target 7 --net -- " + " ".join(ENV))
    hub = isolation.command_inside(isolation.HUB, 500, None, {"A": "1"}, "/here", ["rostopic", "list"])
    assert hub == ENV


def test_system_python_comes_first_on_path():
    assert isolation.search_path("/opt/pyenv/bin:/usr/bin").split(":")[:2] == ["/usr/bin", "/bin"]
    assert isolation.search_path("/opt/pyenv/bin:/usr/bin").split(":").count("/usr/bin") == 1


CENTRALIZED = RobotPlan("base", 2, 11311, Pose(1.0, 2.0, 0.5))


def centralized(kind=isolation.NAMESPACES, *arguments):
    options = parse_arguments(["--out", "/o", "--topology", "centralized", *arguments])
    return Plan(options, "/w.world", ROBOTS, "/o", kind, PROGRAMS, "/private", CENTRALIZED)


def test_centralized_plan_survives_its_way_to_the_inner_process():
    assert Plan.from_json(centralized().to_json()) == centralized()


def test_the_base_has_a_radio_and_a_place_but_no_body():
    command = radio_command(centralized())
    assert "base=air2" in command
    assert base_position(CENTRALIZED) == "position base 1.000 2.000\n"
    assert world_command(centralized())[world_command(centralized()).index("--robots") + 1] == "2"


def test_robots_and_base_know_who_merges():
    command = launch_command(centralized(), ROBOTS[1])
    arguments = launch_arguments(command)
    assert (arguments["topology"], arguments["base_station"]) == ("centralized", "base")
    command = launch_command(centralized(isolation.HUB, "--initial-poses"), CENTRALIZED)
    arguments = launch_arguments(command)
    assert "team_base_station.launch" in command
    assert (arguments["name"], arguments["interface"]) == ("base", "hub:/private/hub")
    assert arguments["report_socket"] == "/private/reports"
    assert set(json.loads(arguments["initial_poses"])) == {"robot_0", "a_robot_with_a_long_name"}


def test_without_a_base_robots_merge_for_themselves():
    arguments = launch_arguments(launch_command(plan(), ROBOTS[0]))
    assert (arguments["topology"], arguments["base_station"]) == ("distributed", "")
    assert plan().hosts == ROBOTS


def test_robots_are_told_what_they_and_their_team_are():
    kinds = [replace(robot, preset=preset) for robot, preset in zip(ROBOTS, ("robot_0", "turtlebot"))]
    mixed = replace(plan(), robots=kinds, presets={"robot_0": "topics: {scan: base_scan}"})
    arguments = [launch_arguments(launch_command(mixed, robot)) for robot in kinds]
    assert [each["robot"] for each in arguments] == ["/o/robots/robot_0.yaml", "turtlebot"]
    assert {each["team"] for each in arguments} == {"/o/robots/robot_0.yaml,turtlebot"}
    base = launch_arguments(launch_command(replace(mixed, base=CENTRALIZED), CENTRALIZED))
    assert base["team"] == arguments[0]["team"]


def test_equal_robots_of_a_world_share_a_preset():
    kinds, presets = presets_of(find_world("office26x15_mixed"), ["robot_0", "robot_1", "robot_2"])
    assert kinds == {"robot_0": "robot_0", "robot_1": "robot_1", "robot_2": "robot_0"}
    assert set(presets) == {"robot_0", "robot_1"} and "diameter: 0.354" in presets["robot_1"]


@pytest.mark.parametrize(
    ("sensors", "why"),
    [
        ("", "no laser: add a ranger to its position model"),
        # Its missions began, and died with SLAM's first scan.
        ("ranger ( sensor ( samples 1 ) sensor ( samples 1 ) )", "less than 3 beams, as sonars: add a laser"),
    ],
)
def test_a_robot_that_cannot_explore_is_refused(tmp_path, sensors, why):
    world = tmp_path / "blind.world"
    world.write_text(f'position ( name "blind" pose [ 0 0 0 0 ] {sensors} )\n')
    with pytest.raises(UserError, match=f"blind: .*{why}"):
        presets_of(str(world), ["blind"])
