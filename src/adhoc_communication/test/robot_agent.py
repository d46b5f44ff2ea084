#!/usr/bin/env python3
"""Beside a robot's master: reads requests as JSON lines, answers and reports received messages as JSON lines.

Requests: ready (service) | listen (topic) | status | packets_waiting | call (service, fields) | place (robot, x, y) |
send_map (dst_robot, topic, seed, cells) | stream (dst_robot, topic, seconds).
"""

import hashlib
import io
import json
import os
import sys
import threading
import time

import genpy
import numpy as np
import rospy
import rosservice
from adhoc_communication.msg import NetworkState, Status
from adhoc_communication.srv import SendOccupancyGrid, SendString
from nav_msgs.msg import OccupancyGrid, Odometry

PREFIX = "adhoc_communication/"
OUTPUT_LOCK = threading.Lock()
OUTPUT = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)  # rospy logs to standard output, which belongs to the reports


def put(report):
    with OUTPUT_LOCK:
        OUTPUT.write(json.dumps(report) + "\n")
        OUTPUT.flush()


def random_map(seed, cells):
    """An OccupancyGrid that does not compress: cells x cells octets from a seeded generator."""
    grid = OccupancyGrid()
    grid.header.frame_id = "map"
    grid.info.resolution = 0.05
    grid.info.width = grid.info.height = cells
    values = np.random.default_rng(seed).integers(-128, 128, cells * cells, dtype=np.int8)
    grid.data = values.tolist()
    return grid


def digest(octets):
    return hashlib.md5(octets).hexdigest()


def report_message(topic):
    def callback(message):
        received = time.monotonic()
        report = {"topic": topic, "type": message._connection_header["type"], "md5": digest(message._buff)}
        report.update(time=received, octets=len(message._buff), latched=message._connection_header.get("latching"))
        if len(message._buff) < 2000:
            report["octets_hex"] = message._buff.hex()
        put({"message": report})

    return callback


class Agent:
    def __init__(self):
        self.status = None
        self.subscribers = []
        self.truth = {}
        rospy.Subscriber(PREFIX + "status", Status, self._store_status)

    def _store_status(self, status):
        self.status = status

    def ready(self, request):
        rospy.wait_for_service(request.get("service", PREFIX + "get_neighbors"), timeout=30)
        return {"ready": True}

    def place(self, request):
        """Ground truth of a robot, latched."""
        topic = f"/{request['robot']}/base_pose_ground_truth"
        if topic not in self.truth:
            self.truth[topic] = rospy.Publisher(topic, Odometry, queue_size=1, latch=True)
        odometry = Odometry()
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = request["x"], request["y"]
        self.truth[topic].publish(odometry)
        return {"placed": True}

    def stream(self, request):
        """One text after the other for a while; how many were delivered and how many failed."""
        send = rospy.ServiceProxy(PREFIX + "send_string", SendString, persistent=True)
        counts = {"delivered": 0, "failed": 0}
        end = time.monotonic() + request["seconds"]
        while time.monotonic() < end:
            try:
                send(request["dst_robot"], request["topic"], str(sum(counts.values())))
                counts["delivered"] += 1
            except rospy.ServiceException:
                counts["failed"] += 1
            time.sleep(0.01)  # the pace of the traffic
        return counts

    def listen(self, request):
        self.subscribers.append(rospy.Subscriber(request["topic"], rospy.AnyMsg, report_message(request["topic"])))
        return {"listening": True}

    def get_status(self, _request):
        if self.status is None:
            return {}
        return {name: getattr(self.status, name) for name in ("robots", "neighbors", "packets_received_by_hops")}

    def packets_waiting(self, _request):
        """Packets of calls under way."""
        return {"packets": rospy.wait_for_message(PREFIX + "network_state", NetworkState).packets_waiting}

    def call(self, request):
        service = request["service"] if request["service"].startswith("/") else PREFIX + request["service"]
        service_class = rosservice.get_service_class_by_name(rospy.resolve_name(service))
        service_request = service_class._request_class()
        genpy.message.fill_message_args(service_request, [request["fields"]])
        response = rospy.ServiceProxy(service, service_class)(service_request)
        return {"response": {name: getattr(response, name) for name in response.__slots__}}

    def send_map(self, request):
        grid = random_map(request["seed"], request["cells"])
        buffer = io.BytesIO()
        grid.serialize(buffer)
        octets = buffer.getvalue()
        begin = time.monotonic()
        try:
            rospy.ServiceProxy(PREFIX + "send_map", SendOccupancyGrid)(request["dst_robot"], request["topic"], grid)
            error = None
        except rospy.ServiceException as failure:
            error = str(failure)
        return {"begin": begin, "end": time.monotonic(), "md5": digest(octets), "octets": len(octets), "error": error}


def serve(agent, request):
    handlers = {"ready": agent.ready, "listen": agent.listen, "status": agent.get_status}
    handlers.update(
        packets_waiting=agent.packets_waiting,
        call=agent.call,
        send_map=agent.send_map,
        place=agent.place,
        stream=agent.stream,
    )
    begin = time.monotonic()
    try:
        answer = handlers[request["do"]](request)
    except Exception as failure:  # the test decides what a failure means
        answer = {"error": str(failure)}
    put({"id": request["id"], "seconds": time.monotonic() - begin, **answer})


def main():
    rospy.init_node("agent", anonymous=True, disable_signals=True)
    agent = Agent()
    for line in sys.stdin:
        threading.Thread(target=serve, args=(agent, json.loads(line)), daemon=True).start()


if __name__ == "__main__":
    main()
