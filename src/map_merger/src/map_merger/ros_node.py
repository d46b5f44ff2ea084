"""ROS node map_merger: maps parameters, topics, services and threads to the agent and back. It holds no decision.

The agent is only touched under `_lock`, and nothing blocks while it is held. Sends and registrations have threads of
their own, so neither a slow radio nor a search delays a callback.
"""

import os
import queue
import re
import socket
import sys
import threading
import time
from functools import partial
from io import BytesIO

import rospy
import tf2_ros
from adhoc_communication.msg import MmListOfPoints, MmPoint, Status
from adhoc_communication.srv import (
    GetNeighbors,
    SendMessage,
    SendMessageRequest,
    SendMmControl,
    SendMmControlRequest,
    SendMmMapUpdate,
    SendMmMapUpdateRequest,
    SendMmRobotPosition,
    SendMmRobotPositionRequest,
    SendOccupancyGrid,
    SendOccupancyGridRequest,
)
from rospy.numpy_msg import numpy_msg
from std_msgs.msg import String
from std_srvs.srv import Empty, EmptyResponse
from visualization_msgs.msg import MarkerArray

from map_merger import ros_io, ros_outputs, ros_radio
from map_merger.agent import Agent
from map_merger.delivery import Delivery, take
from map_merger.effects import (
    AskNeighbors,
    BroadcastTransforms,
    Note,
    Outcome,
    PublishMap,
    PublishPositions,
    PublishTrack,
    Purpose,
    Register,
    SaveDebugImages,
    Send,
)
from map_merger.job import outcome_of
from map_merger.log_files import (
    PERIODICAL_HEADER,
    PROGRESS,
    UPDATES_HEADER,
    LogBits,
    periodical_line,
    picture_of,
    updates_line,
)
from map_merger.messages import Tile
from map_merger.options import PARAMETERS, OptionError, options_of, warnings_of
from map_merger.outbox import Outbox
from map_merger.ros_inputs import PoseInput, ScanInput
from map_merger.ros_run import OwnRun
from map_merger.srv import (
    LogMaps,
    LogMapsResponse,
    TransformPoint,
    TransformPointResponse,
)
from map_merger.timer import time_of
from map_merger.view import NoTransform
from mr_grid.imaging import use_threads
from mr_grid.ros import CALL_FAILED, NumpyOccupancyGrid, grid_message
from mr_grid.ros_map_frame import FrameListener
from mr_grid.ros_node import init_node, until_shutdown, warn_of_unknown_parameters
from mr_grid.rounds import Rounds

LOOP_S = 0.2
STATUS_PERIOD_S = 1.0
ADHOC_QUEUE = 1000
MOST_SENDS = 256


class TooLarge(Exception):
    """adhoc_communication does not send a tile of that size."""


def typed_request(destination, topic, message):
    """Request of a message of any type."""
    octets = BytesIO()
    message.serialize(octets)
    kind = {"type": message._type, "md5sum": message._md5sum, "definition": message._full_text}
    return SendMessageRequest(dst_robot=destination, topic=topic, data=octets.getvalue(), **kind)


