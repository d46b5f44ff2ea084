#!/usr/bin/env python3
"""rostest: one explorer node among fakes explores a small hall to the end.

The fakes: a map whose right half becomes known when the robot gets there, tf, the services of adhoc_communication and
map_merger, a second robot that answers auctions, and a move_base action server that drives.
"""

import math
import os
import sys
import threading
import unittest
from typing import Any, Callable, List, Optional, Tuple

import actionlib
import numpy as np
import rospy
import rostest
import tf2_ros
from adhoc_communication.msg import ExpAuction, ExpCluster, MmListOfPoints, MmPoint, Status
from adhoc_communication.srv import (
    SendExpAuction,
    SendExpAuctionResponse,
    SendExpFrontier,
    SendExpFrontierResponse,
    SendMessage,
    SendMessageResponse,
)
from explorer.msg import ExplorationState, ExplorationStatus, TeamVerdicts
from explorer.srv import SetLimits
from geometry_msgs.msg import PointStamped, TransformStamped
from map_merger.srv import LogMaps, LogMapsResponse, TransformPoint, TransformPointResponse
from move_base_msgs.msg import MoveBaseAction, MoveBaseResult
from nav_msgs.msg import GridCells, MapMetaData, OccupancyGrid
from std_srvs.srv import Empty, Trigger
from visualization_msgs.msg import MarkerArray

WIDTH, HEIGHT, RESOLUTION = 240, 120, 0.05
ORIGIN = (-1.0, -3.0)


class FakeRobot:
    """Everything around the explorer of robot_0."""

    def __init__(self) -> None:
        self.x, self.y, self.yaw = 0.0, 0.0, 0.0
        self.known = 90
        self.sent_frontiers: List[Any] = []
        self.sent_auctions: List[Any] = []
        self.said: List[TeamVerdicts] = []
        self.log_masks: List[int] = []
        self.goals: List[Tuple[float, float]] = []
        self.may_drive = threading.Event()
        self.map_publisher = rospy.Publisher("map_merger/global_map", OccupancyGrid, queue_size=1, latch=True)
        self.meta_publisher = rospy.Publisher("map_metadata", MapMetaData, queue_size=1, latch=True)
        self.auction_publisher = rospy.Publisher("auction", ExpAuction, queue_size=10, latch=True)
        self.verdicts_publisher = rospy.Publisher("explorer/verdicts", TeamVerdicts, queue_size=1)
        self.status_publisher = rospy.Publisher("adhoc_communication/status", Status, queue_size=1, latch=True)
        self.positions_publisher = rospy.Publisher("all_positions", MmListOfPoints, queue_size=1)
        self.tf = tf2_ros.TransformBroadcaster()
        rospy.Service("adhoc_communication/send_frontier", SendExpFrontier, self.on_frontier)
        rospy.Service("adhoc_communication/send_auction", SendExpAuction, self.on_auction)
        rospy.Service("adhoc_communication/send_message", SendMessage, self.on_message)
        rospy.Service("map_merger/transformPoint", TransformPoint, self.on_transform)
        rospy.Service("map_merger/logOutput", LogMaps, self.on_log)
        self.move_base = actionlib.SimpleActionServer("move_base", MoveBaseAction, self.drive, auto_start=False)
        self.move_base.start()
        rospy.Timer(rospy.Duration(0.05), self.on_timer)
        rospy.Timer(rospy.Duration(1.0), self.on_slow_timer)

    def cells(self) -> np.ndarray:
        cells = np.full((HEIGHT, WIDTH), -1, dtype=np.int8)
        cells[:, : self.known] = 0
        cells[0, : self.known] = cells[-1, : self.known] = 100
        cells[:, 0] = 100
        if self.known >= WIDTH:
            cells[:, -1] = 100
        return cells

    def on_timer(self, _: Any) -> None:
        message = TransformStamped()
        message.header.stamp = rospy.Time.now()
        message.header.frame_id, message.child_frame_id = "map", "base_link"
        message.transform.translation.x, message.transform.translation.y = self.x, self.y
        message.transform.rotation.z, message.transform.rotation.w = math.sin(self.yaw / 2), math.cos(self.yaw / 2)
        self.tf.sendTransform(message)

    def on_slow_timer(self, _: Any) -> None:
        self.known = max(self.known, min(WIDTH, int((self.x - ORIGIN[0] + 4.0) / RESOLUTION)))
        message = OccupancyGrid()
        message.header.frame_id, message.header.stamp = "map", rospy.Time.now()
        message.info.resolution, message.info.width, message.info.height = RESOLUTION, WIDTH, HEIGHT
        message.info.origin.position.x, message.info.origin.position.y = ORIGIN
        message.info.origin.orientation.w = 1.0
        message.data = self.cells().reshape(-1).tolist()
        self.map_publisher.publish(message)
        self.meta_publisher.publish(message.info)
        self.status_publisher.publish(Status(robot_name="robot_0", robots=["robot_1"]))
        self.positions_publisher.publish(MmListOfPoints([MmPoint("robot_1", 0.0, 2.0)]))

    def on_frontier(self, request: Any) -> SendExpFrontierResponse:
        self.sent_frontiers.append(request)
        return SendExpFrontierResponse(1)

    def on_auction(self, request: Any) -> SendExpAuctionResponse:
        self.sent_auctions.append(request)
        if request.auction.start_auction:
            reply = ExpAuction(auction_id=request.auction.auction_id, robot_name="robot_1")
            reply.requested_clusters = request.auction.available_clusters  # the unit of its bids
            reply.available_clusters = [ExpCluster(c.ids_contained, 50.0) for c in request.auction.requested_clusters]
            self.auction_publisher.publish(reply)
        return SendExpAuctionResponse(1)

    def on_message(self, request: Any) -> SendMessageResponse:
        """What robot_0 says comes back as if robot_1 said that it has ended."""
        assert (request.dst_robot, request.topic) == ("mc_robot_0", "explorer/verdicts"), request
        assert (request.type, request.md5sum) == ("explorer/TeamVerdicts", TeamVerdicts._md5sum)
        self.said.append(TeamVerdicts().deserialize(request.data))
        self.verdicts_publisher.publish(TeamVerdicts("robot_1", 1, len(self.said), TeamVerdicts.ENDED, 0.0, [], []))
        return SendMessageResponse(1)

    def on_transform(self, request: Any) -> TransformPointResponse:
        point = request.point
        return TransformPointResponse(MmPoint("robot_0", point.x + 1.0, point.y))

    def on_log(self, request: Any) -> LogMapsResponse:
        self.log_masks.append(request.log)
        return LogMapsResponse()

    def drive(self, goal: Any) -> None:
        target = goal.target_pose.pose.position
        assert goal.target_pose.header.frame_id == "map"
        self.goals.append((target.x, target.y))
        rate = rospy.Rate(20)
        while not rospy.is_shutdown():
            if self.move_base.is_preempt_requested():
                self.move_base.set_preempted()
                return
            gap = math.hypot(target.x - self.x, target.y - self.y)
            if gap < 0.05:
                self.move_base.set_succeeded(MoveBaseResult())
                return
            step = min(gap, 0.1) if self.may_drive.is_set() else 0.0
            self.x += step * (target.x - self.x) / gap
            self.y += step * (target.y - self.y) / gap
            rate.sleep()


