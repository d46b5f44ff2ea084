"""Every launch file and every parameter file loads; robot.launch explains its arguments."""

import functools
import os
import re
import shlex
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
import yaml
from roslaunch.config import ROSLaunchConfig
from roslaunch.xmlloader import XmlLoader, XmlParseException

from mr_launch.nodes import RECORDER, RESPAWNED
from mr_launch.recorder import record_command

PACKAGE = Path(__file__).resolve().parents[1]
EXAMPLES = PACKAGE.parents[1] / "docs" / "examples"
LAUNCH_FILES = sorted((PACKAGE / "launch").glob("*.launch"))
NEEDED = {  # arguments without a default
    "robot.launch": [],
    "recorder.launch": ["output:=--output-name=/x"],
    "replayed_robot.launch": ["robot_name:=robot_0", "bag:=/x", "report_socket:=/x"],
    "robot_under_one_master.launch": ["number:=0", "robots:=2"],
    "simulated_robot.launch": ["robot_name:=robot_0", "world_socket:=/x"],
    "team_base_station.launch": [
        "name:=base",
        "interface:=radio0",
        "team:=pioneer",
        "report_socket:=/x",
    ],
    "team_robot.launch": [
        "robot_name:=robot_0",
        "interface:=radio0",
        "world_socket:=/x",
        "report_socket:=/x",
        "start_pose:=0 0 0",
        "truth_file:=/x",
    ],
}


