"""ROS node map_merger: maps parameters, topics, services and threads to the agent and back. It holds no decision.

The agent is only touched under `_lock`, and nothing blocks while it is held. Sends and registrations have threads of
their own, so neither a slow radio nor a search delays a callback.
"""

import os
import queue
import socket
import sys
import threading
import time
from functools import partial
from typing import Any, Callable, Iterable, Optional, Tuple

import rospy
import tf2_ros
from adhoc_communication.msg import MmPoint, Status
from std_msgs.msg import String
from std_srvs.srv import Empty, EmptyResponse

from map_merger import (
    fourier,  # noqa: F401, which searches import, and they must not wait for that
    ros_io,
    ros_outputs,
    ros_radio,
)
from map_merger.agent import Agent
from map_merger.delivery import Delivery, take
from map_merger.effects import (
    AskNeighbors,
    BroadcastTransforms,
    Effect,
    Note,
    Outcome,
    PublishMap,
    PublishPositions,
    PublishTrack,
    Register,
    SaveDebugImages,
    Send,
)
from map_merger.job import outcome_of
from map_merger.log_files import LogBits
from map_merger.markers import RobotMarker
from map_merger.options import PARAMETERS, OptionError, Options, options_of, warnings_of
from map_merger.outbox import Outbox
from map_merger.ros_inputs import PoseInput, ScanInput
from map_merger.ros_logs import LogError, LogFolder
from map_merger.ros_maps import Maps
from map_merger.ros_run import OwnRun
from map_merger.ros_sends import Sends
from map_merger.srv import (
    LogMaps,
    LogMapsResponse,
    TransformPoint,
    TransformPointResponse,
)
from map_merger.timer import time_of
from map_merger.view import NoTransform
from mr_grid import OccupancyGrid
from mr_grid.imaging import use_threads
from mr_grid.ros import NumpyOccupancyGrid
from mr_grid.ros_map_frame import FrameListener
from mr_grid.ros_node import begin_thread, init_node, until_shutdown, warn_of_unknown_parameters
from mr_grid.rounds import Rounds

LOOP_S = 0.2
STATUS_PERIOD_S = 1.0
ADHOC_QUEUE = 1000