class FirstStatus:
    """The first status of that kind, listened for from now on: the mission may be over before a test asks for it."""

    def __init__(self, wanted: Callable[[ExplorationStatus], bool]) -> None:
        self._wanted, self._found = wanted, threading.Event()
        self._last: Optional[ExplorationStatus] = None
        self._subscriber = rospy.Subscriber("explorer/status", ExplorationStatus, self._take)

    def _take(self, status: ExplorationStatus) -> None:
        if not self._found.is_set():
            self._last = status
            if self._wanted(status):
                self._found.set()

    def wait(self, seconds: float) -> ExplorationStatus:
        if not self._found.wait(seconds):
            raise AssertionError(f"no such status, last: {self._last}")
        self._subscriber.unregister()
        assert self._last is not None
        return self._last


class TestNode(unittest.TestCase):
    fake: FakeRobot

    @classmethod
    def setUpClass(cls) -> None:
        cls.fake = FakeRobot()

    def wait_for_state(self, wanted: Any, seconds: float) -> ExplorationState:
        done = threading.Event()
        seen: List[ExplorationState] = []

        def take(state: ExplorationState) -> None:
            seen.append(state)
            if wanted(state):
                done.set()

        subscriber = rospy.Subscriber("explorer/state", ExplorationState, take)
        self.assertTrue(done.wait(seconds), f"state not reached, last: {seen[-1:]}")
        subscriber.unregister()
        return seen[-1]

    def test_explores_to_the_end(self) -> None:
        fake = self.fake
        self.wait_for_state(lambda s: s.state == ExplorationState.STARTING, 20)
        self.assertEqual(fake.goals, [], "the node must wait for ~start")
        start = rospy.ServiceProxy("explorer/start", Trigger)
        start.wait_for_service(10)
        status = FirstStatus(lambda s: s.team_finished and s.has_goal)
        self.assertTrue(start().success)
        self.assertFalse(start().success)
        self.wait_for_state(lambda s: s.has_goal, 20)
        self.check_pictures()
        self.check_orders()
        self.check_status(status.wait(20))
        fake.may_drive.set()
        state = self.wait_for_state(lambda s: s.state == ExplorationState.FINISHED, 80)
        self.assertTrue(state.exploration_finished)
        self.assertGreater(state.exploration_time, 3.0)
        self.assertGreaterEqual(state.auctions_completed, 1)
        self.check_messages()
        self.check_statements()
        self.check_goals()
        self.check_logs()

    def check_orders(self) -> None:
        orders = {name: rospy.ServiceProxy(f"explorer/{name}", Trigger) for name in ("pause", "resume")}
        self.assertEqual(orders["resume"]().message, "is not paused")
        self.assertTrue(orders["pause"]().success)
        state = self.wait_for_state(lambda s: s.state == ExplorationState.WAITING, 5)
        self.assertEqual((state.text, state.has_goal), ("is paused", False))
        self.assertTrue(orders["resume"]().success)
        self.wait_for_state(lambda s: s.has_goal, 10)
        limited = rospy.ServiceProxy("explorer/set_limits", SetLimits)(600.0, 0.0)
        self.assertEqual((limited.success, limited.message), (True, "ends after 600 s"))
        rospy.ServiceProxy("explorer/catch_up", Empty)()
        self.assertEqual(rospy.get_param("explorer/time_limit"), 600.0)

    def check_status(self, status: ExplorationStatus) -> None:
        self.assertEqual((status.robot_name, status.header.frame_id), ("robot_0", "map"))
        self.assertEqual((status.strategy, status.bid_unit), ("coordinated", 7))
        self.assertEqual((list(status.team), list(status.team_finished)), (["robot_1"], ["robot_1"]))
        self.assertIn("bid ", status.goal_reason)
        self.assertTrue(status.auction and all(offer.bids[0].robot_name == "robot_0" for offer in status.auction))
        self.assertGreater(status.area_known, 20.0)

    def check_statements(self) -> None:
        stages = [said.stage for said in self.fake.said]
        self.assertEqual((stages[0], stages[-1]), (TeamVerdicts.EXPLORING, TeamVerdicts.ENDED))
        self.assertEqual([said.number for said in self.fake.said], list(range(1, len(stages) + 1)))
        self.assertEqual(self.fake.said[-1].robot_name, "robot_0")

    def check_pictures(self) -> None:
        markers = rospy.wait_for_message("frontierPoints", MarkerArray, 10)
        self.assertEqual(markers.markers[0].ns, "my_namespace")
        self.assertAlmostEqual(markers.markers[0].scale.x, 0.2)
        for point in markers.markers[0].points:
            self.assertGreater(point.x, 3.0)
        home = rospy.wait_for_message("homePoint/homePoint", PointStamped, 10)
        self.assertAlmostEqual(home.point.x, 0.0, places=3)
        goal = rospy.wait_for_message("goalPoint/goalPoint", PointStamped, 10)
        self.assertEqual(goal.header.frame_id, "map")
        grids = [rospy.wait_for_message(f"cluster_grid_{i}", GridCells, 10) for i in range(20)]
        filled = [grid for grid in grids if grid.cells[0].x < 999]
        self.assertTrue(filled)
        self.assertTrue(all(grid.cells[0].x == 1000.0 for grid in grids if grid not in filled))

    def check_messages(self) -> None:
        fake = self.fake
        self.assertTrue(all(request.dst_robot == "mc_robot_0" for request in fake.sent_frontiers + fake.sent_auctions))
        topics = {request.topic for request in fake.sent_frontiers}
        self.assertIn("frontiers", topics)
        self.assertIn("visited_frontiers", topics)
        element = fake.sent_frontiers[0].frontier.frontier_element[0]
        self.assertEqual(element.detected_by_robot_str, "robot_0")
        starts = [r.auction for r in fake.sent_auctions if r.auction.start_auction]
        closings = [r.auction for r in fake.sent_auctions if r.auction.auction_finished]
        self.assertTrue(all(r.auction.auction_status_message for r in fake.sent_auctions))
        self.assertIn(starts[0].auction_id, [closing.auction_id for closing in closings])
        offered = {e.id for c in starts[0].requested_clusters for e in c.ids_contained}
        won = next(c for c in closings if c.auction_id == starts[0].auction_id)
        self.assertTrue(won.occupied_ids)
        self.assertTrue({e.id for e in won.occupied_ids} & offered)

    def check_goals(self) -> None:
        goals = self.fake.goals
        for _, y in goals:
            self.assertLess(abs(y), 3.0 - 0.25)
        self.assertGreater(max(x for x, _ in goals), 2.0)
        self.assertLess(math.hypot(*goals[-1]), 0.1, "the last goal is the start pose")
        self.assertLess(math.hypot(self.fake.x, self.fake.y), 0.5)

    def check_logs(self) -> None:
        folder = os.path.join(rospy.get_param("~log_path"), "explorer", "robot_0")
        with open(os.path.join(folder, "exploration.log")) as file:
            text = file.read()
        self.assertTrue(text.startswith("[Exploration]\n"))
        self.assertIn("complete=1", text)
        self.assertIn(3, self.fake.log_masks)


if __name__ == "__main__":
    rospy.init_node("node_rostest")
    rostest.rosrun("explorer", "explorer_node", TestNode, sys.argv)