def roslaunch(option, name, *arguments):
    command = ["roslaunch", option, "mr_launch", name, *NEEDED.get(name, []), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@functools.lru_cache(maxsize=None)
def loaded(name, *arguments):
    """The launch file as roslaunch reads it, without the time that a process of its own takes."""
    config = ROSLaunchConfig()
    path = str(PACKAGE / "launch" / name)
    XmlLoader().load(path, config, argv=[*NEEDED.get(name, []), *arguments], verbose=False)
    return config


def arguments_without_default(name):
    arguments = ElementTree.parse(PACKAGE / "launch" / name).getroot().findall("arg")
    return {argument.get("name") for argument in arguments if not {"default", "value"} & set(argument.keys())}


def nodes_of(name, *arguments):
    return {node.namespace + node.name for node in loaded(name, *arguments).nodes}


def parameters_of(name, *arguments):
    return {key: parameter.value for key, parameter in loaded(name, *arguments).params.items()}


@pytest.mark.parametrize("path", LAUNCH_FILES, ids=lambda path: path.name)
def test_loads(path, capfd):
    assert nodes_of(path.name) and "Exception" not in capfd.readouterr().err


def test_it_is_read_here_as_by_roslaunch():
    told = roslaunch("--nodes", "robot.launch")
    assert (told.returncode, set(told.stdout.split())) == (0, nodes_of("robot.launch")), told.stderr
    told = roslaunch("--dump-params", "robot.launch")
    parameters = yaml.safe_load(told.stdout)
    assert {name: parameters[name] for name in parameters_of("robot.launch")} == parameters_of("robot.launch")


@pytest.mark.parametrize(
    ("arguments", "more"),
    [
        ([], {"/slam", "/move_base"}),
        (["record:=true", "record_path:={tmp}/new/records"], {"/slam", "/move_base", "/bag"}),
        (["slam:=none", "navigation:=none"], set()),
        (["simulated:=true"], {"/slam", "/move_base", "/robot"}),
    ],
)
def test_nodes_of_a_robot(arguments, more, tmp_path):
    arguments = [argument.format(tmp=tmp_path) for argument in arguments]
    nodes = nodes_of("robot.launch", *arguments)
    assert nodes == {"/adhoc_communication", "/map_merger", "/explorer"} | more


@pytest.fixture
def packages(tmp_path, monkeypatch):
    """There are empty packages under the names of those of others."""
    for name in ("gmapping", "slam_toolbox", "hector_mapping", "move_base", "mbf_costmap_nav", "stage_ros"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "package.xml").write_text(
            f"<package><name>{name}</name><version>1.0.0</version><description>x</description>"
            "<maintainer email='a@b.c'>x</maintainer><license>x</license></package>"
        )
    monkeypatch.setenv("ROS_PACKAGE_PATH", os.pathsep.join([str(tmp_path), os.environ["ROS_PACKAGE_PATH"]]))
    monkeypatch.setattr("roslaunch.substitution_args._rospack", None)  # made once for a path
    loaded.cache_clear()
    yield
    loaded.cache_clear()


@pytest.mark.parametrize(
    ("arguments", "nodes", "words"),
    [
        (["slam:=gmapping", "navigation:=move_base"], set(), {"/slam/maxRange": 4.0, "/slam/delta": 0.05}),
        (["slam:=slam_toolbox"], set(), {"/slam/scan_topic": "scan", "/slam/max_laser_range": 4.0}),
        (["slam:=hector"], set(), {"/slam/laser_max_dist": 3.9, "/slam/map_resolution": 0.05}),
        (
            ["navigation:=move_base_flex"], {"/move_base_flex"},
            {
                "/move_base_flex/TrajectoryPlannerROS/max_vel_x": 0.5,
                "/move_base_flex/global_costmap/global_frame": "map",
            },
        ),
    ],
)  # fmt: skip
def test_slam_and_navigation_of_others(arguments, nodes, words, packages):
    others = [*arguments, "robot:=turtlebot", "scan_topic:=scan", "velocity_topic:=mobile_base/commands/velocity"]
    ours = {"/adhoc_communication", "/map_merger", "/explorer", "/slam", "/move_base"}
    assert nodes_of("robot.launch", *others) == ours | nodes
    parameters = parameters_of("robot.launch", *others)
    assert {name: parameters[name] for name in words} == words


def test_slam_and_navigation_of_ones_own(tmp_path):
    """The example of the documentation, and a launch file for navigation."""
    own = tmp_path / "own navigation.launch"
    names = ("map_frame", "velocity_topic", "robot_name", "robot_parameters")
    own.write_text(
        "<launch>" + "".join(f"<arg name='{name}'/><param name='{name}' value='$(arg {name})'/>" for name in names)
        + "</launch>"
    )  # fmt: skip
    arguments = (
        "robot_name:=anna", "scan_topic:=laser", "velocity_topic:=drive", "robot_parameters:=/tmp/own",
        f"slam:={EXAMPLES / 'my_slam.launch'}", f"navigation:={own}",
    )  # fmt: skip
    assert nodes_of("robot.launch", *arguments) == {"/adhoc_communication", "/map_merger", "/explorer", "/slam"}
    parameters = parameters_of("robot.launch", *arguments)
    assert [parameters[f"/{name}"] for name in names] == ["map", "drive", "anna", "/tmp/own/move_base.yaml"]
    told = {
        name: parameters[f"/slam/{name}"] for name in ("map_frame", "scan_topic", "base_frame", "map_update_interval")
    }
    assert told == {
        "map_frame": "map",
        "scan_topic": "laser",
        "base_frame": "base_footprint",
        "map_update_interval": 1.0,
    }


@pytest.mark.parametrize("name", ["robot.launch", "base_station.launch"])
def test_a_link_of_ones_own_takes_the_place_of_the_interface(name, tmp_path):
    arguments = (*(("robot_parameters:=" + str(tmp_path),) if name == "robot.launch" else ()), "interface:=tun0")
    assert parameters_of(name, *arguments)["/adhoc_communication/interface"] == "tun0"
    config = loaded(name, *arguments, "link:=/links/udp.py:UdpLink")
    (node,) = [node for node in config.nodes if node.name == "link"]
    hub = config.params["/adhoc_communication/interface"].value
    assert hub.startswith("hub:/") and node.respawn
    assert node.args == f"--link '/links/udp.py:UdpLink' --interface 'tun0' --hub '{hub[4:]}'"


def test_a_base_station_has_no_body():
    nodes = nodes_of("robot.launch", "has_local_map:=false")
    assert nodes == {"/adhoc_communication", "/map_merger", "/mission_control"}
    parameters = parameters_of("robot.launch", "has_local_map:=false")
    assert parameters["/map_merger/has_local_map"] is False and parameters["/map_merger/topology"] == "distributed"


def test_a_person_can_take_over():
    assert "/velocity_override" not in nodes_of("robot.launch")
    parameters = parameters_of("robot.launch", "robot:=turtlebot", "teleop:=true")
    assert parameters["/move_base/velocity_topic"] == "navigation/cmd_vel"
    assert parameters["/velocity_override/velocity_topic"] == "cmd_vel_mux/input/navi"
    parameters = parameters_of("robot.launch", "teleop:=true", "velocity_topic:=drive")
    assert parameters["/velocity_override/velocity_topic"] == "drive"


@pytest.mark.parametrize(
    ("robot", "frame", "shape"),
    [("pioneer", "base_laser_link", "box"), ("turtlebot", "camera_depth_frame", "cylinder")],
)
def test_the_description_connects_the_base_with_the_sensor(robot, frame, shape):
    arguments = (f"robot:={robot}", "description:=true")
    assert "/robot_state_publisher" in nodes_of("robot.launch", *arguments)
    assert "/robot_state_publisher" not in nodes_of("robot.launch", *arguments, "simulated:=true")
    urdf = ElementTree.fromstring(parameters_of("robot.launch", *arguments)["/robot_description"])
    joints = {each.find("child").get("link"): each.find("parent").get("link") for each in urdf.findall("joint")}
    assert joints == {"base_link": "base_footprint", frame: "base_link"}
    assert urdf.find(f"link[@name='base_link']/visual/geometry/{shape}") is not None


def test_every_node_that_has_a_log_path_is_told_it():
    """The radio, the merger and the explorer; no other one writes files of its own but what roslaunch keeps."""
    for name in ("robot.launch", "base_station.launch"):
        parameters = parameters_of(name, "log_path:=/logs", "record:=true")
        told = {key for key, value in parameters.items() if value == "/logs"}
        assert told >= {"/adhoc_communication/log_path", "/map_merger/log_path"}, name
        assert ("/explorer/log_path" in told) == (name == "robot.launch")
        assert len(told) == 2 + (name == "robot.launch"), name
        capture = Path(parameters["/adhoc_communication/capture_file"])
        assert capture.name.startswith("radio_") and capture.suffix == ".pcap"


def test_no_other_package_of_nodes_has_a_log_path():
    packages = ("adhoc_communication", "map_merger", "explorer", "mr_robot", "mr_sim", "mr_page")
    found = set()
    for name in packages:
        files = [file for place in ("src", "nodes") for file in (PACKAGE.parent / name / place).rglob("*")]
        texts = (file.read_bytes() for file in files if file.is_file() and file.suffix in (".py", ".cpp", ""))
        found |= {name for text in texts if b"log_path" in text}
    assert found == {"adhoc_communication", "map_merger", "explorer"}


@pytest.mark.parametrize("count", [2, 5])
def test_robots_under_one_master_have_their_own_names_and_frames(count):
    name = f"simulation_{count}.launch"
    nodes = nodes_of(name, "p_tx:=1")
    assert len(nodes) == 1 + 5 * count and "/stageros" in nodes
    parameters = parameters_of(name, "p_tx:=1")
    assert parameters["/stageros/robots"] == count
    for number in range(count):
        robot = f"robot_{number}"
        words = {
            "adhoc_communication": {
                "simulation_mode": True,
                "robots_in_simulation": count,
                "robot_name": robot,
                "p_tx": 1,
            },
            "map_merger": {"robot_prefix": f"/{robot}", "local_map_frame_id": f"{robot}/map"},
            "explorer": {"move_base_frame": f"/{robot}/map", "base_link": f"{robot}/base_footprint"},
            "slam": {
                "map_frame": f"{robot}/map",
                "odom_frame": f"{robot}/odom",
                "base_frame": f"{robot}/base_footprint",
            },
            "move_base": {"map_frame": f"{robot}/map", "robot_name": robot},
        }
        for node, values in words.items():
            assert {key: parameters[f"/{robot}/{node}/{key}"] for key in values} == values


def test_robots_under_one_master_are_called_by_their_number_whatever_the_world_calls_them(tmp_path):
    """In a world with anna and bob two robots waited for ever; a folder with a blank was two arguments."""
    world = tmp_path / "my worlds" / "w.world"
    world.parent.mkdir()
    world.write_text(
        "".join(f'position ( name "{name}" ranger ( sensor ( samples 9 ) ) )\n' for name in ("anna", "bob"))
    )
    given = (f"world:={world}", "robot:=turtlebot")
    config = loaded("simulation_2.launch", *given)
    (stage,) = (node for node in config.nodes if node.name == "stageros")
    assert shlex.split(stage.args) == ["-g", str(world)]
    parameters = {key: parameter.value for key, parameter in config.params.items()}
    assert {parameters[f"/robot_{number}/explorer/field_of_view"] for number in range(2)} == {0.99}


def test_the_name_of_a_played_robot_may_be_a_number():
    assert parameters_of("replayed_robot.launch", "robot_name:=7", "map_merger:=true")["/map_merger/robot_name"] == "7"


def test_the_bag_holds_the_topics_of_the_robots_own_drivers(tmp_path):
    arguments = ("robot:=turtlebot", "odometry_topic:=wheels", "record:=true", f"record_path:={tmp_path}")
    given = parameters_of("robot.launch", *arguments)
    given = {key.split("/")[-1]: value for key, value in given.items() if key.startswith("/bag/")}
    command = record_command("/record", given, ["__name:=bag"])
    assert command[0] == "/record" and command[-1] == "__name:=bag" and f"--output-prefix={tmp_path}/topics" in command
    assert {"scan", "wheels", "cmd_vel_mux/input/navi", "/tf_static", "map", "auction"} <= set(command)
    assert {"base_scan", "odom", "cmd_vel"} & set(command) == set()
    assert "base_scan" in record_command("/record", {"output": "--output-name=/x"}, [])


@pytest.mark.parametrize("path", ["records", "~/records"])
def test_a_relative_folder_for_records_is_refused(path, tmp_path, monkeypatch, capfd):
    """Once roslaunch made it where it was called, the recorder looked for it elsewhere and found the disk full."""
    monkeypatch.chdir(tmp_path)
    told = refused(capfd, "robot.launch", "record:=true", f"record_path:={path}")
    assert f"record_path:={path} has to begin with /" in told and not list(tmp_path.iterdir())


def test_nodes_are_started_again():
    everything = ("simulated:=true", "mission_control:=true", "teleop:=true")
    again = {node.name for node in loaded("robot.launch", *everything).nodes if node.respawn}
    assert again == set(RESPAWNED) and "slam" in again
    assert not any(node.respawn for node in loaded("robot.launch", "respawn:=false").nodes)


def test_a_recorder_that_died_is_started_again_where_it_makes_a_new_bag(tmp_path):
    def recorder(name, *arguments):
        config = loaded(name, *arguments)
        (node,) = (node for node in config.nodes if node.name == RECORDER)
        assert config.params["/bag/respawn"].value is node.respawn
        return node.respawn

    recorded = ("record:=true", f"record_path:={tmp_path}")
    assert recorder("robot.launch", *recorded) and not recorder("robot.launch", *recorded, "respawn:=false")
    assert not recorder("team_robot.launch", "bag:=/tmp/x.bag", "respawn:=true"), "it would begin the same file anew"


def test_a_turtlebot_is_configured_as_one():
    parameters = parameters_of("robot.launch", "robot:=turtlebot")
    assert parameters["/explorer/field_of_view"] == 0.99 and parameters["/move_base/yaw_goal_tolerance"] == 0.25
    assert parameters["/move_base/velocity_topic"] == "cmd_vel_mux/input/navi"
    assert parameters["/map_merger/largest_robot_radius"] == 0.18
    team = parameters_of("robot.launch", "robot:=turtlebot", "team:=pioneer,turtlebot")
    assert team["/map_merger/largest_robot_radius"] == team["/explorer/largest_robot_radius"] == 0.29


def test_arguments_go_before_the_preset():
    words = {
        "base_frame": "base", "odom_frame": "wheels", "scan_topic": "laser", "odometry_topic": "ways",
        "velocity_topic": "drive",
    }  # fmt: skip
    parameters = parameters_of("robot.launch", *(f"{k}:={v}" for k, v in words.items()))
    assert {parameters[f"/{node}/base_frame"] for node in ("slam", "move_base")} == {"base"}
    assert {parameters[f"/{node}/odom_frame"] for node in ("slam", "move_base")} == {"wheels"}
    assert parameters["/explorer/base_link"] == "base"
    assert {parameters[f"/{node}/scan_topic"] for node in ("slam", "move_base", "map_merger")} == {"laser"}
    assert parameters["/slam/odometry_topic"] == parameters["/map_merger/position_local_robot_topic"] == "ways"
    assert parameters["/move_base/velocity_topic"] == "drive"


def test_configuration_files_go_before_the_preset_and_before_defaults(tmp_path):
    """A coarser map was asked for in vain: arguments that nobody had given went before the files."""
    for path in (PACKAGE / "config").glob("*.yaml"):
        (tmp_path / path.name).write_text(path.read_text())
    for node, words in {
        "explorer": "view_distance: 0.9",
        "slam": "free_radius: 0.1\nresolution: 0.1\nmap_update_interval: 5.0",
        "navigation": "footprint_width: 1\nxy_goal_tolerance: 0.3\nmap_topic: my_map",
    }.items():
        (tmp_path / f"{node}.yaml").write_text(words + "\n")
    parameters = parameters_of("robot.launch", f"config:={tmp_path}")
    assert parameters["/explorer/view_distance"] == 0.9 and parameters["/slam/free_radius"] == 0.1
    assert parameters["/slam/resolution"] == 0.1 and parameters["/slam/map_update_interval"] == 5.0
    assert parameters["/move_base/footprint_width"] == 1 and parameters["/move_base/map_topic"] == "my_map"
    assert parameters["/move_base/xy_goal_tolerance"] == 0.3


def test_an_own_robot(tmp_path):
    template = subprocess.run(
        ["rospack", "find", "mr_robot"], capture_output=True, text=True, check=True
    ).stdout.strip()
    own = tmp_path / "my robot.yaml"
    own.write_text((Path(template) / "robots" / "template.yaml").read_text().replace("width: 0.40", "width: 0.50"))
    parameters = parameters_of("robot.launch", f"robot:={own}")
    assert parameters["/explorer/inflation_radius"] == 0.31


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["robot:=tank"], "robot_parameters: no robot 'tank': there are pioneer, turtlebot"),
        (["robot:=turtlebot", "slam:=gmapping"], "add the argument scan_topic:=scan"),
        (["slam:=hector"], "slam:=hector needs the package hector_mapping, which is not installed"),
        (["navigation:=move_base_flex"], "navigation:=move_base_flex needs the package mbf_costmap_nav"),
        (["slam:=karto"], "slam:=karto is unknown; there are ours, gmapping, slam_toolbox, hector, none"),
        (["slam:=/no.launch"], "slam:=/no.launch: there is no such file"),
        (
            ["topology:=central"],
            "map_merger: parameter topology must be one of distributed, centralized, not 'central'",
        ),
        (
            ["topology:=centralized"],
            "map_merger: parameter base_station must name the base when topology is centralized",
        ),
        (["initial_poses:=anna 1 2"], "map_merger: parameter initial_poses must be of type dict, not 'anna 1 2'"),
        (["initial_poses:={anna: [1, 2"], "initial_poses:={anna: [1, 2 is no YAML"),
        (["frontier_selection:=9"], "explorer: parameter ~frontier_selection is 9, out of range 0 to 7"),
        (["strategy:=nearby"], "explorer: parameter ~strategy is 'nearby'"),
        (["time_limit:=-1"], "explorer: parameter ~time_limit is -1.0, out of range"),
        (
            ["log_path:=/etc/hostname/logs"],
            "log_path:=/etc/hostname/logs: /etc/hostname is no folder that can be written",
        ),
    ],
)
def test_what_cannot_be_is_refused_before_anything_starts(arguments, part, capfd):
    assert part in refused(capfd, "robot.launch", *arguments)


