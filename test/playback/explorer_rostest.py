#!/usr/bin/env python3
"""The scene in which robot_0's explorer started in the recording is played to a new explorer: what it tells of its
frontiers, what it says in the auctions and where it drives have to be what they were then.

The messages of robot_1 are handed over in their recorded order, each when it is due: an answer once its auction is
open, others once the explorer knows the transform to robot_1 (if they came after its start).
"""

import math
import sys
import unittest
from typing import Any, Dict, List, Tuple

import rospy
import rostest
import tf2_ros
from adhoc_communication.msg import ExpAuction, MmPoint
from adhoc_communication.srv import SendExpAuction, SendExpAuctionResponse, SendExpFrontier, SendExpFrontierResponse
from comparison import differences, order, plain, report, stored
from map_merger.srv import TransformPoint, TransformPointResponse
from move_base_msgs.msg import MoveBaseActionGoal
from playback import DEADLINE_S, FOLDER, Collection, Listener, messages_received, played, wait_until
from std_srvs.srv import Trigger

BID_TOLERANCE, PLACE_TOLERANCE_M = 0.01, 0.01
PROBES = 3  # points that the explorer asks for at a time
SCENE = ("/map_merger/global_map", "/map_metadata", "/all_positions", "/frontiers", "/adhoc_communication/status")


class Surroundings:
    """Radio, map merger and navigation of robot_0."""

    def __init__(self) -> None:
        self.frontiers, self.auctions, self.probes = Collection(), Collection(), Collection()
        self.goals = Listener("move_base/goal", MoveBaseActionGoal)
        self._tree = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._tree)
        rospy.Service("adhoc_communication/send_frontier", SendExpFrontier, self._on_frontiers)
        rospy.Service("adhoc_communication/send_auction", SendExpAuction, self._on_auction)
        rospy.Service("map_merger/transformPoint", TransformPoint, self._on_point)

    def _on_frontiers(self, request: Any) -> SendExpFrontierResponse:
        self.frontiers.add(request.frontier)
        return SendExpFrontierResponse(1)

    def _on_auction(self, request: Any) -> SendExpAuctionResponse:
        self.auctions.add(request.auction)
        return SendExpAuctionResponse(1)

    def _on_point(self, request: Any) -> TransformPointResponse:
        point = request.point
        found = self._tree.lookup_transform("map", f"{point.src_robot}/map", rospy.Time(0)).transform
        yaw = 2.0 * math.atan2(found.rotation.z, found.rotation.w)
        x = found.translation.x + math.cos(yaw) * point.x - math.sin(yaw) * point.y
        y = found.translation.y + math.sin(yaw) * point.x + math.cos(yaw) * point.y
        self.probes.add((point.x, point.y))
        return TransformPointResponse(MmPoint("robot_0", x, y))


Kind = Tuple[str, int]


def kind(auction: ExpAuction) -> Kind:
    """What an auction message is, and of which auction."""
    if not auction.auction_status_message:
        return "answer", auction.auction_id
    return ("start" if auction.start_auction else "closing"), auction.auction_id


class Explorer(unittest.TestCase):
    def test_frontiers_auctions_and_goal_are_those_of_the_recording(self) -> None:
        expected = stored(FOLDER / "explorer.expected.bag")
        course = [topic for topic in order(FOLDER / "explorer.bag") if topic in ("auction", "map_merger/global_map")]
        from_robot_1 = Listener("played/auction", ExpAuction)
        self.around, self.taken, self.started = Surroundings(), 0, False
        self.auction = rospy.Publisher("auction", ExpAuction, queue_size=10)
        rospy.wait_for_service("explorer/start", DEADLINE_S)
        wait_until(lambda: self.auction.get_num_connections() > 0, "the explorer listens to auctions")
        with played("explorer.bag", "--rate=2", "auction:=played/auction"):
            for topic in course:
                if topic == "auction":
                    from_robot_1.wait_for(lambda messages: len(messages) > self.taken)
                    self.hand_over(from_robot_1.entries[self.taken])
                else:
                    self.start()
            lines = self.decisions(expected)
        if lines:
            self.fail(report("what the explorer decided", lines))

    def start(self) -> None:
        wait_until(lambda: all(self.received(topic) for topic in SCENE), "the explorer has the scene")
        self.started = rospy.ServiceProxy("explorer/start", Trigger)().success

    def received(self, topic: str) -> int:
        return messages_received("/explorer").get(topic, 0)

    def hand_over(self, message: ExpAuction) -> None:
        """The next message of robot_1, when it is due, and until the explorer has taken it."""
        what, auction_id = kind(message)
        if what == "answer":
            self.wait_for_auction(("start", auction_id))
        if self.started:
            # The second question for the transform follows the answers to the first one. Bids of a robot whose
            # transform is not known say nothing, and the first questions may come before the test has heard it.
            self.assertTrue(self.around.probes.wait_for(lambda probes: len(probes) > PROBES), "transform not asked for")
        self.auction.publish(message)
        self.taken += 1
        wait_until(lambda: self.received("/auction") >= self.taken, f"the explorer has {what} {auction_id} of robot_1")
        if what == "start":
            self.wait_for_auction(("answer", auction_id))

    def wait_for_auction(self, wanted: Kind) -> None:
        found = self.around.auctions.wait_for(lambda sent: wanted in [kind(auction) for auction in sent])
        self.assertTrue(found, f"the explorer did not send {wanted}")

    def decisions(self, expected: Dict[str, List[Any]]) -> List[str]:
        """Where frontiers, messages of the auctions and the goal after the last of them are not the expected ones."""
        closing = expected["auction"][-1]
        self.wait_for_auction(("closing", closing["auction_id"]))
        goals = len(self.around.goals.entries)
        self.assertTrue(self.around.goals.wait_for(lambda sent: len(sent) > goals), "no goal after the auctions")
        lines: List[str] = []
        frontiers = [plain(message) for message in self.around.frontiers.entries]
        lines += differences(expected["frontiers"][:1], frontiers[:1], PLACE_TOLERANCE_M, "frontiers")
        sent = {kind(auction): plain(auction) for auction in reversed(self.around.auctions.entries)}
        for auction in expected["auction"]:
            what, auction_id = kind(ExpAuction(**auction))
            lines += differences(auction, sent.get((what, auction_id)), BID_TOLERANCE, f"{what} {auction_id}")
        goal, observed = expected["move_base/goal"][-1], plain(self.around.goals.entries[-1])
        poses = (message["goal"]["target_pose"]["pose"] for message in (goal, observed))
        return lines + list(differences(*poses, PLACE_TOLERANCE_M, "goal"))


if __name__ == "__main__":
    rospy.init_node("explorer_rostest")
    rostest.rosrun("mr_test", "playback_explorer", Explorer, sys.argv)
