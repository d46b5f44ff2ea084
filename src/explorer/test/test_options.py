"""Parameters: defaults of the contract, refusals, identity, and the tables of README.md against the code."""

import os
import re
import xml.etree.ElementTree as ElementTree
from typing import Any, Dict, List

import pytest
from conftest import HERE
from usual_robot import options_with

from explorer import logs, names, options
from explorer.agent import ExplorerAgent
from explorer.auction import first_auction_id
from explorer.errors import ParameterError
from explorer.messages import WriteLog
from explorer.strategies import strategy_of

ROOT = os.path.join(HERE, "..")

CONTRACT_DEFAULTS = {
    "frontier_selection": 1,
    "robot_prefix": "",
    "move_base_frame": "map",
    "wait_for_planner_result": 3,
    "number_unreachable_for_cluster": 3,
    "local_costmap/width": 0,
    "local_costmap/height": -1,
    "log_path": "",
}


def nested(name: str, value: Any) -> Dict[str, Any]:
    result = value
    for part in reversed(name.split("/")):
        result = {part: result}
    return result


def test_defaults_of_the_contract() -> None:
    by_name = {parameter.name: parameter for parameter in options.PARAMETERS}
    for name, default in CONTRACT_DEFAULTS.items():
        assert by_name[name].default == default
        assert type(by_name[name].default) is by_name[name].type
    assert options.load({}, host_name="joy") == options_with(robot_name="joy", base_link="base_link")


def test_every_parameter_arrives() -> None:
    given = {
        int: 5,
        float: 0.7,
        bool: False,
        str: "text",
        list: [1, 2.5, 0],
    }
    for parameter in options.PARAMETERS:
        if parameter.name in ("robot_prefix", "move_base_frame", "strategy"):
            continue
        value = {"claim_timeout": 7.0, "progress_timeout": 7.0}.get(parameter.name, given[parameter.type])
        loaded = options.load(nested(parameter.name, value), host_name="joy")
        attribute = getattr(loaded, parameter.name.replace("/", "_"))
        assert attribute == (tuple(value) if parameter.type is list else value), parameter.name


@pytest.mark.parametrize(
    "given, culprit",
    [
        ({"frontier_selection": 8}, r"~frontier_selection is 8, out of range 0 to 7.*nearest frontier"),
        ({"frontier_selection": -1}, "out of range"),
        ({"frontier_selection": "1"}, "must be of type int"),
        ({"frontier_selection": True}, "must be of type int"),
        ({"strategy": "best"}, r"~strategy is 'best': strategy 'best' is unknown; there are 0 nearest_path"),
        ({"strategy": 7}, "~strategy is 7, it must be of type str"),
        ({"inflation_radius": float("nan")}, "~inflation_radius is nan"),
        ({"inflation_radius": -0.1}, "~inflation_radius"),
        ({"wait_for_planner_result": 0}, "~wait_for_planner_result"),
        ({"home_pose": [1, 2]}, "x, y, yaw"),
        ({"home_pose": [1, 2, "north"]}, "x, y, yaw"),
        ({"home_pose": [1e308, 2, 0]}, "within 100000 m"),
        ({"robot_name": "a b"}, "robot name 'a b'"),
        ({"robot_prefix": "/robot_1"}, "must carry the robot's number"),
        ({"robot_prefix": "/robot_1", "move_base_frame": "/robot_2/map"}, "belongs to robot_2"),
        ({"local_costmap": {"width": 1.5}}, "~local_costmap/width is 1.5"),
        ({"move_base_frame": "/"}, "~move_base_frame is empty"),
        ({"map_topic": "a map"}, "~map_topic is 'a map', it must be the name of a topic"),
        ({"local_map_metadata_topic": ""}, "~local_map_metadata_topic is '', it must be the name of a topic"),
    ],
)
def test_bad_values_are_refused_with_the_culprit(given: Dict[str, Any], culprit: str) -> None:
    with pytest.raises(ParameterError, match=culprit):
        options.load(given, host_name="joy")


def test_a_strategy_by_its_name_comes_before_its_number() -> None:
    named = options.load({"strategy": "furthest", "frontier_selection": 7}, host_name="joy")
    assert named.frontier_selection == 2
    assert options.load({"strategy": "", "frontier_selection": 7}, host_name="joy").frontier_selection == 7


def test_identity() -> None:
    simulated = options.load({"robot_prefix": "/robot_12", "move_base_frame": "/robot_12/map"}, host_name="joy")
    assert (simulated.robot_name, simulated.robot_number, simulated.group) == ("robot_12", 12, "mc_robot_12")
    assert simulated.simulation and simulated.base_link == "robot_12/base_link"
    real = options.load({"robot_name": "marley"}, host_name="joy")
    assert (real.robot_name, real.robot_number, real.group, real.simulation) == ("marley", 0, "mc_marley", False)
    assert options.load({}, host_name="joy").group == "mc_joy"


def test_robots_in_simulation_is_logged() -> None:
    assert options.summary(options.load({}, None)).endswith("robots in simulation: 1")
    assert options.summary(options.load({}, 7)).endswith("robots in simulation: 7")
    for value in (-1, "two", 2.5):
        with pytest.raises(ParameterError, match="parameter robots_in_simulation is "):
            options.load({}, value)