def test_a_folder_of_logs_may_be_there_or_yet_to_be_made(tmp_path, monkeypatch):
    """It is made by the nodes: a launch file is also read to be looked at."""
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    for path in (str(tmp_path), f"{tmp_path}/new/logs", "~/logs", "logs"):
        assert parameters_of("robot.launch", f"log_path:={path}")["/explorer/log_path"] == path
    assert not (tmp_path / "new").exists() and not (tmp_path / "logs").exists()


def refused(capfd, name, *arguments):
    """What is said while it is read: roslaunch ends with it."""
    with pytest.raises(XmlParseException):
        loaded(name, *arguments)
    told = capfd.readouterr().err
    assert "Traceback" not in told
    return told


def test_roslaunch_ends_with_what_is_said_first():
    told = roslaunch("--nodes", "simulation_5.launch", "world:=nosuch")
    assert told.returncode != 0 and "Traceback" not in told.stderr
    assert told.stderr.startswith('world:=nosuch: no world "nosuch"')


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["simulator:=stage"], "simulator:=stage needs the package stage_ros, which is not installed"),
        (["simulator:=gazebo"], "simulator:=gazebo is unknown; there are ours, stage"),
        (["world:=nosuch"], 'world:=nosuch: no world "nosuch"'),
        (["world:=small8x8"], "world:=small8x8 has 4 robots, 5 are needed"),
        (["frontier_selection:=9"], "explorer: parameter ~frontier_selection is 9"),
    ],
)
def test_a_simulation_that_cannot_be_is_refused_before_anything_starts(arguments, part, capfd):
    """gazebo meant ours without a word, and a world that is not there ended all robots after their start."""
    assert refused(capfd, "simulation_5.launch", *arguments).startswith(part)


