"""ROS node of the explorer: maps topics, services and the move_base action to calls of the agent and back."""

import functools
import io
import os
import threading
import time
from typing import Any, Callable, Dict, Optional, Tuple

import actionlib
import rospy
import scipy.optimize  # both are imported where decisions first need them, and a mission must not wait for that
import scipy.spatial  # noqa: F401
import tf2_ros
from adhoc_communication.msg import ExpAuction, ExpFrontier, MmListOfPoints, Status
from adhoc_communication.srv import SendExpAuction, SendExpFrontier, SendMessage
from geometry_msgs.msg import PointStamped
from map_merger.msg import MergerStatus
from map_merger.srv import LogMaps, TransformPoint
from move_base_msgs.msg import MoveBaseAction
from nav_msgs.msg import GridCells, MapMetaData, OccupancyGrid
from rospy.numpy_msg import numpy_msg
from std_msgs.msg import String
from std_srvs.srv import Empty, EmptyResponse, Trigger, TriggerResponse
from visualization_msgs.msg import MarkerArray

from explorer import logs, messages, options, ros_io, ros_team, ros_verdicts
from explorer.agent import ExplorerAgent
from explorer.answer import Answer
from explorer.call_queue import CALLS, HANDOVER, CallQueue
from explorer.decision import Decision
from explorer.errors import ExplorerError
from explorer.memory import Memory, memory_of
from explorer.msg import ExplorationState, ExplorationStatus, TeamOrder, TeamVerdicts
from explorer.names import CLUSTER_GRIDS, names_for
from explorer.ros_markers import FrontierMarkers
from explorer.scene_folder import recorder
from mr_grid import Pose
from mr_grid.imaging import use_threads
from mr_grid.map_frame import MapFrame, MapRuns, NewFrame
from mr_grid.ros import CALL_FAILED
from mr_grid.ros_map_frame import FrameListener, run_of_map
from mr_grid.ros_node import init_node, until_shutdown, warn_of_unknown_parameters
from mr_grid.rounds import Rounds

TICK = 0.1  # s of wall time
STATUS_PERIOD = 1.0  # s of ROS time between two messages on ~status
PICTURE_PERIOD = 2.0  # s of ROS time between two updates of the visualisation
MESSAGE_FIELDS = {"send_frontier": "frontier", "send_auction": "auction"}  # of the services' requests
OUTCOMES = {
    actionlib.GoalStatus.SUCCEEDED: messages.REACHED,
    actionlib.GoalStatus.PREEMPTED: messages.REPLACED,
    actionlib.GoalStatus.RECALLED: messages.REPLACED,
}


class Worker:
    """Threads that make blocking calls, in the order of a `CallQueue`."""

    def __init__(self, name: str, threads: int, calls: CallQueue) -> None:
        self._name = name
        self._calls = calls
        self._ready = threading.Condition()
        for _ in range(threads):
            threading.Thread(target=self._run, daemon=True).start()

    def do(self, call: Callable[[], None]) -> None:
        with self._ready:
            if not self._calls.put(call):
                rospy.logwarn_throttle(30.0, f"explorer: {self._name} is too slow, the oldest call is dropped")
            self._ready.notify_all()

    def _run(self) -> None:
        while not rospy.is_shutdown():
            number, call = self._take()
            try:
                call()
            except CALL_FAILED as error:
                rospy.logwarn_throttle(30.0, f"explorer: {self._name}: {error}")
            finally:
                with self._ready:
                    self._calls.ended(number)
                    self._ready.notify_all()

    def _take(self) -> Tuple[int, Callable[[], None]]:
        with self._ready:
            while True:
                taken = self._calls.take(time.monotonic())
                if taken is not None:
                    return taken
                self._ready.wait(self._calls.pause(time.monotonic()))


