"""The robot node: the base and laser of one simulated robot on that robot's ROS master, as stageros offers them."""

import math
import sys

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped, Twist
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Float64

from mr_grid.ros_node import init_node
from mr_sim import protocol, ros_io
from mr_sim.world_client import ConnectionRefused, WorldClient

CLOCK_INTERVAL = 0.05  # s of simulated time
LARGEST_OFFSET = 1e6  # s

# Private parameters and their defaults.
PARAMETERS = {
    "socket": "",
    "robot_name": "robot_0",
    "prefix": "",
    "publish_clock": True,
    "publish_ground_truth": True,
    "connect_timeout": 30.0,
}
TOPICS = ("cmd_vel", "odom", "base_pose_ground_truth", "base_scan", "~clock_offset")


class ParameterError(ValueError):
    """A parameter that cannot be used."""


def read_parameters() -> dict:
    """Private parameters; raises ParameterError naming the culprit."""
    values = {}
    for name, default in PARAMETERS.items():
        value = rospy.get_param(f"~{name}", default)
        if isinstance(default, float) and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        if type(value) is not type(default):
            raise ParameterError(f"~{name} must be of type {type(default).__name__}, not {value!r}")
        values[name] = value
    if not values["socket"]:
        raise ParameterError("~socket is not set: give the path of the world process's socket")
    if not values["connect_timeout"] >= 0.0:
        raise ParameterError(f"~connect_timeout must be >= 0 s, not {values['connect_timeout']:g}")
    return values


class RobotNode:
    """Publishes what the world says, sends velocity commands to it."""

    def __init__(
        self, client: WorldClient, topics: str, frames: str, publish_clock: bool, publish_ground_truth: bool
    ) -> None:
        """`topics`, `frames`: what their names begin with."""
        self._client = client
        self._prefix = frames
        self._offset = 0.0
        self._next_clock = 0.0 if publish_clock else math.inf
        self._clock = rospy.Publisher("/clock", Clock, queue_size=10) if publish_clock else None
        self._odometry = rospy.Publisher(topics + "odom", Odometry, queue_size=10)
        self._truth = None
        if publish_ground_truth:
            self._truth = rospy.Publisher(topics + "base_pose_ground_truth", Odometry, queue_size=10)
        rangers = client.welcome.rangers
        self._scans = [
            rospy.Publisher(topics + name, LaserScan, queue_size=10)
            for name in ros_io.device_names("base_scan", len(rangers))
        ]
        self._laser_frames = [frames + name for name in ros_io.device_names("base_laser_link", len(rangers))]
        self._scan_messages = [ros_io.scan_message(*pair) for pair in zip(self._laser_frames, rangers, strict=True)]
        self._odometry_message = ros_io.odometry_message(frames + "odom", frames + "base_footprint")
        self._truth_message = ros_io.odometry_message(frames + "odom", frames + "base_footprint")
        self._transforms = tf2_ros.TransformBroadcaster()
        self._subscriber = rospy.Subscriber(topics + "cmd_vel", Twist, self._on_command, queue_size=1, tcp_nodelay=True)
        self._offsets = rospy.Subscriber("~clock_offset", Float64, self._on_offset, queue_size=1)

    def static_transforms(self) -> list[TransformStamped]:
        """From base_footprint to base_link and on to each laser, for /tf_static."""
        zero, base = rospy.Time(0), self._prefix + "base_link"
        mounts = [ranger.mount for ranger in self._client.welcome.rangers]
        return [
            ros_io.transform(zero, self._prefix + "base_footprint", base, (0.0, 0.0, 0.0)),
            *(ros_io.transform(zero, base, *pair) for pair in zip(self._laser_frames, mounts, strict=True)),
        ]

    def _on_command(self, message: Twist) -> None:
        linear, lateral, angular = message.linear.x, message.linear.y, message.angular.z
        if all(map(math.isfinite, (linear, lateral, angular))):
            self._client.command(linear, angular, lateral)
        else:
            rospy.logwarn_throttle(1.0, "cmd_vel ignored: its velocities must be finite numbers")

    def _on_offset(self, message: Float64) -> None:
        if math.isfinite(message.data) and abs(message.data) <= LARGEST_OFFSET:
            self._offset = message.data
            rospy.logwarn("the clock of this robot is %g s ahead of the world from now on", message.data)
        else:
            rospy.logwarn("clock_offset ignored: give at most %g s", LARGEST_OFFSET)

    def _stamp(self, seconds: float) -> rospy.Time:
        """What the clock of the robot says at this time of the world (s); no clock goes below 0."""
        return rospy.Time.from_sec(max(0.0, seconds + self._offset))

    def run(self) -> int:
        """Publish until the world ends (0) or the connection is lost (1)."""
        while not _ends():
            message = self._client.receive()
            if isinstance(message, protocol.State):
                self._publish_state(message)
            elif isinstance(message, protocol.Intensities):
                self._scan_messages[message.ranger].intensities = message.intensities
            elif isinstance(message, protocol.Ranges):
                self._publish_ranges(message)
            elif isinstance(message, protocol.Bye):
                rospy.loginfo("the world has ended")
                return 0
            elif not _ends():
                rospy.logerr("connection to the world lost")
                return 1
        return 0

    def _publish_state(self, state: protocol.State) -> None:
        stamp = self._stamp(state.time)
        if self._clock and state.time >= self._next_clock:
            self._next_clock = state.time + CLOCK_INTERVAL - 1e-6
            self._clock.publish(stamp)
        odometry, base = self._prefix + "odom", self._prefix + "base_footprint"
        self._transforms.sendTransform(ros_io.transform(stamp, odometry, base, state.odometry))
        ros_io.fill_odometry(self._odometry_message, stamp, state.odometry, state.wheels)
        self._odometry.publish(self._odometry_message)
        if self._truth and self._truth.get_num_connections():
            ros_io.fill_odometry(self._truth_message, stamp, state.pose, state.velocity)
            self._truth.publish(self._truth_message)

    def _publish_ranges(self, message: protocol.Ranges) -> None:
        scan = self._scan_messages[message.ranger]
        scan.header.stamp = self._stamp(message.time)
        scan.ranges = message.ranges
        self._scans[message.ranger].publish(scan)


def _ends() -> bool:
    """Sooner than `rospy.is_shutdown`: what is done at shutdown closes the connection before that."""
    return bool(rospy.core.is_shutdown_requested())


def main() -> int:
    """Run the node; returns its exit code."""
    # This node makes the time of its master: it must not wait for it.
    init_node("robot", disable_rostime=True)
    try:
        parameters = read_parameters()
        client = WorldClient.connect(
            parameters["socket"], parameters["robot_name"], timeout=parameters["connect_timeout"]
        )
    except (ParameterError, ConnectionRefused) as error:
        rospy.logfatal(str(error))
        print(f"robot: {error}", file=sys.stderr)
        return 1
    if parameters["publish_clock"]:
        rospy.set_param("/use_sim_time", True)
    rospy.on_shutdown(client.close)
    prefix = parameters["prefix"]
    node = RobotNode(client, prefix, prefix, parameters["publish_clock"], parameters["publish_ground_truth"])
    static_transforms = tf2_ros.StaticTransformBroadcaster()
    static_transforms.sendTransform(node.static_transforms())
    rospy.loginfo("%s is in the world on %s", parameters["robot_name"], parameters["socket"])
    code = node.run()
    rospy.signal_shutdown("the world has ended")
    return code