def test_the_stage_of_others_is_started_where_it_is_installed(packages, capfd):
    world = f"world:={PACKAGE.parents[1] / 'worlds' / 'office26x15.world'}"
    assert {"/stageros", "/robot_1/explorer"} <= nodes_of("simulation_2.launch", "simulator:=stage", world)
    assert "simulator:=stage takes no names of worlds" in refused(capfd, "simulation_2.launch", "simulator:=stage")


@pytest.mark.parametrize("name", ["simulation_2.launch", "simulation_5.launch"])
def test_robots_under_one_master_are_told_what_their_launch_file_is(name, tmp_path):
    given = (
        "slam:=none", "navigation:=none", "team:=pioneer,turtlebot", "robot:=turtlebot", "strategy:=nearest",
        "time_limit:=90", "distance_limit:=40", "record:=true", f"record_path:={tmp_path}", "page:=true",
        "page_port:=9000", "log_path:=/logs", "autostart:=false",
    )  # fmt: skip
    nodes, parameters = nodes_of(name, *given), parameters_of(name, *given)
    for number in range(int(name[11])):
        robot = f"/robot_{number}"
        there = {node.removeprefix(f"{robot}/") for node in nodes if node.startswith(robot)}
        assert there == {"adhoc_communication", "map_merger", "explorer", "page", "bag"}
        words = {
            "explorer/time_limit": 90.0, "explorer/distance_limit": 40.0, "explorer/strategy": "nearest",
            "explorer/autostart": False, "explorer/seed": number, "explorer/log_path": "/logs",
            "explorer/field_of_view": 0.99, "map_merger/largest_robot_radius": 0.29, "page/port": 9000 + number,
            "page/map_frame": f"robot_{number}/map", "bag/output": f"--output-prefix={tmp_path}{robot}/topics",
        }  # fmt: skip
        assert {word: parameters[f"{robot}/{word}"] for word in words} == words


