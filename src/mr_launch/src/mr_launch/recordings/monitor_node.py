"""Lets the player of one robot go when everything listens and no faster than nodes come along, and tells the replay how
far they are."""

import threading
from typing import Any, List
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
from map_merger.srv import SaveMap
from sensor_msgs.msg import TimeReference
from std_srvs.srv import Empty, SetBool

from mr_grid.ros_node import init_node, until_shutdown
from mr_launch.monitor import RunnerLink

PERIOD = 0.2  # s of real time between two reports
PLAYER = "/player"
CATCH_UP = {"/map_merger": "/map_merger/catchUp", "/explorer": "/explorer/catch_up"}  # services, offered last, by node
PACE = 0.1  # s of recorded time between two questions whether the nodes have come along


class Pace:
    """Asks nodes again and again to catch up, and tells the player up to when they have: it does not run on ahead."""

    def __init__(self, nodes: List[str]) -> None:
        self.time = 0.0
        """Up to which recorded time the nodes have worked, s."""
        self._services = {name: _proxy_of(name) for name in (CATCH_UP[node] for node in nodes)}
        self._caught_up = rospy.Publisher("~caught_up", TimeReference, queue_size=1, latch=True)

    def follow(self) -> None:
        """Until ROS shuts down. A node that begins anew is waited for; of one that has ended the replay hears from
        roslaunch."""
        with until_shutdown():
            while not rospy.is_shutdown():
                self._take_a_step()

    def _take_a_step(self) -> None:
        now = rospy.Time.now()
        for service in self._services:
            self._wait_for(service)
        caught_up = TimeReference(time_ref=now, source="replay")
        caught_up.header.stamp = now
        self._caught_up.publish(caught_up)
        self.time = now.to_sec()
        # Not from here on: where the nodes took long, the player stands still by now.
        rospy.sleep(now + rospy.Duration.from_sec(PACE) - rospy.Time.now())

    def _wait_for(self, service: str) -> None:
        try:
            self._services[service]()
        except (rospy.ServiceException, rospy.ROSException) as error:
            rospy.loginfo("replay_monitor: %s", error)
            rospy.wait_for_service(service)
            self._services[service] = _proxy_of(service)


def _proxy_of(service: str) -> rospy.ServiceProxy:
    return rospy.ServiceProxy(service, Empty, persistent=True)


class ReplayMonitor:
    """Answers the replay's requests, reports."""

    def __init__(self) -> None:
        self._master = rosgraph.Master(rospy.get_name())
        self._robot = rospy.get_param("~robot_name")
        self._nodes = [f"/{name}" for name in rospy.get_param("~nodes").split()]
        self._link = RunnerLink(rospy.get_param("~report_socket"))
        self._missing = [PLAYER, *self._nodes]
        computing = [node for node in self._nodes if node in CATCH_UP]
        self._pace = Pace(computing) if computing else None
        self._news: dict = {}

    def run(self) -> None:
        while not rospy.is_shutdown():
            try:
                for request in self._link.requests(PERIOD):
                    self._answer(request)
                self._missing = self._missing and self._look()
                missing = [name.strip("/") for name in self._missing]
                time = self._pace.time if self._pace else rospy.get_time()
                self._link.send({"robot": self._robot, "missing": missing, "time": time, **self._news})
            except OSError:
                return  # the replay is over

    def _look(self) -> list:
        """What is not up yet, or not connected to all that the player will publish for it."""
        publishers, subscribers, services = (dict(entries) for entries in self._master.getSystemState())
        if PLAYER not in services.get(f"{PLAYER}/pause_playback", []):
            return self._missing
        player: Any = ServerProxy(self._master.lookupNode(PLAYER))
        connections = player.getBusInfo(rospy.get_name())[2]
        connected = {(entry[1], entry[4]) for entry in connections}
        played = {topic for topic, nodes in publishers.items() if PLAYER in nodes}
        return [node for node in self._nodes if not self._listens(node, played, subscribers, services, connected)]

    def _listens(self, node: str, played: set, subscribers: dict, services: dict, connected: set) -> bool:
        wanted = {topic for topic, nodes in subscribers.items() if node in nodes and topic in played}
        offers = CATCH_UP.get(node)
        return (
            bool(wanted) and (not offers or offers in services) and all((node, topic) in connected for topic in wanted)
        )

    def _answer(self, request: dict) -> None:
        try:
            if request["request"] == "go":
                if self._pace:
                    threading.Thread(target=self._pace.follow, daemon=True).start()
                rospy.ServiceProxy(f"{PLAYER}/pause_playback", SetBool)(False)
                self._news["started"] = True
            elif request["request"] == "save":
                rospy.ServiceProxy("map_merger/saveMap", SaveMap)(request["path"])
                self._news["saved"] = request["path"]
        except rospy.ServiceException as error:
            rospy.logerr("replay_monitor: %s: %s", request["request"], error)


def main() -> int:
    init_node("replay_monitor")
    try:
        monitor = ReplayMonitor()
    except (KeyError, OSError) as error:
        rospy.logfatal("replay_monitor: %s (started by replayed_robot.launch only)", error)
        return 1
    monitor.run()
    return 0
