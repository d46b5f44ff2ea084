"""ROS node of the explorer: maps topics, services and the move_base action to calls of the agent and back."""

import functools
import threading
from typing import Any, Callable, Optional

import numpy as np
import rospy
import scipy.optimize  # both are imported where decisions first need them, and a mission must not wait for that
import scipy.spatial  # noqa: F401
import tf2_ros
from adhoc_communication.msg import ExpAuction, ExpFrontier, MmListOfPoints, Status
from map_merger.msg import MergerStatus
from nav_msgs.msg import MapMetaData, OccupancyGrid
from rospy.numpy_msg import numpy_msg
from std_msgs.msg import String
from std_srvs.srv import Empty, EmptyResponse, Trigger, TriggerResponse

from explorer import messages, options, ros_io, ros_team, ros_verdicts
from explorer.agent import ExplorerAgent
from explorer.answer import Answer
from explorer.call_queue import CallQueue
from explorer.decision import Decision
from explorer.errors import ExplorerError
from explorer.limits import Limits
from explorer.memory import Memory, memory_of
from explorer.msg import TeamOrder, TeamVerdicts
from explorer.names import names_for
from explorer.ros_calls import Calls
from explorer.ros_display import Display
from explorer.ros_goals import Goals
from explorer.ros_logs import LogFolder
from explorer.ros_worker import Worker
from explorer.scene_folder import recorder
from explorer.srv import SetLimits, SetLimitsResponse
from mr_grid import Pose
from mr_grid.imaging import use_threads
from mr_grid.map_frame import MapFrame, MapRuns, NewFrame
from mr_grid.ros_map_frame import FrameListener, run_of_map
from mr_grid.ros_node import init_node, until_shutdown, warn_of_unknown_parameters
from mr_grid.rounds import Rounds

TICK = 0.1  # s of wall time


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
        self._wire = ros_io.Wire(given.simulation)
        self._calls = Calls(self._names, given.group)
        self._display = Display(self._names, self._frame)
        self._goals = Goals(self._names.action, self._frame, self._on_goal_accepted, self._on_goal_ended)
        self._remembers = rospy.has_param("~memory")
        self._recall: Optional[Memory] = self._former_mission()
        self._kept = self._recall
        self._logs = LogFolder(given.log_path, given.robot_name, goes_on=self._recall is not None)
        self._merging = ""  # what map_merger says of itself
        self._tf = tf2_ros.Buffer(rospy.Duration(5.0))
        frame = MapFrame(self._frame, given.base_link.strip("/"))
        self._tf_listener = FrameListener(self._tf, frame, self._on_new_frame)
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
        rospy.Service(self._names.offered["set_limits"], SetLimits, self._on_limits)
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
        self._display.forget_home()
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
            hurried = self._agent.on_auction(auction, rospy.get_time())
        if hurried:
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

    def _on_limits(self, request: Any) -> SetLimitsResponse:
        with self._lock:
            answer = self._agent.set_limits(request.time, request.distance)
        self._wake.set()
        return SetLimitsResponse(answer.done, answer.text)

    def _keep_limits(self, limits: Limits) -> None:
        """As parameters, so that the node has the same limits when it is started again."""
        try:
            rospy.set_param("~time_limit", limits.time)
            rospy.set_param("~distance_limit", limits.distance)
        except (rospy.ROSException, OSError) as error:
            rospy.logwarn(f"explorer: the master does not keep the limits: {error}")

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
            state, memory, home = ros_io.state_to(self._agent.status(now)), self._agent.memory, self._agent.home
        if self._remembers and memory != self._kept:
            self._keep(memory)
        for effect in effects:
            self._carry_out(effect)
        self._display.state(state, now)
        self._display.home(home, rospy.Time.now())
        self._show_status(now)
        self._draw(now)

    def _keep(self, memory: Memory) -> None:
        try:
            rospy.set_param("~memory", memory.text())
            self._kept = memory
        except (rospy.ROSException, OSError) as error:
            rospy.logwarn_throttle(30.0, f"explorer: the master does not keep the mission: {error}")

    def _ready(self) -> bool:
        there = self._agent.map is not None and self._agent.pose is not None
        return there and self._goals.heard

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
            stamp = rospy.Time.now()
            self._display.goal(effect.pose, stamp)
            self._goals.send(effect, stamp)
        elif isinstance(effect, messages.CancelGoal):
            self._goals.cancel()
        elif isinstance(effect, messages.SendFrontiers):
            self._calls.send(*self._wire.radio_call(effect), is_bid=False)
        elif isinstance(effect, messages.SendAuction):
            call = self._wire.radio_call(effect)
            self._display.auction(call[2])
            self._calls.send(*call, is_bid=not effect.auction.status)
        elif isinstance(effect, messages.SendStatement):
            self._calls.say_statement(effect)
        elif isinstance(effect, messages.SendState):
            self._calls.say_state(effect, self._merging)
        elif isinstance(effect, messages.AskTransform):
            self._calls.ask_transform(effect.robot, self._on_transform)
        elif isinstance(effect, messages.LogOutput):
            self._calls.log_output(effect.mask)
        elif isinstance(effect, messages.WriteLog):
            self._logs.write(effect)
        elif isinstance(effect, messages.KeepLimits):
            self._keep_limits(effect.limits)
        else:
            (rospy.logwarn if effect.warning else rospy.loginfo)(f"explorer: {effect.text}")

    def _on_goal_accepted(self, goal_id: int) -> None:
        with self._lock:
            self._agent.on_goal_accepted(goal_id, rospy.get_time())

    def _on_goal_ended(self, goal_id: int, outcome: str, text: str) -> None:
        with self._lock:
            self._agent.on_goal_result(goal_id, outcome, text, rospy.get_time())
        self._wake.set()

    def _on_transform(self, robot: str, transform: Optional[np.ndarray]) -> None:
        with self._lock:
            self._agent.on_transform(robot, transform, rospy.get_time())

    # ---- visualisation --------------------------------------------------------------------------------------------

    def _show_status(self, now: float) -> None:
        if not self._display.status_is_due(now):
            return
        with self._lock:
            report = self._agent.report(now)
        self._display.status(report, now)

    def _draw(self, now: float) -> None:
        with self._lock:
            revision = self._agent.perception.revision
            if not self._display.picture_is_due(revision, now):
                return
            picture = self._agent.picture()
        self._display.draw(picture, revision, now, rospy.Time.now())


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
