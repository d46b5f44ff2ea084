"""Reports one robot's progress, or a base station's, to the team runner (its own master, Unix socket to the runner)."""

from pathlib import Path

import rospy
from adhoc_communication.msg import ExpAuction, Status
from explorer.msg import ExplorationState, ExplorationStatus
from map_merger.msg import MergerStatus
from move_base_msgs.msg import MoveBaseActionFeedback, MoveBaseActionGoal, MoveBaseActionResult
from nav_msgs.msg import OccupancyGrid
from rosgraph_msgs.msg import Log
from rospy.numpy_msg import numpy_msg
from std_srvs.srv import Trigger

from mr_grid import Pose, pose_of
from mr_grid.ros import grid_value, pose_value
from mr_grid.ros_node import init_node
from mr_launch.maps import save_raw
from mr_launch.merger_status import transforms_of
from mr_launch.monitor import Digest, RunnerLink
from mr_launch.ros_io import OUTCOMES, offers_of, radio_values, state_values
from mr_launch.world import Meter, own_map_file
from mr_measures.occupancy import free_area
from mr_measures.record.logs import FAILED

PERIOD = 1.0  # s of real time between two reports
TALKERS = ("explorer", "map_merger")  # whose plain news are kept, too
LARGE = 1 << 24  # octets; receive buffer for maps


class Monitor:
    """Subscribes and reports what a base station and a robot have."""

    def __init__(self) -> None:
        self._digest = Digest(rospy.get_param("~robot_name"))
        self._link = RunnerLink(rospy.get_param("~report_socket"))
        rospy.Subscriber("adhoc_communication/status", Status, self._on_status, queue_size=2)
        rospy.Subscriber("rosout", Log, self._on_log, queue_size=50)

    def run(self) -> None:
        while not rospy.is_shutdown():
            try:
                for request in self._link.requests(PERIOD):
                    self._answer(request)
                self._look()
                self._link.send(self._digest.report(rospy.get_time()))
            except OSError:
                return  # the runner is gone, and with it the mission

    def _answer(self, request: dict) -> None:
        """A base station is asked for nothing."""

    def _look(self) -> None:
        """Before each report."""

    def _on_status(self, message: Status) -> None:
        self._digest.seen("adhoc_communication")
        self._digest.set(**radio_values(message))

    def _on_log(self, message: Log) -> None:
        if message.level >= (Log.INFO if message.name.rsplit("/", 1)[-1] in TALKERS else Log.WARN):
            self._digest.note(message.msg, message.level >= Log.WARN, rospy.get_time())