class MapMergerNode:
    """The node."""

    def __init__(self, options: Options, logs: LogFolder) -> None:
        self._options, self._logs = options, logs
        self._prefix = options.robot_prefix + "/" if options.robot_prefix else ""
        self.begins_anew = False
        topic = options.local_map_topic if options.has_local_map else ""
        self._own_run = OwnRun(options.robot_name, topic, options.local_map_frame_id)
        self._agent = self._make_agent()
        self._lock = threading.Lock()
        self._wake = threading.Event()
        self._rounds = Rounds()
        self._sends = Sends(options, self._prefix, self._on_send_ended, self._on_neighbors)
        self._outbox = Outbox(self._carry_out)
        self._jobs: queue.Queue[Register] = queue.Queue(2)
        self._pose_input: Optional[PoseInput] = None
        self._status_due = 0.0
        self._wrong_frame = False
        self._outputs = ros_outputs.Outputs(options.local_map_frame_id)
        self._maps = Maps(options.local_map_frame_id, self._prefix, self._outputs)
        self._subscribe()
        self._services = [
            rospy.Service("~transformPoint", TransformPoint, self._transform_point),
            rospy.Service("~logOutput", LogMaps, self._log_output),
            *ros_outputs.serve(self._global_grid, self._forget),
            rospy.Service("~catchUp", Empty, self._catch_up),
        ]
        self._sends.begin()
        begin_thread("registration", self._register_all)

    def _make_agent(self) -> Agent:
        """Goes on with the run that the node left when it ended, if SLAM has gone on meanwhile."""
        kept = self._own_run.former()
        if kept is None:
            started = time.time_ns()
            return Agent(self._options, self._options.boot or (started // 10**9 % 2**32, started % 10**9))
        agent = Agent(self._options, kept.boot)
        agent.exchange.resume(kept)
        rospy.loginfo("map_merger goes on with the map of its former run")
        return agent

    def run(self) -> None:
        """Until ROS shuts down, or the local map is another one."""
        while not (rospy.is_shutdown() or self.begins_anew):
            self._wake.wait(LOOP_S)
            self._wake.clear()
            with self._rounds.next_one():
                self._take_pose()
                self._do(lambda now: self._agent.tick(now))
                self._publish_status()

    def end_run(self) -> None:
        """The one that begins now is another one, by another name."""
        self._own_run.end()
        if self._options.run:
            rospy.delete_param("~run")

    # Topics

    def _network(self, topic: str) -> str:
        return self._prefix + topic

    def _subscribe(self) -> None:
        options = self._options
        for topic, kind in ros_radio.incoming(options).items():
            self._listen(self._network(topic), kind.kind, partial(self._on_incoming, kind))
        self._listen(self._network("adhoc_communication/new_robot"), String, self._on_new_robot)
        self._listen(self._network("adhoc_communication/remove_robot"), String, self._on_remove_robot)
        self._listen(self._network("adhoc_communication/status"), Status, self._on_status, queue_size=1)
        if options.has_local_map:
            self._listen(options.local_map_topic, NumpyOccupancyGrid, self._on_local_map, queue_size=1)
            self._subscribe_poses()

    def _subscribe_poses(self) -> None:
        options, frame = self._options, self._options.local_map_frame_id
        self._buffer = tf2_ros.Buffer()
        self._listener = FrameListener(self._buffer, self._own_run.frame, lambda _: self._begin_anew())
        if options.exchange_position:
            self._pose_input = PoseInput(self._network(options.position_local_robot_topic), frame, self._buffer)
        if options.scan_topic:
            self._scan_input = ScanInput(
                self._network(options.scan_topic),
                frame,
                self._buffer,
                lambda: self._pose_input.base_frame if self._pose_input else "",
                self._wants_scans,
                lambda scan, pose, stamp: self._do(lambda now: self._agent.on_scan(scan, pose, time_of(stamp, now))),
            )

    @staticmethod
    def _listen(topic: str, kind: type, handler: Callable[[Any], None], queue_size: int = ADHOC_QUEUE) -> None:
        rospy.Subscriber(topic, kind, handler, queue_size=queue_size, buff_size=2**20)

    def _do(self, call: Callable[[float], Any]) -> None:
        """Calls the agent and carries out what it wants; a message that cannot be used is reported once in a while."""
        try:
            with self._lock:
                now = rospy.get_time()
                call(now)
                refused = self._outbox.put(self._agent.effects())
        except ros_io.MessageError as error:
            rospy.logwarn_throttle(10.0, f"map_merger ignored {error}")
            return
        for send in refused:
            self._drop_send(send)
        with until_shutdown():
            self._outbox.work()

    def _on_local_map(self, message: Any) -> None:
        frame = message.header.frame_id
        if frame.lstrip("/") != self._options.local_map_frame_id.lstrip("/"):
            if not self._wrong_frame:
                rospy.logwarn(
                    f"map_merger ignores maps in frame {frame!r}: local_map_frame_id is "
                    f"{self._options.local_map_frame_id!r}"
                )
            self._wrong_frame = True
            return
        if self.begins_anew or self._own_run.is_over(message):
            self._begin_anew()
            return
        self._do(lambda now: self._agent.on_local_map(ros_io.grid_of_message(message), now))
        self._wake.set()

    def _begin_anew(self) -> None:
        """The local map is another one, in another frame."""
        self.begins_anew = True
        self._wake.set()

    def _on_incoming(self, kind: ros_radio.Incoming, message: Any) -> None:
        self._do(lambda now: take(self._agent, kind.value_of(message), now))

    def _on_new_robot(self, message: String) -> None:
        self._do(lambda now: self._agent.on_robot(message.data, now, returned=True))

    def _on_remove_robot(self, message: String) -> None:
        self._do(lambda now: self._agent.on_robot_lost(message.data, now))

    def _on_status(self, message: Status) -> None:
        self._do(lambda now: self._agent.on_robots(message.robots, now))

    def _wants_scans(self) -> bool:
        with self._lock:
            return self._agent.wants_scans

    def _take_pose(self) -> None:
        """Hands the newest pose to the agent."""
        if self._pose_input is not None:
            self._own_run.frame.base_frame = self._pose_input.base_frame
        taken = None if self._pose_input is None else self._pose_input.take()
        if taken is not None:
            pose, stamp = taken
            self._do(lambda now: self._agent.on_local_pose(pose, time_of(stamp, now)))

    # Effects

    def _carry_out(self, effect: Effect) -> None:
        stamp = rospy.Time.now()
        if isinstance(effect, Send):
            if not self._sends.put(effect):
                self._drop_send(effect)
        elif isinstance(effect, Register):
            self._jobs.put(effect)
        elif isinstance(effect, PublishMap):
            self._maps.publish_map(effect, stamp)
        elif isinstance(effect, PublishPositions):
            self._maps.publish_positions(effect)
        elif isinstance(effect, PublishTrack):
            self._maps.publish_track(effect, stamp)
        elif isinstance(effect, BroadcastTransforms):
            self._maps.broadcast(effect, stamp)
        elif isinstance(effect, AskNeighbors):
            self._sends.ask_neighbors()
        elif isinstance(effect, SaveDebugImages):
            self._logs.write_debug(effect)
        elif isinstance(effect, Note):
            (rospy.logwarn if effect.warning else rospy.loginfo)(f"map_merger {self._agent.name}: {effect.text}")

    def _publish_status(self) -> None:
        now = time.monotonic()
        if now < self._status_due:
            return
        self._status_due = now + STATUS_PERIOD_S
        with self._lock:
            anchor, status = self._agent.exchange.anchor, self._agent.view.status(rospy.get_time())
        self._own_run.keep(anchor)
        self._outputs.show_status(status, rospy.Time.now())
        self._outputs.show_team(self._team, rospy.Time.now())

    def _team(self) -> Tuple[RobotMarker, ...]:
        with self._lock:
            return self._agent.view.markers()

    def _drop_send(self, send: Send) -> None:
        rospy.logwarn_throttle(10.0, "map_merger: the radio is too slow, a send was dropped")
        self._do(lambda now: self._agent.on_sent(send, Outcome(send.payloads), now))

    def _on_send_ended(self, delivery: Delivery) -> None:
        self._do(lambda now: delivery.report(self._agent, now))

    def _on_neighbors(self, names: Iterable[str]) -> None:
        for name in names:
            self._do(partial(self._agent.on_robot, name))

    # Registration

    def _register_all(self) -> None:
        while not rospy.is_shutdown():
            effect = self._jobs.get()
            result, fault = outcome_of(effect.job)
            if fault is not None:
                rospy.logerr(f"registration with {effect.job.robot} failed and is tried again later: {fault!r}")
            self._do(partial(self._agent.on_registered, effect, result))
            self._jobs.task_done()

    # Services

    def _transform_point(self, request: Any) -> TransformPointResponse:
        point = request.point
        try:
            with self._lock:
                x, y = self._agent.view.transform_point(point.src_robot, point.x, point.y)
        except NoTransform as error:
            raise rospy.ServiceException(str(error)) from error
        return TransformPointResponse(MmPoint(self._agent.name, x, y))

    def _global_grid(self) -> Optional[OccupancyGrid]:
        with self._lock:
            return self._agent.view.global_map

    def _forget(self, robot: str) -> None:
        with self._lock:
            if not self._agent.forget(robot):
                raise KeyError(robot)

    def _catch_up(self, _: Any) -> EmptyResponse:
        self._rounds.wait_for_whole_one(self._wake.set)
        self._jobs.join()
        return EmptyResponse()

    def _log_output(self, request: Any) -> LogMapsResponse:
        with self._lock:
            local, merged = self._agent.view.local_map, self._agent.view.global_map
            figures = self._agent.view.log_figures()
        try:
            self._logs.write_output(LogBits(request.log & 0x0F), local, merged, figures, rospy.get_time())
        except LogError as error:
            raise rospy.ServiceException(str(error)) from error
        return LogMapsResponse()


def main() -> int:
    """Reads the parameters and runs the node; a bad parameter ends it with one message."""
    init_node("map_merger")
    use_threads(1)
    # roslaunch sets an empty string for an optional argument that was not given.
    given = {name: rospy.get_param("~" + name) for name in PARAMETERS if rospy.has_param("~" + name)}
    if given.get("initial_poses") == "":
        del given["initial_poses"]
    try:
        options = options_of(given, socket.gethostname())
        logs = LogFolder(options.log_path, options.robot_name)
    except (OptionError, LogError) as error:
        rospy.logfatal(f"map_merger: {error}")
        return 1
    warn_of_unknown_parameters(PARAMETERS)
    for warning in warnings_of(given, socket.gethostname()):
        rospy.logwarn(f"map_merger: {warning}")
    node = MapMergerNode(options, logs)
    with until_shutdown():
        node.run()
    if node.begins_anew:
        node.end_run()
        rospy.logwarn("map_merger begins anew: whoever makes the local map was started anew")
        rospy.signal_shutdown("another local map")
        os.execv(sys.executable, [sys.executable, *sys.argv])
    return 0
