"""The lists of what is new on the page of migration, both ways: all that the nodes have and the original has not."""

import re
from typing import Dict, Set

import pytest
from pages import REPOSITORY

from explorer import names as explorer_names
from explorer import options as explorer_options
from map_merger import options as map_merger_options

PAGE = (REPOSITORY / "docs" / "migration.md").read_text(encoding="utf-8")
# Of the packages of Andre, Neuhold and Bettstetter, as their sources and launch files have them.
ORIGINAL_PARAMETERS: Dict[str, str] = {
    "adhoc_communication": "interface mac robot_name num_link_retrans num_e2e_retrans num_rreq max_frame_size"
    " hop_limit_min hop_limit_max hop_limit_increment beacon_interval max_packet_size simulation_mode"
    " robots_in_simulation p_thres p_tx n_model l_0_model topic_new_robot topic_remove_robot rebuild_mc_tree"
    " recursive_mc_ack loss_ratio nack_threshold sim_robot_macs log_path enable_cooperative_relaying tx_power"
    " use_sim_time",
    "map_merger": "robot_name robot_prefix local_map_frame_id local_map_topic local_map_metadata_topic"
    " map_topic_over_network meta_topic_over_network control_topic position_local_robot_topic"
    " position_other_robots_topic has_local_map exchange_position splitted split_size seconds_pub_timer"
    " seconds_send_timer seconds_recompute_transform seconds_send_position seconds_meta_timer max_trans_robots"
    " max_rotation_robots debug log_path",
    "explorer": "frontier_selection robot_prefix move_base_frame wait_for_planner_result"
    " number_unreachable_for_cluster local_costmap/width local_costmap/height log_path robot_name base_link"
    " local_map_metadata_topic",
}
ORIGINAL_SERVICES: Dict[str, str] = {
    "adhoc_communication": "send_string send_map send_position send_point send_map_update send_control_message"
    " send_frontier send_cluster send_auction send_twist send_robot_update broadcast_string broadcast_robot_update"
    " join_mc_group get_group_state get_neighbors shut_down",
    "map_merger": "transformPoint logOutput",
    "explorer": "",
}
ORIGINAL_TOPICS: Dict[str, str] = {  # that the node publishes
    "adhoc_communication": "new_robot remove_robot",
    "map_merger": "global_map all_positions",
    "explorer": "frontierPoints visitedfrontierPoints goalPoint/goalPoint homePoint/homePoint goalPoint "
    + " ".join(f"cluster_grid_{number}" for number in range(20)),
}
SILENT = {  # what nothing warns of: a word of the behaviour
    "adhoc_communication": "num_rreq beacon_interval new_robot latched /rosout loss_ratio simple_simulator.py",
    "map_merger": "max_rotation_robots split_size all_positions seconds_send_position",
    "explorer": "exploration.launch explore.py costmaps Home Fallback Waits Heading wait_for_planner_result assignment"
    " detected_by_robot_str bid",
}
WITH_A_ROW = {"send_quaternion"}  # new, and told in the table of differences


def told(package: str, kind: str) -> Set[str]:
    """What the section of a package lists as new: `parameters` or `services`."""
    section = PAGE.split(f"\n## {package}\n")[1].split("\n## ")[0]
    listed = section.split("\nNew: ")[1].split("\n\n")[0]
    part = next(part for part in listed.split(";") if part.strip().startswith(kind))
    return {name.lstrip("~") for name in re.findall(r"`([^`]+)`", part)}


def parameters(package: str) -> Set[str]:
    if package == "explorer":
        return {parameter.name for parameter in explorer_options.PARAMETERS}
    if package == "map_merger":
        return set(map_merger_options.PARAMETERS)
    table = (REPOSITORY / "src" / package / "README.md").read_text(encoding="utf-8")  # compared with the node's own
    section = table.split("## Parameters", 1)[1].split("\n## ", 1)[0]
    return set(re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE))


def services(package: str) -> Set[str]:
    if package == "explorer":
        offered = explorer_names.names_for(explorer_options.load({}, host_name="anna")).offered
        return {name.lstrip("~") for name in offered.values()}
    place, call = {
        "map_merger": ("src/map_merger", r"rospy\.Service\(\"~(\w+)\""),
        "adhoc_communication": ("src/node", r"advertise\w*(?:<\w+>)?\(node, (?:\w+_, )?\"(\w+)\""),
    }[package]
    folder = REPOSITORY / "src" / package / place
    files = [path for path in folder.rglob("*") if path.suffix in (".py", ".cpp")]
    return {name for path in files for name in re.findall(call, path.read_text(encoding="utf-8"))}


@pytest.mark.parametrize("package", ORIGINAL_PARAMETERS)
def test_new_parameters_are_those_of_the_node(package: str) -> None:
    assert told(package, "parameters") == parameters(package) - set(ORIGINAL_PARAMETERS[package].split())
    assert set(ORIGINAL_PARAMETERS[package].split()) <= parameters(package), "the original's are all taken"


@pytest.mark.parametrize("package", ORIGINAL_SERVICES)
def test_new_services_are_those_of_the_node(package: str) -> None:
    originals = set(ORIGINAL_SERVICES[package].split())
    assert told(package, "services") == services(package) - originals - WITH_A_ROW
    assert originals <= services(package), "the original's are all offered"


def published(package: str) -> Set[str]:
    if package == "explorer":
        return set(explorer_names.names_for(explorer_options.load({}, host_name="anna")).published.values())
    place, call = {
        "map_merger": ("src/map_merger", r"rospy\.Publisher\(f?\"(?:~|\{prefix\})(\w+)\""),
        "adhoc_communication": ("src/node", r"advertise<\w[\w:]*>\(\s*(?:\w+ \+ )?\"(/?[\w/]+)\""),
    }[package]
    folder = REPOSITORY / "src" / package / place
    files = [path for path in folder.rglob("*") if path.suffix in (".py", ".cpp")]
    return {name for path in files for name in re.findall(call, path.read_text(encoding="utf-8"))}


@pytest.mark.parametrize("package", ORIGINAL_TOPICS)
def test_new_topics_are_those_of_the_node(package: str) -> None:
    listed = {name.replace("adhoc_communication/", "") for name in told(package, "topics")}
    new = {name.lstrip("~") for name in published(package)} - set(ORIGINAL_TOPICS[package].split())
    assert new and {name for name in listed if "/" not in name.strip("/")} == new


@pytest.mark.parametrize("package", ["map_merger", "explorer"])
def test_so_are_those_by_which_its_robots_tell_each_other_more(package: str) -> None:
    files = (REPOSITORY / "src" / package / "src" / package).glob("*.py")
    call = r"^(?:\w+_)?TOPIC = \"(\w+/\w+)\""
    sent = {name for path in files for name in re.findall(call, path.read_text(encoding="utf-8"), re.MULTILINE)}
    assert sent and {name for name in told(package, "topics") if "/" in name} == sent


@pytest.mark.parametrize("package", SILENT)
def test_what_differs_without_a_word_is_in_the_table(package: str) -> None:
    section = PAGE.split(f"\n## {package}\n")[1].split("\n## ")[0]
    silent = "\n".join(line for line in section.splitlines() if "(**silent**)" in line)
    assert [word for word in SILENT[package].split() if word not in silent] == []
