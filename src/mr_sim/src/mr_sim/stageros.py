"""Drop-in for `stageros`: a whole world with all its robots in one ROS node, under one master."""

import argparse
import sys
import tempfile
import threading

import rospy
import tf2_ros

from mr_grid.ros_node import init_node
from mr_sim.robot_node import ParameterError, RobotNode
from mr_sim.world import BIAS, World
from mr_sim.world_client import ConnectionRefused, WorldClient
from mr_sim.world_model import load_world
from mr_sim.world_server import ServerError, WorldServer, listen
from mr_sim.worlds import find_world, warning_of


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="stageros", description="A Stage world with all its robots in one node.")
    parser.add_argument("world", help="a .world file, or the name of one of the project's worlds")
    parser.add_argument("-g", action="store_true", help="no window; accepted for stageros, there is never one")
    parser.add_argument("-u", action="store_true", help="prefixes are the names of the models, also for one robot")
    return parser.parse_args(rospy.myargv(sys.argv)[1:])


def prefixes(names: tuple[str, ...], use_model_names: bool) -> list[str]:
    """Prefix of each robot's topics and frames, as stageros chooses them."""
    if use_model_names:
        return [f"{name}/" for name in names]
    return [""] if len(names) == 1 else [f"robot_{index}/" for index in range(len(names))]


def whole_number(name: str, default: int) -> int:
    """A private parameter."""
    value = rospy.get_param(f"~{name}", default)
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise ParameterError(f"~{name} must be a whole number >= 0, not {value!r}")
    return value


def real_time_factor(default: float) -> float:
    """The parameter ~rtf, or that of the world file."""
    value = rospy.get_param("~rtf", default)
    if not isinstance(value, (int, float)) or isinstance(value, bool) or not 0.0 <= value <= 100.0:
        raise ParameterError(f"~rtf must be a number from 0 to 100, not {value!r}")
    return float(value)


def _run(world: World, use_model_names: bool, factor: float, folder: str) -> None:
    server = WorldServer(world, listen(f"{folder}/world"), factor, world.description.quit_time, say=rospy.loginfo)
    serving = threading.Thread(target=server.run)
    serving.start()
    rospy.on_shutdown(server.stop)
    try:
        _offer_robots(world.names, use_model_names, f"{folder}/world")
    finally:
        server.stop()
        serving.join()


def _offer_robots(names: tuple[str, ...], use_model_names: bool, path: str) -> None:
    """All robots of the world that listens at `path`, until it ends. Raises ConnectionRefused."""
    nodes = []
    for index, prefix in enumerate(prefixes(names, use_model_names)):
        client = WorldClient.connect(path, names[index], timeout=30.0)
        nodes.append(RobotNode(client, prefix, publish_clock=index == 0, publish_ground_truth=True))
    # One message: a latched topic keeps only a node's last one.
    static_transforms = tf2_ros.StaticTransformBroadcaster()
    static_transforms.sendTransform([transform for node in nodes for transform in node.static_transforms()])
    threads = [threading.Thread(target=node.run) for node in nodes]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def main() -> int:
    """Run the node; returns its exit code."""
    arguments = _arguments()
    try:
        description = load_world(find_world(arguments.world))
        init_node("stageros", disable_rostime=True)
        warning = warning_of(arguments.world, description)
        if warning:
            rospy.logwarn(warning)
        rospy.set_param("/use_sim_time", True)
        robots = whole_number("robots", 0) or None
        world = World(description, robots, whole_number("seed", 0), odometry=rospy.get_param("~odometry", BIAS))
        with tempfile.TemporaryDirectory(prefix="mr_sim") as folder:
            _run(world, arguments.u, real_time_factor(description.speedup), folder)
    except (ValueError, ConnectionRefused, ServerError) as error:
        print(f"stageros: {error}", file=sys.stderr)
        return 1
    rospy.signal_shutdown("the world has ended")
    return 0