@pytest.mark.parametrize(
    ("name", "heading"), [("robot.launch", "Argument"), ("base_station.launch", "Argument of the base")]
)
def test_the_arguments_stand_in_the_readme(name, heading):
    """No others, and with their defaults; what is empty or follows from others is said in words."""
    table = (PACKAGE / "README.md").read_text().split(f"| {heading} | Default | Meaning |\n")[1].split("\n\n")[0]
    told = {}
    for row in table.splitlines()[1:]:
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        names = re.findall(r"`(\w+)`", cells[0])
        values = cells[1].split(", ")
        told.update(zip(names, values if len(values) == len(names) else [cells[1]] * len(names)))
    root = ElementTree.parse(PACKAGE / "launch" / name).getroot()
    defaults = {argument.get("name"): argument.get("default") for argument in root.findall("arg")}
    assert set(told) == set(defaults)
    literal = {key: value for key, value in defaults.items() if value and "$(" not in value}
    assert {key: told[key].strip("`") for key in literal} == literal


def test_so_do_those_of_several_robots_under_one_master():
    section = (PACKAGE / "README.md").read_text().split("\n## Several robots under one master\n")[1].split("\n## ")[0]
    for name in ("simulation_2.launch", "simulation_5.launch"):
        for argument in ElementTree.parse(PACKAGE / "launch" / name).getroot().findall("arg"):
            assert re.search(rf"\b{argument.get('name')}(`|:=)", section), argument.get("name")


