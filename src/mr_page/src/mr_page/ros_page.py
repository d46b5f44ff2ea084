"""The node `page`: the page of one robot, served here or, in a team with a page of its own, told to that."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import time
from collections import deque
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from typing import Any

import rospy
import yaml  # type: ignore[import-untyped]

from mr_grid import Pose
from mr_grid.ros_node import begin_thread, init_node
from mr_page.address import ADDRESS, PORT
from mr_page.commands import Answer, Order
from mr_page.feeds import FeedLink
from mr_page.numbers import is_finite
from mr_page.ros_feed import RobotFeed
from mr_page.server import PageServer, listening_sockets, quiet_logs
from mr_page.state import PageState
from mr_page.update import encoded
from mr_page.viewer import PERIOD, Viewer

RETRY = 2.0  # s until a feed looks for its team's page again


def main() -> int:
    init_node("page")
    quiet_logs()
    try:
        given = Parameters()
        feed = RobotFeed(given.robot, given.start, given.base, given.map_frame, given.base_frame)
        if given.team_socket:
            feed_team(feed, given.robot, given.team_socket)
        else:
            serve(feed, given)
    except (ValueError, OSError) as error:
        rospy.logfatal("page: %s", error)
        return 1
    return 0


class Parameters:
    """Of the node. ValueError names the culprit."""

    def __init__(self) -> None:
        self.robot = str(rospy.get_param("~robot_name", "")).strip("/") or socket.gethostname()
        self.port = _checked("port", PORT, int)
        if not 1 <= self.port <= 65535:
            raise ValueError(f"parameter ~port = {self.port} is no port: 1 to 65535")
        self.address = _checked("address", ADDRESS, str)
        self.base = _checked("base_station", False, bool)
        self.map_frame = _checked("map_frame", "map", str)
        self.base_frame = _checked("base_frame", "", str) or described_base_frame()
        self.team_socket = _checked("team_socket", "", str)
        start = _checked("start_pose", "", str).split()
        try:
            x, y, yaw = map(float, start or ("0",) * 3)
            if not is_finite(x, y, yaw):
                raise ValueError
            self.start = Pose(x, y, yaw) if start else None
        except ValueError:
            raise ValueError(f"parameter ~start_pose = {' '.join(start)!r} is not x m, y m, yaw rad") from None


def described_base_frame() -> str:
    """Of the description that robot.launch leaves at the parameter server."""
    with contextlib.suppress(yaml.YAMLError, KeyError, TypeError):
        return str(yaml.safe_load(rospy.get_param("description"))["robot"]["frames"]["base"])
    return "base_link"


def _checked(name: str, default: Any, kind: type) -> Any:
    value = rospy.get_param(f"~{name}", default)
    if not isinstance(value, kind):
        raise ValueError(f"parameter ~{name} = {value!r} is not of type {kind.__name__}")
    return value


def feed_team(feed: RobotFeed, robot: str, path: str) -> None:
    """Tell the team's page everything until the node ends; look for it again when it is gone."""
    orders = ThreadPoolExecutor(1)
    while not rospy.is_shutdown():
        with contextlib.suppress(OSError), contextlib.closing(FeedLink(path, robot)) as link:
            _feed(feed, link, orders)
        time.sleep(RETRY)


def _feed(feed: RobotFeed, link: FeedLink, orders: Executor) -> None:
    """Orders are carried out one by one in a thread of their own, so that what is new is told meanwhile."""
    viewer = Viewer(feed.state)
    asked: deque[Future[Answer]] = deque()
    while not rospy.is_shutdown():
        asked += [orders.submit(feed.command, order) for order in link.orders(PERIOD)]
        while asked and asked[0].done():
            link.answer(asked.popleft().result())
        feed.tick()
        with feed.lock:
            update = viewer.update(time.monotonic())
            message = encoded(update) if update else b""
        if message:
            link.send(message)


def serve(feed: RobotFeed, given: Parameters) -> None:
    """The page of this robot alone, until the node ends."""
    sockets = listening_sockets(given.port, given.address)
    asyncio.run(_serve(feed, given.robot, sockets))


async def _serve(feed: RobotFeed, robot: str, sockets: list[socket.socket]) -> None:
    async def command(_robot: str, order: Order) -> Answer:
        return await asyncio.to_thread(feed.command, order)

    shown = PageState()
    server = PageServer(shown, robot, command)
    server.add_sockets(sockets)
    viewer = Viewer(feed.state)
    begin_thread("what the page shows", lambda: _gather(feed))
    while not rospy.is_shutdown():
        with feed.lock:
            update = viewer.update(time.monotonic())
        if update is not None:
            shown.apply(update)
        await asyncio.sleep(PERIOD / 3.0)
    server.close()


def _gather(feed: RobotFeed) -> None:
    while not rospy.is_shutdown():
        feed.tick()
        time.sleep(PERIOD)
