"""A stand-in for adhoc_communication and SLAM in tests of the node: records what is sent, publishes what would
arrive."""

import math
import threading
from operator import attrgetter

import numpy as np
import rospy
from adhoc_communication.msg import MmControl, MmMapUpdate, MmRobotPosition, Status
from adhoc_communication.srv import (
    GetNeighbors,
    GetNeighborsResponse,
    SendMessage,
    SendMessageResponse,
    SendMmControl,
    SendMmControlResponse,
    SendMmMapUpdate,
    SendMmMapUpdateResponse,
    SendMmRobotPosition,
    SendMmRobotPositionResponse,
    SendOccupancyGrid,
    SendOccupancyGridResponse,
)
from nav_msgs.msg import OccupancyGrid as OccupancyGridMessage
from roslib.message import get_message_class
from std_msgs.msg import String

from map_merger import ros_io
from map_merger.synthetic import Survey, Surveyor, office_plan
from mr_grid import GridInfo, OccupancyGrid, Pose
from mr_grid.ros import grid_message

WAIT_S = 30.0
TOPICS = ("map_other", "map_meta_other", "control", "position_other_robots")


def building(yaw=1.0):
    """Two overlapping maps of one building and the true transform source -> target."""
    random = np.random.default_rng(5)
    surveyor = Surveyor(office_plan(random))
    survey = Survey(path_length=25.0)
    target = surveyor.explore(random, survey)
    source = surveyor.explore(random, survey, start=tuple(target.path[0, :2]), yaw=yaw)
    return target.grid, source.grid, target.start.inverse().compose(source.start)


def small_map(rows=20, columns=30, x=-0.5, y=-0.5):
    """A room with walls all round."""
    cells = np.zeros((rows, columns), np.int8)
    cells[[0, -1]] = 100
    cells[:, [0, -1]] = 100
    return OccupancyGrid(GridInfo(columns, rows, 0.05, Pose(x, y, 0.0)), cells)


def typed(request):
    """The message of any type that a send_message request holds; AssertionError if it is not what the request says."""
    kind = get_message_class(request.type)
    assert kind is not None and request.md5sum == kind._md5sum, f"not a {request.type}: {request.md5sum}"
    return kind().deserialize(request.data)


class FakeAdhoc:
    """Services of adhoc_communication under `prefix`; `sent` holds (service, destination, topic, payload)."""

    def __init__(self, prefix="", neighbors=(), refuse=(), topics=TOPICS):
        """`topics`: those of map updates, anchors, requests and positions."""
        self.sent = []
        self.refuse = set(refuse)
        self.largest_map = math.inf
        self._news = threading.Condition()
        self._prefix = prefix
        base = prefix + "adhoc_communication/"
        self._services = [
            rospy.Service(
                base + "send_map_update",
                SendMmMapUpdate,
                self._record("map_update", attrgetter("map_update"), SendMmMapUpdateResponse),
            ),
            rospy.Service(
                base + "send_map", SendOccupancyGrid, self._record("map", attrgetter("map"), SendOccupancyGridResponse)
            ),
            rospy.Service(
                base + "send_control_message",
                SendMmControl,
                self._record("control", attrgetter("msg"), SendMmControlResponse),
            ),
            rospy.Service(
                base + "send_position",
                SendMmRobotPosition,
                self._record("position", attrgetter("position"), SendMmRobotPositionResponse),
            ),
            rospy.Service(base + "send_message", SendMessage, self._record("message", typed, SendMessageResponse)),
            rospy.Service(base + "get_neighbors", GetNeighbors, lambda _: GetNeighborsResponse(list(neighbors))),
        ]
        self.map_other, self.meta_other, self.control, self.positions = (
            rospy.Publisher(prefix + topic, kind, queue_size=100)
            for topic, kind in zip(topics, (MmMapUpdate, OccupancyGridMessage, MmControl, MmRobotPosition))
        )
        self.new_robot = rospy.Publisher(base + "new_robot", String, queue_size=10, latch=True)
        self.status = rospy.Publisher(base + "status", Status, queue_size=10, latch=True)

    def _record(self, service, payload_of, response):
        def handle(request):
            if service == "map_update" and len(request.map_update.map.data) > self.largest_map:
                raise rospy.ServiceException("packet of 12.0 MB exceeds max_packet_size of 10.0 MB")
            with self._news:
                self.sent.append((service, request.dst_robot, request.topic, payload_of(request)))
                self._news.notify_all()
            if service in self.refuse:
                raise rospy.ServiceException("no route")
            return response(1)

        return handle

    def wait_for(self, accept):
        """The first record that `accept` takes; AssertionError if none comes."""
        deadline = rospy.get_time() + WAIT_S
        with self._news:
            while True:
                for record in self.sent:
                    if accept(*record):
                        return record
                remaining = deadline - rospy.get_time()
                assert remaining > 0.0, f"not sent; recorded: {[record[:3] for record in self.sent]}"
                self._news.wait(remaining)

    def wait_for_anchor(self, accept):
        """The first anchor that was sent and that `accept` takes; AssertionError if none comes."""
        record = self.wait_for(
            lambda service, to, topic, message: (
                (service, topic) == ("map", "map_meta_other") and accept(ros_io.anchor_of(message))
            )
        )
        return ros_io.anchor_of(record[3])

    def forget(self):
        """Drops the records."""
        with self._news:
            self.sent.clear()


class Latest:
    """The messages of a topic, to wait for one that fits."""

    def __init__(self, topic, kind):
        self._news = threading.Condition()
        self._messages = []
        self._subscriber = rospy.Subscriber(topic, kind, self._take, queue_size=100)

    def _take(self, message):
        with self._news:
            self._messages.append(message)
            del self._messages[:-50]
            self._news.notify_all()

    def wait_for(self, accept):
        """The newest message that `accept` takes; AssertionError if none comes."""
        deadline = rospy.get_time() + WAIT_S
        with self._news:
            while True:
                for message in reversed(self._messages):
                    if accept(message):
                        return message
                remaining = deadline - rospy.get_time()
                assert remaining > 0.0, f"no fitting message among {len(self._messages)}"
                self._news.wait(remaining)


def connected(publisher):
    """Waits until somebody listens."""
    deadline = rospy.get_time() + WAIT_S
    rate = rospy.Rate(50)
    while not publisher.get_num_connections():
        assert rospy.get_time() < deadline, f"nobody listens to {publisher.name}"
        rate.sleep()
    return publisher


def map_message(grid, frame="map"):
    """A map as SLAM publishes it."""
    message = grid_message(grid, frame, rospy.Time.now())
    plain = OccupancyGridMessage(message.header, message.info, message.data.tolist())
    return plain


def plain_anchor(anchor):
    """An anchor as an ordinary message."""
    message = ros_io.anchor_message(anchor)
    return OccupancyGridMessage(message.header, message.info, [])


def plain_tile(tile):
    """A tile as an ordinary message."""
    message = ros_io.tile_message(tile)
    return MmMapUpdate(
        message.src_robot,
        message.update_numbers.tolist(),
        OccupancyGridMessage(message.map.header, message.map.info, message.map.data.tolist()),
    )
