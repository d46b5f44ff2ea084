"""Runs rosbag's recorder of one robot, with the topics that its description names; see recorder.launch."""

import sys

import rosgraph
import rospy

from mr_grid.ros_node import wait_for_master
from mr_launch.disk_guard import guarded
from mr_launch.programs import find_executable
from mr_launch.recorder import record_command, record_folder


def main() -> int:
    remappings = [word for word in sys.argv[1:] if ":=" in word]
    name = rosgraph.names.load_mappings(sys.argv).get("__name", "record")
    wait_for_master(name)
    node = rosgraph.names.ns_join(rosgraph.names.get_ros_namespace(argv=sys.argv), name)
    program = find_executable("rosbag", "record")
    try:
        given = rospy.get_param(node)
        command = record_command(program or "", given, remappings)
        folder, least = record_folder(given), int(given.get("least_free", 200)) * 1000000
    except (KeyError, ValueError) as error:
        print(f"record: parameter {error} of {node} cannot be used (started by recorder.launch only)", file=sys.stderr)
        return 1
    if program is None:
        print("record: rosbag is not installed", file=sys.stderr)
        return 1
    return guarded(command, folder, least, stays=bool(given.get("respawn")))
