"""The node `page` on a real master: what is published is shown, what is ordered is called."""

import asyncio
import contextlib
import os
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from serving import Guest

from mr_page.commands import ORDERS

NODE = Path(__file__).resolve().parents[1] / "nodes" / "page"
PATIENCE = 20.0  # s


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


@contextlib.contextmanager
def running(*command, **environment):
    process = subprocess.Popen([str(word) for word in command], env={**os.environ, **environment})
    try:
        yield process
    finally:
        process.terminate()
        process.wait(PATIENCE)


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """Address of the page of robot_0. This process is a node of the same master."""
    import rospy

    home = tmp_path_factory.mktemp("ros_home")
    ports = {"ROS_MASTER_URI": f"http://localhost:{free_port()}", "ROS_HOSTNAME": "localhost", "ROS_HOME": str(home)}
    os.environ.update(ports)
    port = free_port()
    with running("rosmaster", "--core", "-p", ports["ROS_MASTER_URI"].rsplit(":", 1)[1]):
        until(lambda: rospy.core.rosgraph.is_master_online(), "the master")
        rospy.init_node("other_nodes", disable_signals=True)
        rospy.set_param("description", "robot: {frames: {base: chassis}}")
        with running(sys.executable, NODE, "__name:=page", "_robot_name:=robot_0", f"_port:={port}"):
            until(lambda: listens(port), "the page")
            yield f"127.0.0.1:{port}"


def until(condition, what):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, f"{what} does not come"
        time.sleep(0.02)


def listens(port):
    with socket.socket() as one:
        return one.connect_ex(("127.0.0.1", port)) == 0


def latched(topic, message):
    import rospy

    publisher = rospy.Publisher(topic, type(message), latch=True, queue_size=1)
    publisher.publish(message)
    return publisher


def messages():
    from adhoc_communication.msg import MmListOfPoints, MmPoint, NetworkLink, NetworkState
    from explorer.msg import (
        ExplorationBid,
        ExplorationState,
        ExplorationStatus,
        TeamMember,
        TeamOverview,
        TeamState,
    )  # fmt: skip
    from geometry_msgs.msg import Point
    from map_merger.msg import MergerStatus, RobotPlacement
    from nav_msgs.msg import GridCells, MapMetaData, OccupancyGrid
    from visualization_msgs.msg import Marker, MarkerArray

    grid = OccupancyGrid(info=MapMetaData(resolution=0.05, width=70, height=2), data=[0] * 140)
    return {
        "map": grid,
        "map_merger/global_map": grid,
        "map_merger/status": MergerStatus(robot="robot_0", robots=[RobotPlacement(robot="robot_1", why="too far")]),
        "all_positions": MmListOfPoints([MmPoint("robot_1", 3.0, 4.0)]),
        "explorer/state": ExplorationState(robot_name="robot_0", state=1, frontiers=7),
        "explorer/status": ExplorationStatus(
            has_goal=True, goal=Point(1.0, 2.0, 0.0), goal_reason="near", bids=[ExplorationBid("robot_0", 2.5)],
            expected_rest=float("nan"), time_limit=90.0, distance=12.0,
        ),
        "mission_control/team": TeamOverview(
            robots=[TeamMember(state=TeamState(robot_name="robot_1", state=1, area_known=9.0), in_reach=True, age=3.0)]
        ),
        "frontierPoints": MarkerArray([Marker(points=[Point(5.0, 6.0, 0.0)])]),
        "cluster_grid_3": GridCells(cells=[Point(1.0, 1.0, 0.0), Point(1000.0, 1000.0, 1000.0)]),
        "adhoc_communication/network_state": NetworkState(
            robots=["robot_1"], links=[NetworkLink(robot="robot_1", two_way=True, loss=0.25)], bytes_sent=5
        ),
    }  # fmt: skip


