"""Lets the player of one robot go when everything listens, and tells the replay how far it is."""

from typing import Any
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
from map_merger.srv import SaveMap
from std_srvs.srv import SetBool

from mr_grid.ros_node import init_node
from mr_launch.monitor import RunnerLink

PERIOD = 0.2  # s of real time between two reports
PLAYER = "/player"
OFFERED_LAST = {"/map_merger": "/map_merger/transformPoint", "/explorer": "/explorer/start"}  # services, by node


class ReplayMonitor:
    """Answers the replay's requests, reports."""

    def __init__(self) -> None:
        self._master = rosgraph.Master(rospy.get_name())
        self._robot = rospy.get_param("~robot_name")
        self._nodes = [f"/{name}" for name in rospy.get_param("~nodes").split()]
        self._link = RunnerLink(rospy.get_param("~report_socket"))
        self._missing = [PLAYER, *self._nodes]
        self._news: dict = {}

    def run(self) -> None:
        while not rospy.is_shutdown():
            try:
                for request in self._link.requests(PERIOD):
                    self._answer(request)
                self._missing = self._missing and self._look()
                missing = [name.strip("/") for name in self._missing]
                self._link.send({"robot": self._robot, "missing": missing, "time": rospy.get_time(), **self._news})
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
        offers = OFFERED_LAST.get(node)
        return (
            bool(wanted) and (not offers or offers in services) and all((node, topic) in connected for topic in wanted)
        )

    def _answer(self, request: dict) -> None:
        try:
            if request["request"] == "go":
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
