"""Whether the local map is still the one that it was, by who makes it and by what it says."""

from typing import Iterator, Optional

import pytest
import rospy
from nav_msgs.msg import OccupancyGrid

from map_merger.ros_run import OwnRun


@pytest.fixture
def own_run(monkeypatch: pytest.MonkeyPatch) -> Iterator[OwnRun]:
    """Its maps come from process "a" until `publisher` is another."""
    monkeypatch.setattr(rospy, "resolve_name", lambda name: f"/{name}")
    monkeypatch.setattr(rospy, "get_name", lambda: "/map_merger")
    monkeypatch.setattr(OwnRun, "publisher", "a", raising=False)
    monkeypatch.setattr(OwnRun, "_publisher", lambda self: self.publisher)
    yield OwnRun("robot_1", "map", "map")


def map_of(connection: dict, stamp: float, begun: Optional[float]) -> OccupancyGrid:
    message = OccupancyGrid()
    message.header.stamp = rospy.Time.from_sec(stamp)
    message.info.map_load_time = rospy.Time.from_sec(stamp if begun is None else begun)
    message._connection_header = connection
    return message


@pytest.mark.parametrize(
    ("first", "second", "over"),
    [
        (None, None, True),  # SLAM whose maps name no run
        (2.0, 2.0, False),  # SLAM that goes on with its map
        (2.0, 19.0, True),  # and one that does not
        (2.0, None, True),
        (None, 10.0, False),  # one that goes on with a map that had just begun
    ],
)
def test_a_map_of_another_process_is_another_one_unless_it_goes_on(
    own_run: OwnRun, first: Optional[float], second: Optional[float], over: bool
) -> None:
    former, later = {"callerid": "/slam"}, {"callerid": "/slam"}
    assert not own_run.is_over(map_of(former, 2.0, None)) and not own_run.is_over(map_of(former, 10.0, first))
    own_run.publisher = "b"
    assert own_run.is_over(map_of(later, 21.0, second)) == over
    assert not own_run.is_over(map_of(later, 22.0, second))


def test_a_process_that_connects_anew_is_the_same(own_run: OwnRun) -> None:
    assert not own_run.is_over(map_of({}, 10.0, None)) and not own_run.is_over(map_of({}, 11.0, None))