def test_a_base_station_keeps_its_records_where_it_is_told(tmp_path):
    parameters = parameters_of("base_station.launch", "record:=true", f"record_path:={tmp_path}")
    assert parameters["/bag/output"] == f"--output-prefix={tmp_path}/topics"


def test_every_node_knows_the_robots_name():
    parameters = parameters_of("robot.launch", "robot_name:=anna", "simulated:=true")
    for node in ("adhoc_communication", "map_merger", "explorer", "move_base", "robot"):
        assert parameters[f"/{node}/robot_name"] == "anna", node


def test_a_robot_leaves_the_time_of_its_master_as_it_is():
    """The drivers may be those of a simulator that runs there already."""
    assert "/use_sim_time" not in parameters_of("robot.launch", "robot_name:=anna")
    assert parameters_of("robot.launch", "robot_name:=anna", "simulated:=true")["/use_sim_time"] is True


def test_without_a_name_each_node_takes_the_computers():
    parameters = parameters_of("robot.launch")
    assert {parameters.get(f"/{node}/robot_name", "") for node in ("adhoc_communication", "explorer", "move_base")} == {
        ""
    }


def test_recorder_is_there_only_with_a_file():
    assert "/bag" not in nodes_of("team_robot.launch")
    assert "/bag" in nodes_of("team_robot.launch", "bag:=/tmp/x.bag")


