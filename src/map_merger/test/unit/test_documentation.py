"""README tables, launch files and the node tell the same story."""

import os
import re
import xml.etree.ElementTree as ElementTree

import pytest

from map_merger.options import PARAMETERS, WITHOUT_EFFECT

ROOT = os.path.join(os.path.dirname(__file__), "..", "..")


def text_of(*path):
    with open(os.path.join(ROOT, *path), encoding="utf-8") as file:
        return file.read()


def table(heading):
    """First columns of the rows of the table below a heading of the README."""
    section = re.split(r"^#+ ", text_of("README.md"), flags=re.MULTILINE)
    (part,) = [each for each in section if each.startswith(heading + "\n")]
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in part.splitlines() if line.startswith("| `")
    ]
    assert rows, heading
    return rows


def test_every_parameter_is_in_the_table_with_its_type_and_default():
    rows = {row[0].strip("`"): row for row in table("Parameters")}
    assert set(rows) == set(PARAMETERS) - set(WITHOUT_EFFECT)
    for name, row in rows.items():
        parameter = PARAMETERS[name]
        kind = {str: "string", dict: "struct", float: "double"}.get(parameter.kind, parameter.kind.__name__)
        shown = (
            {"": "empty", True: "true", False: "false"}.get(parameter.default, f"{parameter.default}")
            if parameter.kind in (str, bool)
            else ("empty" if parameter.kind is dict else f"{parameter.default:g}")
        )
        if name == "robot_name":
            shown = "host name"
        assert (row[1], row[2].strip("`")) == (kind, shown), name


def test_parameters_without_effect_are_listed_with_the_reason():
    rows = {row[0].strip("`"): row[1] for row in table("Parameters without effect")}
    assert rows == WITHOUT_EFFECT


def test_topics_and_services_of_the_table_are_those_of_the_node():
    files = ("node", "io", "maps", "outputs", "radio", "inputs", "sends")
    node = "".join(text_of("src", "map_merger", f"ros_{name}.py") for name in files)
    parameters = {f"<{name}>" for name in PARAMETERS}
    for row in table("Topics") + table("Services"):
        name = row[0].strip("`").replace("<prefix>/", "")
        if name in parameters:
            assert f"options.{name[1:-1]}" in node, name
        else:
            name = name.replace("<robot>/map", "{robot}/map").replace("<robot>", "")
            assert name in node, name
    networked = re.findall(r'(?:_network\("|Publisher\(f"\{prefix\})([\w/]+)"', node)
    declared = {*re.findall(r'"(~\w+)"', node), *networked}
    documented = " ".join(row[0] for row in table("Topics") + table("Services"))
    for name in declared - {f"~{name}" for name in PARAMETERS}:
        assert name in documented or name == "~", name


@pytest.mark.parametrize("name", ["map_merger.launch", "map_merger_base.launch"])
def test_launch_arguments_are_documented_with_defaults_and_set_known_parameters(name):
    root = ElementTree.fromstring(text_of("launch", name))
    arguments = {arg.get("name"): arg for arg in root.findall("arg")}
    contract = {
        "log_path",
        "robot_name",
        "robot_prefix",
        "robot_local_map_frame",
        "use_sim_time",
        "output",
        "position_local_robot_topic",
    }
    assert contract <= set(arguments)
    assert all(arg.get("doc") and arg.get("default") is not None for arg in arguments.values())
    (node,) = root.findall("node")
    names = {param.get("name") for param in node.findall("param")} | {
        each.get("param") for each in node.findall("rosparam")
    }
    assert names <= set(PARAMETERS) - set(WITHOUT_EFFECT)
    used = set(re.findall(r"\$\(arg (\w+)\)", text_of("launch", name)))
    assert used == set(arguments)