def test_auction_numbers() -> None:
    assert first_auction_id("robot_3", 3, simulation=True) == 30000
    joy, bob = first_auction_id("joy", 0, simulation=False), first_auction_id("bob", 0, simulation=False)
    assert joy != bob and 0 <= joy < 2**32 and joy % 2**16 == 0


def test_names_in_simulation_and_on_a_real_robot() -> None:
    real = names.names_for(options.load({}, host_name="joy"))
    assert real.subscribed["auction"] == "auction"
    assert real.called["send_auction"] == "adhoc_communication/send_auction"
    simulated = names.names_for(
        options.load({"robot_prefix": "robot_1", "move_base_frame": "robot_1/map"}, host_name="joy")
    )
    assert simulated.subscribed["auction"] == "/robot_1/auction"
    assert simulated.subscribed["map"] == "/robot_1/map_merger/global_map"
    assert simulated.called["log_output"] == "/robot_1/map_merger/logOutput"
    assert simulated.action == "move_base" and simulated.published["frontiers"] == "frontierPoints"


def test_useless_parameters_warn_once_each_group() -> None:
    given = {
        "global_costmap": {"robot_radius": 0.2, "inflation": {"x": 1}},
        "local_costmap": {"width": 5, "update_frequency": 2.0},
    }
    lines = options.warnings(given)
    assert len(lines) == 2
    assert "~global_costmap/inflation, ~global_costmap/robot_radius" in lines[0]
    assert "update_frequency" in lines[1] and "width" not in lines[1].split(":")[1]
    assert options.warnings({"local_costmap": {"width": 5}}) == []
    assert "resolution" in options.warnings({"local_costmap": {"resolution": 0.05}})[0]


def table_rows(first_cell: str) -> List[List[str]]:
    """Cells of the table of README.md whose header starts with that cell."""
    with open(os.path.join(ROOT, "README.md")) as file:
        text = file.read()
    header = text.index(first_cell)
    lines = text[header:].split("\n\n")[0].splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_readme_lists_the_parameters() -> None:
    rows = table_rows("| Name | Type | Default | Meaning |")
    assert [row[0].strip("`") for row in rows] == [parameter.name for parameter in options.PARAMETERS]
    for row, parameter in zip(rows, options.PARAMETERS):
        assert row[1] == parameter.type.__name__, parameter.name
        default = "empty" if parameter.default in ("", []) else str(parameter.default)
        assert row[2].lower() == default.lower(), parameter.name
        assert parameter.meaning in row[3], parameter.name


def test_readme_lists_the_names() -> None:
    text = " ".join(" ".join(row) for row in table_rows("| Direction | Name | Type |"))
    listed = set(re.findall(r"`([^`]+)`", text))
    all_names = names.names_for(options_with())
    used = {*all_names.subscribed.values(), *all_names.published.values(), *all_names.called.values()}
    used |= {*all_names.offered.values(), all_names.action}
    used -= {f"cluster_grid_{index}" for index in range(1, names.CLUSTER_GRIDS - 1)}
    missing = used - listed
    assert not missing
    types = {name for name in listed if re.fullmatch(r"\w+/[A-Z]\w+", name)}
    words = {parameter.name for parameter in options.PARAMETERS}
    assert not listed - used - types - words, "README.md names what the node does not have"


def test_readme_lists_the_strategies() -> None:
    rows = table_rows("| `frontier_selection` | Procedure |")
    assert [int(row[0]) for row in rows] == sorted(options.STRATEGIES)
    with open(os.path.join(ROOT, "README.md")) as file:
        sentence = re.search(r"Their names, for `strategy`:(.*?)\.\n\n", file.read(), re.DOTALL)
    assert sentence is not None
    told = re.findall(r"`(\w+)` \((\d)\)", sentence.group(1))
    assert [strategy_of(name).number for name, _ in told] == [int(n) for _, n in told] == sorted(options.STRATEGIES)


def test_launch_file_has_the_arguments_of_the_contract() -> None:
    root = ElementTree.parse(os.path.join(ROOT, "launch", "exploration.launch")).getroot()
    arguments = {arg.get("name"): arg.get("default") for arg in root.iter("arg") if arg.get("doc")}
    contract = {"robot_prefix": "", "log_path": "", "output": "log", "frontier_selection": "7", "use_sim_time": "false"}
    assert contract.items() <= arguments.items() and "robot_name" in arguments
    known = {parameter.name for parameter in options.PARAMETERS} | {"/use_sim_time"}
    assert {param.get("name") for param in root.iter("param")} <= known


def test_costmap_size_is_reported_in_the_log() -> None:
    given = options.load({"local_costmap": {"width": 16, "height": 12}}, host_name="joy")
    agent = ExplorerAgent(given)
    agent.start(0.0)
    text = "".join(effect.text for effect in agent.tick(10.5) if isinstance(effect, WriteLog))
    assert "explorer_local_costmap_width=16\n" in text and "explorer_local_costmap_height=12\n" in text


def test_logs_have_the_keys_and_columns_of_the_contract() -> None:
    text = logs.exploration_log({"complete": 1})
    keys = [line.split("=")[0] for line in text.splitlines()[1:]]
    assert keys == list(logs.EXPLORATION_KEYS) and len(keys) == 21
    line = logs.periodical_line({"time": 10.0})
    assert len(line.split("\t")) == len(logs.PERIODICAL_HEADER.split("\t")) == 11