def test_arguments_reach_the_nodes():
    parameters = parameters_of(
        "robot.launch", "robot_name:=anna", "interface:=wlan7", "frontier_selection:=3",
        "autostart:=false", "initial_poses:={anna: [1.0, 2.0, 0.5]}", "topology:=centralized", "base_station:=7",
    )  # fmt: skip
    assert {parameters[f"/{node}/robot_name"] for node in ("adhoc_communication", "map_merger", "explorer")} == {"anna"}
    assert parameters["/adhoc_communication/interface"] == "wlan7"
    assert parameters["/explorer/frontier_selection"] == 3
    assert parameters["/explorer/autostart"] is False
    assert parameters["/map_merger/initial_poses/anna"] == [1.0, 2.0, 0.5]
    assert (parameters["/map_merger/topology"], parameters["/map_merger/base_station"]) == ("centralized", "7")


@pytest.mark.parametrize("path", LAUNCH_FILES, ids=lambda path: path.name)
def test_arguments_are_documented(path):
    arguments = ElementTree.parse(path).getroot().findall("arg")
    assert arguments
    for argument in arguments:
        assert len(argument.get("doc", "")) > 5, f"{path.name}: {argument.get('name')}"


def test_robot_launch_needs_no_argument():
    for argument in ElementTree.parse(PACKAGE / "launch" / "robot.launch").getroot().findall("arg"):
        assert argument.get("default") is not None, argument.get("name")


@pytest.mark.parametrize("path", sorted((PACKAGE / "config").glob("*.yaml")), ids=lambda path: path.name)
def test_parameter_files_load(path):
    assert isinstance(yaml.safe_load(path.read_text()), dict)


@pytest.mark.parametrize(
    ("name", "known"),
    [("map_merger", "map_merger.options"), ("explorer", "explorer.options")],
)
def test_parameter_files_hold_known_parameters(name, known):
    module = __import__(known, fromlist=["PARAMETERS"])
    names = {getattr(entry, "name", entry) for entry in module.PARAMETERS}
    values = yaml.safe_load((PACKAGE / "config" / f"{name}.yaml").read_text())
    assert set(values) <= names


def test_nodes_of_a_base_station():
    nodes = nodes_of("base_station.launch")
    assert nodes == {"/adhoc_communication", "/map_merger", "/mission_control"}
    assert nodes_of("team_base_station.launch") == {*nodes, "/monitor"}
    parameters = parameters_of("base_station.launch", "name:=7")
    assert parameters["/map_merger/has_local_map"] is False
    assert {parameters[f"/map_merger/{key}"] for key in ("robot_name", "base_station")} == {"7"}
    assert parameters["/map_merger/topology"] == "centralized"
    assert parameters["/adhoc_communication/robot_name"] == "7"
