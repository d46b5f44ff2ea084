"""How a node of this stack begins."""

import contextlib
import logging
import signal
import threading
from types import FrameType
from typing import Any, Iterable, Iterator, Optional

import rospy
from rosgraph.roslogging import RosStreamHandler

from mr_grid.parameter_names import unknown_parameters


def init_node(name: str, **options: Any) -> None:
    """As `rospy.init_node`. What the node logs is lost where it cannot be written, and the node goes on; signals end it
    whatever the main thread is at."""
    rospy.init_node(name, **options)
    end_beside_the_main_thread()
    lose_what_cannot_be_written(logging.getLogger("rosout"))


@contextlib.contextmanager
def until_shutdown() -> Iterator[None]:
    """What is under way while ROS shuts down ends without a word: publishers are closed, waiting is interrupted."""
    try:
        yield
    except rospy.ROSException:
        if not rospy.is_shutdown():
            raise


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
