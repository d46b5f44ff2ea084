"""How a node of this stack begins."""

import contextlib
import logging
import signal
import sys
import threading
import time
import traceback
from types import FrameType
from typing import Any, Callable, Iterable, Iterator, Optional

import rosgraph
import rospy
from rosgraph.roslogging import RosStreamHandler

from mr_grid.parameter_names import unknown_parameters
from mr_grid.ros_connections import watch_connections

MASTER_PERIOD = 0.5  # s between two questions whether there is a master


def init_node(name: str, **options: Any) -> None:
    """As `rospy.init_node`, once a master answers. What the node logs is lost where it cannot be written, and the node
    goes on; signals end it whatever the main thread is at; no publisher is missed."""
    wait_for_master(name)
    rospy.init_node(name, **options)
    end_beside_the_main_thread()
    lose_what_cannot_be_written(logging.getLogger("rosout"))
    watch_connections()


def wait_for_master(name: str) -> None:
    """Says once that it waits. rospy waits in the midst of a node's start, where Ctrl-C and parameters are tracebacks.
    Ends the program, with a sentence, where ROS_MASTER_URI is none."""
    told = False
    while not _master_answers(name):
        if not told:
            uri = rosgraph.get_master_uri()
            remedy = "start robot.launch or roscore, or set ROS_MASTER_URI"
            print(f"{name}: waits for a ROS master, none answers at {uri}: {remedy}", file=sys.stderr, flush=True)
        told = True
        time.sleep(MASTER_PERIOD)


def _master_answers(name: str) -> bool:
    try:
        return bool(rosgraph.is_master_online())
    except ValueError as error:
        raise SystemExit(f"{name}: {error}: set ROS_MASTER_URI to one such as http://localhost:11311") from error


@contextlib.contextmanager
def until_shutdown() -> Iterator[None]:
    """What is under way while ROS shuts down ends without a word: publishers are closed, waiting is interrupted."""
    try:
        yield
    except rospy.ROSException:
        if not rospy.core.is_shutdown_requested():  # publishers are closed before is_shutdown() is true
            raise


def begin_thread(what: str, work: Callable[[], None]) -> None:
    """Of a node that is of no use without it; it ends with the node. An exception in it ends the node, which says so,
    and which roslaunch starts anew: otherwise it would stand there and look as if it worked. `what`: it does."""
    threading.Thread(target=_guarded, args=(what, work), name=what, daemon=True).start()


def _guarded(what: str, work: Callable[[], None]) -> None:
    try:
        work()
    except Exception as error:  # whatever it is, nobody else would hear of it
        if rospy.core.is_shutdown_requested():
            return
        rospy.logfatal(f"the thread for {what} has ended, and the node ends: {traceback.format_exc()}")
        rospy.signal_shutdown(f"{what}: {error!r}")


def warn_of_unknown_parameters(known: Iterable[str]) -> None:
    """Of the node's own, `~`."""
    for line in unknown_parameters(rospy.get_param("~", {}), known):
        rospy.logwarn(f"{rospy.get_name()}: {line}")


def lose_what_cannot_be_written(logger: logging.Logger) -> None:
    """ROS' handler of a node's output lets OSError through to whoever logs. roslaunch sends that output to a file: on a
    full disk, timers and threads ended by what they had to say, and their node stood still without a word."""
    for handler in list(logger.handlers):
        if isinstance(handler, RosStreamHandler):
            logger.removeHandler(handler)
            logger.addHandler(_Lossy(handler))


def end_beside_the_main_thread() -> None:
    """rospy shuts down in the handler of a signal, that is in the middle of what the main thread does. Where that was
    sending, with the lock of a connection, both waited for one another until roslaunch killed the node 17 s later."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _shut_down)


def _shut_down(number: int, _: Optional[FrameType]) -> None:
    threading.Thread(target=rospy.signal_shutdown, args=(f"signal-{number}",)).start()


class _Lossy(logging.Handler):
    """Hands records on to another handler."""

    def __init__(self, handler: logging.Handler) -> None:
        super().__init__(handler.level)
        self._handler = handler

    def emit(self, record: logging.LogRecord) -> None:
        with contextlib.suppress(OSError):
            self._handler.emit(record)