class RobotMonitor(Monitor):
    """Answers the runner's requests, too."""

    def __init__(self) -> None:
        super().__init__()
        start = pose_of(rospy.get_param("~start_pose").split())
        self._begin(start)
        rospy.Subscriber("map", numpy_msg(OccupancyGrid), self._on_own_map, queue_size=1, buff_size=LARGE)
        rospy.Subscriber("map_merger/global_map", numpy_msg(OccupancyGrid), self._on_map, queue_size=1, buff_size=LARGE)
        rospy.Subscriber("explorer/state", ExplorationState, self._on_state, queue_size=2)
        rospy.Subscriber("map_merger/status", MergerStatus, self._on_merger, queue_size=2)
        rospy.Subscriber("explorer/status", ExplorationStatus, self._on_exploration, queue_size=2)
        rospy.Subscriber("explorer/sent_auctions", ExpAuction, self._on_auction, queue_size=50)
        rospy.Subscriber("auction", ExpAuction, self._on_heard_auction, queue_size=50)
        rospy.Subscriber("move_base/goal", MoveBaseActionGoal, self._on_goal, queue_size=50)
        rospy.Subscriber("move_base/feedback", MoveBaseActionFeedback, self._on_feedback, queue_size=50)
        rospy.Subscriber("move_base/result", MoveBaseActionResult, self._on_goal_end, queue_size=50)

    def _begin(self, start: Pose) -> None:
        """The map begins there, world frame."""
        self._meter = Meter(rospy.get_param("~truth_file"), start)
        self._map = None
        self._measured = None
        self._own_map = None

    def _look(self) -> None:
        self._look_for_move_base()
        self._measure()

    def _on_own_map(self, message: OccupancyGrid) -> None:
        self._own_map = message
        begun = message.info.map_load_time
        self._digest.set(map_begun=(begun.secs, begun.nsecs), map_stamp=message.header.stamp.to_sec())
        if "map" in self._digest.missing and (message.data >= 0).any():
            self._digest.seen("map")

    def _on_map(self, message: OccupancyGrid) -> None:
        if message.info.width and message.info.height:
            self._map = message
            self._digest.seen("map_merger")

    def _on_state(self, message: ExplorationState) -> None:
        self._digest.seen("explorer")
        self._digest.set(**state_values(message))

    def _on_merger(self, message: MergerStatus) -> None:
        self._digest.believes(transforms_of(message), rospy.get_time())

    def _on_auction(self, message: ExpAuction) -> None:
        if not message.auction_status_message:
            self._digest.bid()
        elif message.start_auction:
            self._digest.auction(message.auction_id, len(message.requested_clusters), rospy.get_time())

    def _on_heard_auction(self, message: ExpAuction) -> None:
        if not message.auction_status_message:
            self._digest.answer(message.auction_id, message.robot_name.strip("/"), rospy.get_time())

    def _on_exploration(self, message: ExplorationStatus) -> None:
        self._digest.auction_result(message.auction_id, message.bid_unit, offers_of(message), rospy.get_time())

    def _on_goal(self, message: MoveBaseActionGoal) -> None:
        place = message.goal.target_pose.pose.position
        self._digest.goal(message.goal_id.id, place.x, place.y, rospy.get_time())

    def _on_goal_end(self, message: MoveBaseActionResult) -> None:
        status = message.status
        self._digest.goal_end(status.goal_id.id, OUTCOMES.get(status.status, FAILED), status.text, rospy.get_time())

    def _on_feedback(self, message: MoveBaseActionFeedback) -> None:
        place = message.feedback.base_position
        self._digest.located(pose_value(place.pose), place.header.stamp.to_sec())

    def _look_for_move_base(self) -> None:
        if "move_base" in self._digest.missing:
            name = rospy.resolve_name("move_base/status")
            if any(topic == name for topic, _ in rospy.get_published_topics()):
                self._digest.seen("move_base")

    def _measure(self) -> None:
        if self._map is not None and self._map is not self._measured:
            message = self._map
            grid = grid_value(message)
            coverage = self._meter.coverage(grid)
            self._digest.set(coverage=coverage, explored=round(free_area(grid.cells, grid.resolution), 3))
            if coverage is not None:  # without the reference it is looked at again
                self._measured = message
        if self._own_map is not None and self._meter.is_due(rospy.get_time()):
            own = grid_value(self._own_map)
            self._meter.look(own, rospy.get_time())
            self._digest.set(own=round(free_area(own.cells, own.resolution), 3))

    def _answer(self, request: dict) -> None:
        if request.get("request") == "start":
            self._start()
        elif request.get("request") == "begin":
            self._begin(Pose(*request["start"]))
        elif request.get("request") == "save" and self._map is not None:
            path = Path(request["path"])
            if self._own_map is not None:
                own = grid_value(self._own_map)
                self._meter.look(own, rospy.get_time())
                save_raw(own, own_map_file(path))
            self._meter.save(path)
            save_raw(grid_value(self._map), path)
            self._digest.set(saved=request["path"])

    def _start(self) -> None:
        try:
            answer = rospy.ServiceProxy("explorer/start", Trigger)()
        except rospy.ServiceException as error:
            self._digest.set(start_error=str(error))
            return
        if answer.success:
            self._digest.set(started=True, start_time=rospy.get_time())
        else:
            self._digest.set(start_error=answer.message or "explorer/start was refused")


def main() -> int:
    init_node("monitor")
    try:
        monitor = RobotMonitor() if rospy.get_param("~has_body", True) else Monitor()
    except (KeyError, ValueError, OSError) as error:
        rospy.logfatal("monitor: %s (started by `rosrun mr_launch team` only)", error)
        return 1
    monitor.run()
    return 0
