"""Drop-in for `stageros`: a whole world with all its robots in one ROS node, under one master."""

import sys
import tempfile
import threading
from collections.abc import Sequence

import rospy
import tf2_ros
from std_srvs.srv import Empty, EmptyResponse

from mr_grid.ros_node import init_node
from mr_sim import stageros_options, worlds
from mr_sim.robot_node import RobotNode
from mr_sim.stageros_options import Prefixes
from mr_sim.world import World
from mr_sim.world_client import ConnectionRefused, WorldClient
from mr_sim.world_model import load_world
from mr_sim.world_server import ServerError, WorldServer, listen


def _run(world: World, prefixes: Sequence[Prefixes], factor: float, folder: str) -> None:
    path = f"{folder}/world"
    server = WorldServer(world, listen(path), factor, world.description.quit_time, say=rospy.loginfo)
    serving = threading.Thread(target=server.run)
    serving.start()
    rospy.on_shutdown(server.stop)
    try:
        nodes = _connect(world.names, prefixes, path)
        rospy.Service("reset_positions", Empty, lambda _: _reset(server))
        _offer(nodes)
    finally:
        server.stop()
        serving.join()


def _reset(server: WorldServer) -> EmptyResponse:
    rospy.loginfo("all robots go back to their start poses")
    server.reset_positions()
    return EmptyResponse()


def _connect(names: Sequence[str], prefixes: Sequence[Prefixes], path: str) -> list[RobotNode]:
    """All robots of the world that listens at `path`. Raises ConnectionRefused."""
    nodes = []
    for index, prefix in enumerate(prefixes):
        client = WorldClient.connect(path, names[index], timeout=30.0)
        first = index == 0
        nodes.append(RobotNode(client, prefix.topics, prefix.frames, publish_clock=first, publish_ground_truth=True))
    return nodes


def _offer(nodes: Sequence[RobotNode]) -> None:
    """Publish until the world ends."""
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
    arguments = stageros_options.read_arguments(rospy.myargv(sys.argv)[1:])
    try:
        description = load_world(worlds.find_world(arguments.world))
        init_node("stageros", disable_rostime=True)
        parameters = rospy.get_param("~", {})
        options = stageros_options.options_of(parameters)
        passed_over = stageros_options.warning_of(parameters, arguments)
        for warning in filter(None, (worlds.warning_of(arguments.world, description), passed_over)):
            rospy.logwarn(warning)
        rospy.set_param("/use_sim_time", True)
        world = World(
            description, options.robots, options.seed, options.command_timeout, options.odometry, intensities=True
        )
        prefixes = stageros_options.prefixes(world.names, arguments.use_model_names)
        factor = description.speedup if options.real_time_factor is None else options.real_time_factor
        with tempfile.TemporaryDirectory(prefix="mr_sim") as folder:
            _run(world, prefixes, factor, folder)
    except (ValueError, ConnectionRefused, ServerError) as error:
        print(f"stageros: {error}", file=sys.stderr)
        return 1
    rospy.signal_shutdown("the world has ended")
    return 0