def test_what_is_published_is_shown_and_orders_are_called(page):
    import rospy
    import tf2_ros
    from explorer.srv import OrderRobots, OrderRobotsResponse, SetLimits, SetLimitsResponse
    from geometry_msgs.msg import Quaternion, TransformStamped, Vector3
    from std_srvs.srv import Trigger, TriggerResponse

    def passed_on(request):
        limits = f" of {request.time:g} s, {request.distance:g} m" if request.order == "set_limits" else ""
        return OrderRobotsResponse(True, f"{request.order}{limits}: sent to {' '.join(request.robots)}")

    def limited(request):
        return SetLimitsResponse(True, f"ends after {request.time:g} s or {request.distance:g} m")

    publishers = [latched(topic, message) for topic, message in messages().items()]
    transform = TransformStamped(child_frame_id="chassis")
    transform.header.frame_id = "map"
    transform.transform.translation, transform.transform.rotation = Vector3(1.5, -2.5, 0.0), Quaternion(0, 0, 0, 1)
    broadcaster = tf2_ros.StaticTransformBroadcaster()
    broadcaster.sendTransform(transform)
    hang = threading.Event()
    services = [
        rospy.Service("explorer/resume", Trigger, lambda _: hang.wait() and TriggerResponse(True, "too late")),
        rospy.Service("explorer/pause", Trigger, lambda _: TriggerResponse(True, "paused")),
        rospy.Service("mission_control/pause", Trigger, lambda _: TriggerResponse(True, "all paused")),
        rospy.Service("mission_control/order", OrderRobots, passed_on),
        rospy.Service("explorer/set_limits", SetLimits, limited),
    ]
    seen = asyncio.run(look(page))
    hang.set()
    for service in services:
        service.shutdown()
    assert seen["pose"] == [1.5, -2.5, 0.0]
    assert seen["merger"]["robots"][0]["why"] == "too far" and seen["peers"] == {"robot_1": [3.0, 4.0]}
    assert seen["state"]["state"] == "exploring" and seen["state"]["frontiers"] == 7
    assert (seen["decision"]["goal"], seen["decision"]["bids"], seen["decision"]["rest"]) == (
        [1.0, 2.0], {"robot_0": 2.5}, None,
    )  # fmt: skip
    assert seen["team"]["robots"]["robot_1"]["state"] == "exploring" and seen["team"]["robots"]["robot_1"]["area"] == 9
    assert seen["frontiers"] == [[5.0, 6.0]] and seen["clusters"] == [[], [], [], [[1.0, 1.0]]]
    assert seen["network"]["links"] == [{"robot": "robot_1", "two_way": True, "loss": 0.25, "waiting": 0}]
    offered = [
        "pause",
        "resume",
        "set_limits",
        "team_pause",
        *(f"pass_on_{order}" for order in (*ORDERS, "set_limits")),
    ]
    assert [command for command, there in seen["services"].items() if there] == offered
    assert seen["answers"] == [
        "paused",
        "all paused",
        "the service explorer/stop does not answer",
        "the service explorer/resume does not answer within 5 s",
        "stop: sent to robot_1",
        "ends after 600 s or 40.5 m",
        "set_limits of 600 s, 40.5 m: sent to robot_1",
    ]
    assert (seen["decision"]["limits"], seen["decision"]["way"]) == ([90.0, 0.0], 12)
    assert {kind: len(tiles) for kind, tiles in seen["tiles"].items()} == {"local": 2, "global": 2}
    assert len(publishers) == 10


WANTED = {
    "pose",
    "merger",
    "peers",
    "state",
    "decision",
    "frontiers",
    "clusters",
    "network",
    "services",
    "about",
    "team",
}


async def look(page):
    """Values, tiles and answers until all are there that a robot tells."""
    guest = await Guest.at(page)
    await guest.say(maps=[["robot_0", "local"], ["robot_0", "global"]])
    seen, tiles = {}, {"local": set(), "global": set()}
    end = time.monotonic() + PATIENCE

    def complete():
        whole = (
            seen.keys() >= WANTED and len(seen["clusters"]) == 4 and seen["pose"] and seen["services"]["pass_on_stop"]
        )
        return whole and all(len(found) == 2 for found in tiles.values())

    while not complete():
        assert time.monotonic() < end, (sorted(WANTED - seen.keys()), tiles, seen)
        update = await guest.hear()
        for name, part in update.robots.items():
            assert name == "robot_0"
            seen.update(part.values)
        for _, kind, place, cells in update.tiles:
            tiles[kind].add(place)
            assert np.frombuffer(cells, dtype=np.uint8)[0] == 0b01010101
    answers = []
    for command, to, limits in (
        ("pause", "", ()), ("team_pause", "", ()), ("stop", "", ()), ("resume", "", ()),
        ("pass_on_stop", "robot_1", ()), ("set_limits", "", (600, 40.5)),
        ("pass_on_set_limits", "robot_1", (600, 40.5)),
    ):  # fmt: skip
        await guest.say(robot="robot_0", command=command, to=to, limits=limits)
        answers.append(
            (await guest.hear_answer())["text"].partition(": service")[0].partition(": timeout")[0].partition(";")[0]
        )
    return {**seen, "tiles": tiles, "answers": answers}


@pytest.mark.parametrize(
    ("parameter", "part"),
    [
        ("_port:=70000", "~port = 70000 is no port"),
        ("_port:=x", "~port = 'x' is not of type int"),
        ("_start_pose:=1 2", "~start_pose = '1 2'"),
        ("_start_pose:=1 2 nan", "~start_pose = '1 2 nan'"),
    ],
)
def test_bad_parameters_are_named(page, parameter, part):
    done = subprocess.run(
        [sys.executable, str(NODE), f"__name:=other_{len(parameter)}", parameter],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 1 and part in done.stdout + done.stderr
