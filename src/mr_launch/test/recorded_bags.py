"""Bags as robots record them, written without ROS: every number in them is chosen by the test."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

SOURCES = Path(__file__).resolve().parents[2]
OWN = ("adhoc_communication/MmPoint", "adhoc_communication/MmListOfPoints", "adhoc_communication/MmRobotPosition",
       "map_merger/RobotPlacement", "map_merger/MergerStatus", "explorer/ExplorationState")  # fmt: skip
SECOND = 10**9


def store():
    found = get_typestore(Stores.ROS1_NOETIC)
    types = get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage")
    for name in OWN:
        package, kind = name.split("/")
        text = (SOURCES / package / "msg" / f"{kind}.msg").read_text()
        types.update(get_types_from_msg(text, f"{package}/msg/{kind}"))
    found.register(types)
    return found


class Bag:
    """`with Bag(path) as bag: bag.add(time in ns, topic, message)`."""

    def __init__(self, path):
        path.parent.mkdir(parents=True, exist_ok=True)
        self._writer, self._store, self._connections = Writer(path), store(), {}

    def __enter__(self):
        self._writer.open()
        return self

    def __exit__(self, *_):
        self._writer.close()

    def make(self, kind, *values):
        package, name = kind.split("/")
        return self._store.types[f"{package}/msg/{name}"](*values)

    def add(self, time, topic, message, latching=0, node="/x"):
        kind = message.__msgtype__
        if topic not in self._connections:
            self._connections[topic] = self._writer.add_connection(
                topic, kind, typestore=self._store, callerid=node, latching=latching
            )
        self._writer.write(self._connections[topic], time, self._store.serialize_ros1(message, kind))

    # ---- messages -------------------------------------------------------------------------------------------------

    def stamp(self, time):
        return self.make("builtin_interfaces/Time", *divmod(time, SECOND))

    def header(self, time, frame):
        return self.make("std_msgs/Header", 7, self.stamp(time), frame)

    def pose(self, x, y):
        still = self.make("geometry_msgs/Quaternion", 0.0, 0.0, 0.0, 1.0)
        return self.make("geometry_msgs/Pose", self.make("geometry_msgs/Point", x, y, 0.0), still)

    def transform(self, time, parent, child, x):
        still = self.make("geometry_msgs/Quaternion", 0.0, 0.0, 0.0, 1.0)
        found = self.make("geometry_msgs/Transform", self.make("geometry_msgs/Vector3", x, 0.0, 0.0), still)
        return self.make("geometry_msgs/TransformStamped", self.header(time, parent), child, found)

    def tf(self, *transforms):
        return self.make("tf2_msgs/TFMessage", list(transforms))

    def clock(self, time):
        return self.make("rosgraph_msgs/Clock", self.stamp(time))

    def scan(self, time):
        ranges = np.arange(5, dtype=np.float32)
        header, numbers = self.header(time, "base_laser_link"), (-1.0, 1.0, 0.5, 0.0, 0.1, 0.0, 8.0)
        return self.make("sensor_msgs/LaserScan", header, *numbers, ranges, ranges)

    def grid(self, time, cells):
        info = self.make(
            "nav_msgs/MapMetaData", self.stamp(time), 0.05, cells.shape[1], cells.shape[0], self.pose(-1, -2)
        )
        return self.make("nav_msgs/OccupancyGrid", self.header(time, "/map"), info, cells.reshape(-1).astype(np.int8))

    def odometry(self, time, frames=("odom", "base_footprint")):
        nothing = np.zeros(36)
        zero = self.make("geometry_msgs/Vector3", 0.0, 0.0, 0.0)
        twist = self.make("geometry_msgs/TwistWithCovariance", self.make("geometry_msgs/Twist", zero, zero), nothing)
        pose = self.make("geometry_msgs/PoseWithCovariance", self.pose(1.5, 2.5), nothing)
        return self.make("nav_msgs/Odometry", self.header(time, frames[0]), frames[1], pose, twist)

    def heard(self, sender, stamp):
        posed = self.make("geometry_msgs/PoseStamped", self.header(stamp, "map"), self.pose(0, 0))
        return self.make("adhoc_communication/MmRobotPosition", sender, posed)

    def positions(self, robot, x, y):
        return self.make("adhoc_communication/MmListOfPoints", [self.make("adhoc_communication/MmPoint", robot, x, y)])

    def status(self, time, robot, other, place):
        where = (*(place or (0.0, 0.0, 0.0)), np.zeros(9), 1.0, 9.0, 0.0, 0)
        placed = self.make("map_merger/RobotPlacement", other, place is not None, "", "", *where)
        return self.make(
            "map_merger/MergerStatus", self.header(time, "map"), robot, "distributed", "", [placed], [], ""
        )