class MapMergerNode:
    """The node."""

    def __init__(self, options):
        self._options = options
        self._prefix = options.robot_prefix + "/" if options.robot_prefix else ""
        logs = os.path.expanduser(options.log_path)
        self._folder = os.path.join(logs, "map_merger", options.robot_name) if logs else ""
        self.begins_anew = False
        topic = options.local_map_topic if options.has_local_map else ""
        self._own_run = OwnRun(options.robot_name, topic, options.local_map_frame_id)
        self._agent = self._make_agent()
        self._lock = threading.Lock()
        self._wake = threading.Event()
        self._rounds = Rounds()
        # A group send waits for its slowest member; positions, requests and answers do not wait behind it.
        self._sends = {purpose: queue.Queue(MOST_SENDS) for purpose in Purpose}
        self._outbox = Outbox(self._carry_out)
        self._jobs = queue.Queue(2)
        self._pose_input = None
        self._status_due = 0.0
        self._wrong_frame = False
        self._global = rospy.Publisher("~global_map", NumpyOccupancyGrid, queue_size=3, latch=True)
        self._outputs = ros_outputs.Outputs(options.local_map_frame_id)
        self._shown = None
        self._positions = rospy.Publisher(self._network("all_positions"), MmListOfPoints, queue_size=3)
        self._tracks = {}
        self._broadcaster = tf2_ros.TransformBroadcaster()
        self._make_clients()
        self._subscribe()
        self._services = [
            rospy.Service("~transformPoint", TransformPoint, self._transform_point),
            rospy.Service("~logOutput", LogMaps, self._log_output),
            *ros_outputs.serve(self._global_grid, self._forget),
            rospy.Service("~catchUp", Empty, self._catch_up),
        ]
        for work in (*(partial(self._send_all, sends) for sends in self._sends.values()), self._register_all):
            threading.Thread(target=work, daemon=True).start()

    def _make_agent(self):
        """Goes on with the run that the node left when it ended, if SLAM has gone on meanwhile."""
        kept = self._own_run.former()
        if kept is None:
            started = time.time_ns()
            return Agent(self._options, self._options.boot or (started // 10**9 % 2**32, started % 10**9))
        agent = Agent(self._options, kept.boot)
        agent.exchange.resume(kept)
        rospy.loginfo("map_merger goes on with the map of its former run")
        return agent

    def run(self):
        """Until ROS shuts down, or the local map is another one."""
        while not (rospy.is_shutdown() or self.begins_anew):
            self._wake.wait(LOOP_S)
            self._wake.clear()
            with self._rounds.next_one():
                self._take_pose()
                self._do(lambda now: self._agent.tick(now))
                self._publish_status()

    def end_run(self):
        """The one that begins now is another one, by another name."""
        self._own_run.end()
        if self._options.run:
            rospy.delete_param("~run")

    # Topics

    def _network(self, topic):
        return self._prefix + topic

    def _subscribe(self):
        options = self._options
        for topic, kind in ros_radio.incoming(options).items():
            self._listen(self._network(topic), kind.kind, partial(self._on_incoming, kind))
        self._listen(self._network("adhoc_communication/new_robot"), String, self._on_new_robot)
        self._listen(self._network("adhoc_communication/remove_robot"), String, self._on_remove_robot)
        self._listen(self._network("adhoc_communication/status"), Status, self._on_status, queue_size=1)
        if options.has_local_map:
            self._listen(options.local_map_topic, NumpyOccupancyGrid, self._on_local_map, queue_size=1)
            self._subscribe_poses()

    def _subscribe_poses(self):
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
    def _listen(topic, kind, handler, queue_size=ADHOC_QUEUE):
        rospy.Subscriber(topic, kind, handler, queue_size=queue_size, buff_size=2**20)

    def _do(self, call):
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

    def _on_local_map(self, message):
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

    def _begin_anew(self):
        """The local map is another one, in another frame."""
        self.begins_anew = True
        self._wake.set()

    def _on_incoming(self, kind, message):
        self._do(lambda now: take(self._agent, kind.value_of(message), now))

    def _on_new_robot(self, message):
        self._do(lambda now: self._agent.on_robot(message.data, now, returned=True))

    def _on_remove_robot(self, message):
        self._do(lambda now: self._agent.on_robot_lost(message.data, now))

    def _on_status(self, message):
        self._do(lambda now: self._agent.on_robots(message.robots, now))

    def _wants_scans(self):
        with self._lock:
            return self._agent.wants_scans

    def _take_pose(self):
        """Hands the newest pose to the agent."""
        if self._pose_input is not None:
            self._own_run.frame.base_frame = self._pose_input.base_frame
        taken = None if self._pose_input is None else self._pose_input.take()
        if taken is not None:
            pose, stamp = taken
            self._do(lambda now: self._agent.on_local_pose(pose, time_of(stamp, now)))

    # Effects

    def _carry_out(self, effect):
        frame, stamp = self._options.local_map_frame_id, rospy.Time.now()
        if isinstance(effect, Send):
            self._enqueue_send(effect)
        elif isinstance(effect, Register):
            self._jobs.put(effect)
        elif isinstance(effect, PublishMap):
            self._publish_map(effect, frame, stamp)
        elif isinstance(effect, PublishPositions):
            self._positions.publish(ros_io.points_message(effect.places))
        elif isinstance(effect, PublishTrack):
            self._publish_track(effect, frame, stamp)
        elif isinstance(effect, BroadcastTransforms):
            children = [(self._child_frame(robot), transform) for robot, transform in effect.transforms]
            ahead = ros_outputs.dated_ahead(stamp)
            self._broadcaster.sendTransform(ros_io.transform_messages(children, frame.lstrip("/"), ahead))
        elif isinstance(effect, AskNeighbors):
            self._sends[Purpose.REQUEST].put(effect)
        elif isinstance(effect, SaveDebugImages):
            self._save({"local.pgm": picture_of(effect.present), "old.pgm": picture_of(effect.before)})
        elif isinstance(effect, Note):
            (rospy.logwarn if effect.warning else rospy.loginfo)(f"map_merger {self._agent.name}: {effect.text}")

    def _publish_map(self, effect, frame, stamp):
        message = grid_message(effect.grid, frame, stamp)
        message.info.map_load_time = rospy.Time(*effect.boot)
        self._global.publish(message)
        if effect.grid.info == self._shown:
            self._outputs.show_update(effect.grid, effect.changed, stamp)
        self._shown = effect.grid.info

    def _publish_status(self):
        now = time.monotonic()
        if now < self._status_due:
            return
        self._status_due = now + STATUS_PERIOD_S
        with self._lock:
            anchor, status = self._agent.exchange.anchor, self._agent.view.status(rospy.get_time())
        self._own_run.keep(anchor)
        self._outputs.show_status(status, rospy.Time.now())
        self._outputs.show_team(self._team, rospy.Time.now())

    def _team(self):
        with self._lock:
            return self._agent.view.markers()

    def _child_frame(self, robot):
        """Under one master the other robots' own map frames are roots of their trees, so copies are broadcast."""
        own = self._options.robot_prefix.strip("/")
        return f"{own}/{robot}/map" if own else f"{robot}/map"

    def _publish_track(self, effect, frame, stamp):
        if effect.robot not in self._tracks:
            name = "~position_" + re.sub(r"[^A-Za-z0-9_]", "_", effect.robot)
            self._tracks[effect.robot] = rospy.Publisher(name, MarkerArray, queue_size=3, latch=True)
        publisher = self._tracks[effect.robot]
        if publisher.get_num_connections():
            publisher.publish(ros_io.track_message(effect.points, frame, stamp))

    def _enqueue_send(self, send):
        try:
            self._sends[send.purpose].put_nowait(send)
        except queue.Full:
            self._drop_send(send)

    def _drop_send(self, send):
        rospy.logwarn_throttle(10.0, "map_merger: the radio is too slow, a send was dropped")
        self._do(lambda now: self._agent.on_sent(send, Outcome(send.payloads), now))

    # Radio

    def _make_clients(self):
        def client(name, kind):
            return rospy.ServiceProxy(f"{self._prefix}adhoc_communication/{name}", kind)

        self._send_services = {
            "send_map_update": (client("send_map_update", SendMmMapUpdate), numpy_msg(SendMmMapUpdateRequest)),
            "send_map": (client("send_map", SendOccupancyGrid), numpy_msg(SendOccupancyGridRequest)),
            "send_control_message": (client("send_control_message", SendMmControl), SendMmControlRequest),
            "send_position": (client("send_position", SendMmRobotPosition), SendMmRobotPositionRequest),
            ros_radio.SEND_TYPED: (client(ros_radio.SEND_TYPED, SendMessage), typed_request),
        }
        self._get_neighbors = client("get_neighbors", GetNeighbors)

    def _send_all(self, sends):
        while not rospy.is_shutdown():
            send = sends.get()
            if isinstance(send, AskNeighbors):
                self._ask_neighbors()
                continue
            outcome = Delivery(send)
            while outcome.next is not None:
                try:
                    outcome.ended(self._deliver(send.destination, outcome.next))
                except TooLarge:
                    outcome.ended(False, too_large=True)
            self._do(lambda now, outcome=outcome: outcome.report(self._agent, now))

    def _deliver(self, destination, payload):
        call = ros_radio.radio_call(payload, self._options, rospy.Time.now())
        client, request = self._send_services[call.service]
        try:
            return client(request(destination, call.topic, call.message)).status == 1
        except CALL_FAILED as error:
            if isinstance(payload, Tile) and ros_io.REFUSED_FOR_SIZE in str(error):
                raise TooLarge from error
            rospy.logdebug(f"send to {destination} failed: {error}")
        return False

    def _ask_neighbors(self):
        try:
            names = self._get_neighbors().neigbors
        except CALL_FAILED as error:
            rospy.logdebug(f"get_neighbors failed: {error}")
            return
        for name in names:
            self._do(lambda now, name=name: self._agent.on_robot(name, now))

    # Registration

    def _register_all(self):
        while not rospy.is_shutdown():
            effect = self._jobs.get()
            result, fault = outcome_of(effect.job)
            if fault is not None:
                rospy.logerr(f"registration with {effect.job.robot} failed and is tried again later: {fault!r}")
            self._do(partial(self._agent.on_registered, effect, result))
            self._jobs.task_done()

    # Services

    def _transform_point(self, request):
        point = request.point
        try:
            with self._lock:
                x, y = self._agent.view.transform_point(point.src_robot, point.x, point.y)
        except NoTransform as error:
            raise rospy.ServiceException(str(error)) from error
        return TransformPointResponse(MmPoint(self._agent.name, x, y))

    def _global_grid(self):
        with self._lock:
            return self._agent.view.global_map

    def _forget(self, robot):
        with self._lock:
            if not self._agent.forget(robot):
                raise KeyError(robot)

    def _catch_up(self, _):
        self._rounds.wait_for_whole_one(self._wake.set)
        self._jobs.join()
        return EmptyResponse()

    def _log_output(self, request):
        if not self._folder:
            raise rospy.ServiceException("parameter log_path is not set, so there is no place for the log")
        bits = LogBits(request.log & 0x0F)
        with self._lock:
            local, merged = self._agent.view.local_map, self._agent.view.global_map
            figures = self._agent.view.log_figures()
        pictures = {}
        if merged is not None and bits & (LogBits.GLOBAL_MAP | PROGRESS):
            pictures["global.pgm"] = picture_of(merged)
        if local is not None and bits & (LogBits.LOCAL_MAP | PROGRESS):
            pictures["local.pgm"] = picture_of(local)
        now = rospy.get_time()
        try:
            self._write(pictures)
            if bits & PROGRESS:
                self._append("periodical.log", PERIODICAL_HEADER, periodical_line(now, figures, bits))
                self._append("updates_log", UPDATES_HEADER, updates_line(now, figures))
        except OSError as error:
            raise rospy.ServiceException(f"log not written: {error}") from error
        return LogMapsResponse()

    def _save(self, files):
        if not self._folder:
            return
        try:
            self._write(files)
        except OSError as error:
            rospy.logwarn_throttle(60.0, f"map_merger: debug images not written: {error}")

    def _write(self, files):
        os.makedirs(self._folder, exist_ok=True)
        for name, content in files.items():
            with open(os.path.join(self._folder, name), "wb") as file:
                file.write(content)

    def _append(self, name, header, line):
        path = os.path.join(self._folder, name)
        new = not os.path.exists(path)
        with open(path, "a", encoding="utf-8") as file:
            file.write((header if new else "") + line)


def main():
    """Reads the parameters and runs the node; a bad parameter ends it with one message."""
    init_node("map_merger")
    use_threads(1)
    # roslaunch sets an empty string for an optional argument that was not given.
    given = {name: rospy.get_param("~" + name) for name in PARAMETERS if rospy.has_param("~" + name)}
    if given.get("initial_poses") == "":
        del given["initial_poses"]
    try:
        options = options_of(given, socket.gethostname())
    except OptionError as error:
        rospy.logfatal(f"map_merger: {error}")
        return 1
    warn_of_unknown_parameters(PARAMETERS)
    for warning in warnings_of(given, socket.gethostname()):
        rospy.logwarn(f"map_merger: {warning}")
    node = MapMergerNode(options)
    with until_shutdown():
        node.run()
    if node.begins_anew:
        node.end_run()
        rospy.logwarn("map_merger begins anew: whoever makes the local map was started anew")
        rospy.signal_shutdown("another local map")
        os.execv(sys.executable, [sys.executable, *sys.argv])
    return 0
