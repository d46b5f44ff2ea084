"""SLAM that is started anew goes on with the map that was written down."""

import math
import struct
from typing import Callable, Iterator, Tuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_lost import around_a_block, error_after
from test_slam import follow
from test_slam_evaluation import Recorder, processed, slam_of
from usual_robot import slam_with

from mr_grid import Pose
from mr_measures.figures import wrong_walls
from mr_measures.truth import Truth
from mr_robot.slam.engine import LaserScan, Slam, SlamError
from mr_sim.scan_log import with_random_walk
from mr_sim.true_world import true_world_of


def walls(slam: Slam) -> np.ndarray:
    """m, map frame; (n, 2)."""
    map_ = slam.map()
    return map_.info.centres_of(np.argwhere(map_.cells >= 65))


def far_from(points: np.ndarray, others: np.ndarray) -> float:
    """Share of points that lie 0.1 m or more from all others."""
    gaps = np.abs(points[:, None, :] - others[None, :, :]).max(axis=2).min(axis=1)
    return float((gaps > 0.1).mean())


def test_a_loop_is_closed_after_a_crash_on_half_the_way(draw_world: Callable[..., str]) -> None:
    """Around a block, for which what ties the places of the way together has to be there: without it the robot ends
    0.15 m from where it is."""
    drives = Recorder(draw_world((24, 16), [(2.0, 2.0, 20.0, 12.0)], [(1.0, 1.0, 0.0)]), 0)
    drives.run(260.0, follow([(23.0, 1.0), (23.0, 15.0), (1.0, 15.0), (1.0, 1.0), (23.0, 1.0)], 0.4))
    log, slam = with_random_walk(drives.log(), 0.1, 0.02, 7), slam_with()
    slam.begin_journal()
    half = len(log.times) // 2
    assert sum(1 for _ in processed(log, slam, range(half))) == half
    anew, written = slam_with(), slam.take_journal()
    assert anew.recall(written, slam.state()) == len(written)
    assert anew.map_to_odometry() == slam.map_to_odometry() and anew.revision == 1
    ahead = Pose(*log.odometry[half + 50].tolist())
    assert anew.pose_at(ahead) == slam.pose_at(ahead), "it knows how odometry counts wrong"
    assert max(far_from(walls(slam), walls(anew)), far_from(walls(anew), walls(slam))) < 0.01
    assert sum(1 for _ in processed(log, anew, range(half, len(log.times)))) == len(log.times) - half
    end = Pose(*log.truth[0].tolist()).between(Pose(*log.truth[-1].tolist()))
    assert math.dist(anew.pose_at(Pose(*log.odometry[-1].tolist()))[:2], end[:2]) < 0.1


def entries(written: bytes) -> Iterator[Tuple[bytes, bytes]]:
    """Kind and octets of each entry of a journal."""
    while written:
        kind, size = struct.unpack_from("<cI", written)
        yield kind, written[5 : 5 + size]
        written = written[5 + size :]


def closes_far_loop(written: bytes) -> bool:
    """Keyframes were linked, and none was opened."""
    found = list(entries(written))
    return any(kind == b"L" for kind, _ in found) and not any(kind == b"S" and octets[0] for kind, octets in found)


def test_a_far_loop_is_closed_after_a_crash_before_the_map_is_drawn_anew(draw_world: Callable[..., str]) -> None:
    """SLAM that was started anew doubted what had closed the loop, drew on meanwhile, and stayed 3 m off."""
    log = around_a_block(draw_world, 6)
    slam, written, end = slam_of(log.world), b"", len(log.times)
    slam.begin_journal()
    for index in processed(log, slam, range(len(log.times))):
        piece = slam.take_journal()
        written += piece
        if closes_far_loop(piece):
            end = index + 10
        if index == end:
            break
    assert error_after(log, slam, end) > 2.0
    anew = slam_of(log.world)
    assert anew.recall(written, slam.state()) == len(written)
    assert far_from(walls(slam), walls(anew)) < 0.01
    for each in (slam, anew):
        for _ in processed(log, each, range(end + 1, end + 30)):
            pass
        assert error_after(log, each, end + 29) < 0.3
    truth, start = Truth.of_world(true_world_of(Recorder(log.world, 3).world)), Pose(*log.truth[0].tolist())
    assert wrong_walls(truth, anew.map(), start) < wrong_walls(truth, slam.map(), start) + 0.02


@given(cut=st.integers(0, 200_000), broken=st.integers(0, 200_000), octet=st.integers(0, 255))
def test_what_was_not_written_whole_is_left_out(cut: int, broken: int, octet: int) -> None:
    written, state = ROOM
    torn = bytearray(written[:cut])
    if broken < len(torn):
        torn[broken] = octet
    slam = slam_with()
    used = slam.recall(bytes(torn), state)
    assert used <= len(torn) and (used > 0) == (slam.revision > 0)
    assert slam.recall(written, state[:-1]) == 0, "a state of another size"


def test_places_that_no_map_holds_begin_a_new_one() -> None:
    """5 km away: each pose is sound by itself."""
    written, state = ROOM
    there = struct.pack("<?6d", False, 0.0, 0.0, 0.0, 5000.0, 5000.0, 0.0)
    poses = b"P" + struct.pack("<I", len(there)) + there
    slam = slam_with()
    with pytest.raises(SlamError, match="too many cells"):
        slam.recall(written + poses, state)
    in_a_room(slam, 40)
    assert slam.revision > 0 and slam.pose_at(Pose(1.95, 0.0, 0.0)) == pytest.approx(Pose(1.95, 0.0, 0.0), abs=0.05)


def in_a_room(slam: Slam, steps: int) -> None:
    """Ahead in a room of 8 m x 8 m."""
    angles = -math.pi + 0.0174 * np.arange(360)
    for step in range(steps):
        x = 0.05 * step
        side = np.where(np.cos(angles) > 0.0, 4.0 - x, 4.0 + x) / np.abs(np.cos(angles))
        ranges = np.minimum(side, 4.0 / np.abs(np.sin(angles)))
        slam.process(LaserScan(ranges, -math.pi, 0.0174, 0.1, 30.0, Pose()), Pose(x, 0.0, 0.0), 0.1 * step)


def room() -> Tuple[bytes, bytes]:
    slam = slam_with()
    slam.begin_journal()
    in_a_room(slam, 40)
    return slam.take_journal(), slam.state()


ROOM = room()


def test_nothing_is_written_unless_it_is_asked_for() -> None:
    slam = slam_with()
    in_a_room(slam, 40)
    assert slam.take_journal() == b""


def test_a_map_that_has_begun_recalls_nothing() -> None:
    slam = slam_with()
    in_a_room(slam, 2)
    assert slam.recall(*ROOM) == 0
