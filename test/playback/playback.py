"""What the playback tests share on the side of ROS: listening, playing a bag, waiting for a condition."""

import contextlib
import subprocess
import threading
import time
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List
from xmlrpc.client import ServerProxy

import rosgraph
import rospy

FOLDER = Path(__file__).resolve().parent
DEADLINE_S = 60.0


class Collection:
    """Entries that callbacks bring; `wait_for` looks at them whenever one is new. Times are wall times in s."""

    def __init__(self) -> None:
        self.entries: List[Any] = []
        self._news = threading.Condition()

    def add(self, entry: Any) -> None:
        with self._news:
            self.entries.append(entry)
            self._news.notify_all()

    def wait_for(self, condition: Callable[[List[Any]], Any], seconds: float = DEADLINE_S) -> bool:
        """True as soon as the condition holds for the entries so far, False if it never does."""
        with self._news:
            return bool(self._news.wait_for(lambda: condition(self.entries), seconds))


class Listener(Collection):
    """Collects what is published on a topic."""

    def __init__(self, topic: str, message_class: Any) -> None:
        super().__init__()
        self._subscriber = rospy.Subscriber(topic, message_class, self.add)


@contextlib.contextmanager
def played(bag: str, *arguments: str) -> Iterator[None]:
    """`rosbag play` of a bag of this folder, which waits for its subscribers and keeps the clock going to the end."""
    path = bag if bag.startswith("/") else str(FOLDER / bag)
    options = ["--quiet", "--keep-alive", "--clock", "--wait-for-subscribers"]
    process = subprocess.Popen(["rosrun", "rosbag", "play", *options, path, *arguments], stdin=subprocess.DEVNULL)
    try:
        yield
    finally:
        process.terminate()
        process.wait()


def messages_received(node: str) -> Dict[str, int]:
    """How many messages a node (resolved name) has received so far, by topic."""
    address = rosgraph.Master(rospy.get_name()).lookupNode(node)
    _, _, (_, received, _) = ServerProxy(address).getBusStats(rospy.get_name())
    return {topic: sum(connection[2] for connection in connections) for topic, connections in received}


def wait_until(condition: Callable[[], Any], what: str, seconds: float = DEADLINE_S) -> None:
    """Asks again and again; AssertionError with `what` if the condition does not come true."""
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, f"{what}: not within {seconds:g} s"
        time.sleep(0.05)