class ExplorerNode:
    """Owns the agent; a lock guards it, effects are carried out outside of the lock."""

    def __init__(self, given: options.Options) -> None:
        self._options = given
        self._names = names_for(given)
        self._frame = given.move_base_frame.strip("/")
        self._agent = ExplorerAgent(given, self._recording())
        self._lock = threading.Lock()
        self._runs = MapRuns()
        self._wake = threading.Event()
        self._rounds = Rounds()
        self._wire = ros_io.Wire(given)
        self._markers = FrontierMarkers(self._frame)
        self._radio = Worker("adhoc_communication", 3, CallQueue(CALLS, HANDOVER))
        # Bids depend on nothing that is sent before, and an auctioneer waits for them.
        self._bids = Worker("adhoc_communication", 2, CallQueue(CALLS, HANDOVER))
        self._merger = Worker("map_merger", 1, CallQueue(20))
        self._remembers = rospy.has_param("~memory")
        self._recall: Optional[Memory] = self._former_mission()
        self._kept = self._recall
        self._log_folder = self._make_log_folder()
        self._drawn = 0
        self._draw_time = -PICTURE_PERIOD
        self._merging = ""  # what map_merger says of itself
        self._state_sent: Any = None
        self._state_time = 0.0
        self._status_sent = b""
        self._status_time = -STATUS_PERIOD
        self._home_sent = False
        self._publishers = self._advertise()
        self._services = self._proxies()
        self._tf = tf2_ros.Buffer(rospy.Duration(5.0))
        frame = MapFrame(self._frame, given.base_link.strip("/"))
        self._tf_listener = FrameListener(self._tf, frame, self._on_new_frame)
        # Not the simple client: that one reports an error for each goal that replaces another.
        self._move_base = actionlib.ActionClient(self._names.action, MoveBaseAction)
        self._handle: Any = None
        self._subscribe()
        self._offer()

    # ---- set-up ---------------------------------------------------------------------------------------------------

    def _recording(self) -> Optional[Callable[[Decision], None]]:
        """Writes decisions in a thread of its own."""
        write = recorder(self._options)
        if write is None:
            return None
        worker = Worker("scene_path", 1, CallQueue(50))
        return lambda decision: worker.do(functools.partial(write, decision))

    def _former_mission(self) -> Optional[Memory]:
        """That of this node before it ended and was started again."""
        if not self._options.memory:
            return None
        try:
            return memory_of(self._options.memory)
        except ExplorerError as error:
            rospy.logwarn(f"explorer: {error}")
            return None

    def _make_log_folder(self) -> Optional[str]:
        if not self._options.log_path:
            return None
        folder = os.path.join(os.path.expanduser(self._options.log_path), "explorer", self._options.robot_name)
        try:
            os.makedirs(folder, exist_ok=True)
            if self._recall is None:
                with open(os.path.join(folder, "periodical.log"), "w") as file:
                    file.write(logs.PERIODICAL_HEADER)
        except OSError as error:
            raise ExplorerError(f"parameter ~log_path is {self._options.log_path!r}: {error}") from error
        return folder

    def _advertise(self) -> Dict[str, rospy.Publisher]:
        types = {
            "state": ExplorationState,
            "status": ExplorationStatus,
            "auctions": ExpAuction,
            "frontiers": MarkerArray,
            "visited": MarkerArray,
        }
        types.update({"goal": PointStamped, "home": PointStamped, "goal_unused": PointStamped})
        return {
            key: rospy.Publisher(name, types.get(key, GridCells), latch=key != "auctions", queue_size=10)
            for key, name in self._names.published.items()
        }

    def _proxies(self) -> Dict[str, rospy.ServiceProxy]:
        types = {"send_frontier": SendExpFrontier, "send_auction": SendExpAuction}
        types.update({"transform_point": TransformPoint, "log_output": LogMaps, "send_message": SendMessage})
        return {key: rospy.ServiceProxy(name, types[key]) for key, name in self._names.called.items()}

    def _subscribe(self) -> None:
        topics = self._names.subscribed
        rospy.Subscriber(topics["map"], numpy_msg(OccupancyGrid), self._on_map, queue_size=1, buff_size=2**24)
        rospy.Subscriber(topics["map_metadata"], MapMetaData, self._on_own_map, queue_size=1)
        rospy.Subscriber(topics["all_positions"], MmListOfPoints, self._on_positions, queue_size=10)
        rospy.Subscriber(topics["auction"], ExpAuction, self._on_auction, queue_size=100)
        rospy.Subscriber(topics["verdicts"], TeamVerdicts, self._on_verdicts, queue_size=100)
        rospy.Subscriber(topics["orders"], TeamOrder, self._on_team_order, queue_size=100)
        rospy.Subscriber(topics["merger_status"], MergerStatus, self._on_merger, queue_size=1)
        for topic in ("frontiers", "visited_frontiers", "negotiation_list"):
            rospy.Subscriber(topics[topic], ExpFrontier, self._on_frontiers, callback_args=topic, queue_size=100)
        rospy.Subscriber(topics["status"], Status, self._on_status, queue_size=10)
        rospy.Subscriber(topics["new_robot"], String, self._on_robot, callback_args=True, queue_size=100)
        rospy.Subscriber(topics["remove_robot"], String, self._on_robot, callback_args=False, queue_size=100)

    def _offer(self) -> None:
        agent = self._agent
        orders = {"start": agent.order_start, "pause": agent.pause, "resume": agent.resume}
        orders.update({"return_now": agent.return_now, "stop": agent.stop, "go_home": agent.go_home})
        for name, order in orders.items():
            rospy.Service(self._names.offered[name], Trigger, functools.partial(self._on_order, order))
        rospy.Service(self._names.offered["catch_up"], Empty, self._catch_up)

    # ---- input ----------------------------------------------------------------------------------------------------

    def _on_map(self, message: OccupancyGrid) -> None:
        try:
            occupancy = ros_io.map_from(message)
        except ExplorerError as error:
            rospy.logerr_throttle(10.0, f"explorer: {self._names.subscribed['map']}: {error}")
            return
        with self._lock:
            if self._runs.take(run_of_map(message), message.header.stamp.to_sec()):
                self._agent.on_global_map(occupancy, rospy.get_time())

    def _on_new_frame(self, new: NewFrame) -> None:
        with self._lock:
            self._runs.begin(new.until)
            self._agent.on_new_frame(new.shift, rospy.get_time())
            self._home_sent = False
        self._wake.set()

    def _on_own_map(self, _: MapMetaData) -> None:
        with self._lock:
            self._agent.on_own_map(rospy.get_time())

    def _on_positions(self, message: MmListOfPoints) -> None:
        with self._lock:
            self._agent.on_positions(ros_io.positions_from(message), rospy.get_time())

    def _on_frontiers(self, message: ExpFrontier, topic: str) -> None:
        elements = self._wire.elements_from(message)
        with self._lock:
            take = {
                "frontiers": self._agent.on_frontiers,
                "visited_frontiers": self._agent.on_visited_frontiers,
                "negotiation_list": self._agent.on_negotiation_list,
            }[topic]
            take(elements, rospy.get_time())

    def _on_auction(self, message: ExpAuction) -> None:
        auction = self._wire.auction_from(message)
        with self._lock:
            self._agent.on_auction(auction, rospy.get_time())
        self._wake.set()

    def _on_verdicts(self, message: TeamVerdicts) -> None:
        statement = ros_verdicts.statement_from(message)
        if statement is not None:
            with self._lock:
                self._agent.on_statement(statement, rospy.get_time())

    def _on_team_order(self, message: TeamOrder) -> None:
        with self._lock:
            self._agent.on_order(ros_team.order_from(message), rospy.get_time())
        self._wake.set()

    def _on_merger(self, message: MergerStatus) -> None:
        self._merging = message.text

    def _on_status(self, message: Status) -> None:
        if message.robot_name and message.robot_name != self._options.robot_name:
            rospy.logerr_throttle(
                60.0,
                f"explorer: this robot is {self._options.robot_name!r} here and {message.robot_name!r} in"
                " adhoc_communication; give both the same ~robot_name",
            )
        with self._lock:
            self._agent.on_robots(list(message.robots), rospy.get_time())

    def _on_robot(self, message: String, present: bool) -> None:
        with self._lock:
            self._agent.on_robot(message.data, present, rospy.get_time())

    def _on_order(self, order: Callable[[float], Answer], _: Any) -> TriggerResponse:
        with self._lock:
            answer = order(rospy.get_time())
        self._wake.set()
        return TriggerResponse(answer.done, answer.text)

    def _catch_up(self, _: Any) -> EmptyResponse:
        self._rounds.wait_for_whole_one(self._wake.set)
        return EmptyResponse()

    # ---- the loop -------------------------------------------------------------------------------------------------

    def run(self) -> None:
        last = -1.0
        while not rospy.is_shutdown():
            self._wake.wait(TICK)
            woken = self._wake.is_set()
            self._wake.clear()
            with self._rounds.next_one():
                now = rospy.get_time()
                if now > 0.0 and (now != last or woken):
                    last = now
                    self._step(now)

    def _step(self, now: float) -> None:
        pose = self._look_up_pose()
        with self._lock:
            if self._recall is not None:
                self._agent.recall(self._recall, now)
                self._recall = None
                rospy.logwarn("explorer: was started again, goes on with its mission")
            if pose is not None:
                self._agent.on_pose(pose, now)
            if self._options.autostart and self._agent.started_at is None and self._ready():
                self._agent.start(now)
            effects = self._agent.tick(now)
            state, memory = ros_io.state_to(self._agent.status(now)), self._agent.memory
        if self._remembers and memory != self._kept:
            self._keep(memory)
        for effect in effects:
            self._carry_out(effect)
        self._publish_state(state, now)
        self._publish_status(now)
        self._draw(now)

    def _keep(self, memory: Memory) -> None:
        try:
            rospy.set_param("~memory", memory.text())
            self._kept = memory
        except (rospy.ROSException, OSError) as error:
            rospy.logwarn_throttle(30.0, f"explorer: the master does not keep the mission: {error}")

    def _ready(self) -> bool:
        there = self._agent.map is not None and self._agent.pose is not None
        return there and self._move_base.pub_goal.get_num_connections() > 0

    def _look_up_pose(self) -> Optional[Pose]:
        try:
            return ros_io.pose_from(
                self._tf.lookup_transform(self._frame, self._options.base_link.strip("/"), rospy.Time(0))
            )
        except tf2_ros.TransformException as error:
            rospy.logdebug_throttle(10.0, f"explorer: {error}")
            return None

    # ---- effects --------------------------------------------------------------------------------------------------

    def _carry_out(self, effect: messages.Effect) -> None:
        if isinstance(effect, messages.SetGoal):
            self._set_goal(effect)
        elif isinstance(effect, messages.CancelGoal):
            if self._handle is not None:
                self._handle.cancel()
                self._handle = None
        elif isinstance(effect, (messages.SendFrontiers, messages.SendAuction)):
            call = self._wire.radio_call(effect)
            if isinstance(effect, messages.SendAuction):
                self._publishers["auctions"].publish(call[2])
            is_bid = isinstance(effect, messages.SendAuction) and not effect.auction.status
            (self._bids if is_bid else self._radio).do(lambda: self._send(*call))
        elif isinstance(effect, messages.SendStatement):
            said = ros_verdicts.verdicts_to(effect)
            self._radio.do(functools.partial(self._say, self._options.group, ros_verdicts.TOPIC, said))
        elif isinstance(effect, messages.SendState):
            told = ros_team.state_to(effect.state, self._merging)
            self._radio.do(functools.partial(self._say, effect.to, ros_team.STATES_TOPIC, told))
        elif isinstance(effect, messages.AskTransform):
            self._merger.do(lambda: self._ask_transform(effect.robot))
        elif isinstance(effect, messages.LogOutput):
            self._merger.do(lambda: self._log_output(effect.mask))
        elif isinstance(effect, messages.WriteLog):
            self._write_log(effect)
        else:
            (rospy.logwarn if effect.warning else rospy.loginfo)(f"explorer: {effect.text}")

    def _set_goal(self, effect: messages.SetGoal) -> None:
        stamp = rospy.Time.now()
        self._publishers["goal"].publish(ros_io.point_to(effect.pose.x, effect.pose.y, self._frame, stamp))

        def transition(handle: Any) -> None:
            state = handle.get_comm_state()
            if state == actionlib.CommState.ACTIVE:
                with self._lock:
                    self._agent.on_goal_accepted(effect.goal_id, rospy.get_time())
            elif state == actionlib.CommState.DONE:
                self._take_result(effect.goal_id, handle.get_goal_status(), handle.get_goal_status_text())

        goal = ros_io.goal_to(effect.pose, self._frame, stamp)
        self._handle = self._move_base.send_goal(goal, transition_cb=transition)

    def _take_result(self, goal_id: int, status: int, text: str) -> None:
        outcome = OUTCOMES.get(status, messages.FAILED)
        with self._lock:
            text = text or actionlib.GoalStatus.to_string(status)
            self._agent.on_goal_result(goal_id, outcome, text, rospy.get_time())
        self._wake.set()

    def _send(self, service: str, topic: str, message: Any) -> None:
        fields = {MESSAGE_FIELDS[service]: message}
        answer = self._services[service](dst_robot=self._options.group, topic=topic, **fields)
        if answer.status == 0:
            rospy.logwarn_throttle(30.0, f"explorer: {self._names.called[service]} could not deliver {topic}")

    def _say(self, destination: str, topic: str, message: Any) -> None:
        octets = io.BytesIO()
        message.serialize(octets)
        kind = {"type": message._type, "md5sum": message._md5sum, "definition": message._full_text}
        service = self._services[ros_verdicts.SERVICE]
        service(dst_robot=destination, topic=topic, data=octets.getvalue(), **kind)

    def _ask_transform(self, robot: str) -> None:
        images = [self._transform_point(robot, probe) for probe in ros_io.PROBES]
        with self._lock:
            self._agent.on_transform(robot, ros_io.transform_from(images), rospy.get_time())

    def _transform_point(self, robot: str, point: Any) -> Any:
        request = ros_io.named_point(robot, point)
        try:
            answer = self._services["transform_point"](request)
        except rospy.ServiceException:
            # The contract's answer while no transform to that robot is known.
            return None
        return (answer.point.x, answer.point.y)

    def _log_output(self, mask: int) -> None:
        self._services["log_output"](mask)

    def _write_log(self, effect: messages.WriteLog) -> None:
        if self._log_folder is None:
            return
        try:
            with open(os.path.join(self._log_folder, effect.name), "a" if effect.append else "w") as file:
                file.write(effect.text)
        except OSError as error:
            rospy.logwarn_throttle(60.0, f"explorer: cannot write the log: {error}")

    # ---- visualisation --------------------------------------------------------------------------------------------

    def _publish_state(self, state: ExplorationState, now: float) -> None:
        essence = (state.state, state.exploration_finished, state.has_goal)
        if essence != self._state_sent or abs(now - self._state_time) >= 1.0:
            self._state_sent, self._state_time = essence, now
            self._publishers["state"].publish(state)

    def _publish_status(self, now: float) -> None:
        """What is explored and why, when it has changed."""
        if abs(now - self._status_time) < STATUS_PERIOD:
            return
        self._status_time = now
        with self._lock:
            report = self._agent.report(now)
        message = ros_io.status_to(report, self._frame)
        content = io.BytesIO()
        message.serialize(content)  # NaN differs from itself, its bytes do not
        if content.getvalue() != self._status_sent:
            self._status_sent = content.getvalue()
            message.header.stamp = rospy.Time.from_sec(now)
            self._publishers["status"].publish(message)

    def _draw(self, now: float) -> None:
        with self._lock:
            home, revision = self._agent.home, self._agent.perception.revision
            if home is not None and not self._home_sent:
                self._home_sent = True
                self._publishers["home"].publish(ros_io.point_to(home.x, home.y, self._frame, rospy.Time.now()))
            if revision == self._drawn or abs(now - self._draw_time) < PICTURE_PERIOD:
                return
            self._drawn, self._draw_time = revision, now
            picture = self._agent.picture()
        stamp = rospy.Time.now()
        self._publishers["frontiers"].publish(self._markers.frontiers(picture, stamp))
        self._publishers["visited"].publish(self._markers.visited(picture, stamp))
        for index, grid in enumerate(ros_io.cluster_grids(picture, CLUSTER_GRIDS, self._frame, stamp)):
            self._publishers[f"cluster_{index}"].publish(grid)


def main() -> int:
    use_threads(1)  # one map is too little work to share out, and the robot's other nodes need the cores
    init_node("explorer")
    given = rospy.get_param("~", {})
    try:
        checked = options.load(given, rospy.get_param(options.ROBOTS_IN_SIMULATION.name, None))
        node = ExplorerNode(checked)
    except ExplorerError as error:
        rospy.logfatal(f"explorer: {error}")
        return 1
    warn_of_unknown_parameters(options.known_names())
    for line in options.warnings(given):
        rospy.logwarn(f"explorer: {line}")
    rospy.loginfo(f"explorer: {options.summary(checked)}")
    with until_shutdown():
        node.run()
    return 0
