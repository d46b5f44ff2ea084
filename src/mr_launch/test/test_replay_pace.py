"""A replay waits for the nodes that run again: the player on a real master, with a stand-in for map_merger."""

import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from live_master import LiveMaster
from recorded_bags import SECOND, Bag

from mr_launch.programs import find_executable
from mr_launch.recordings.bags import Span, opened
from mr_launch.recordings.cut import cut, is_played
from mr_launch.reports import ReportServer

HERE = Path(__file__).resolve().parent
LENGTH = 60  # s
AHEAD = 1.0  # s; the player may be half a second ahead, and publishes the time now and then


def player_options():
    """As the launch file gives them where map_merger runs again."""
    root = ElementTree.parse(HERE.parent / "launch" / "replayed_robot.launch").getroot()
    (player,) = [node for node in root.iter("node") if node.get("name") == "player"]
    (pace,) = [each.get("value") for each in root.iter("arg") if each.get("name") == "pace"]
    words, _, _ = player.get("args").partition("'")
    return words.replace("$(arg rate)", "20").replace("$(arg pace)", pace.split("'")[1]).split()


class LiveReplay(LiveMaster):
    """Of one robot."""

    def __init__(self, folder):
        super().__init__(folder)
        self.held, self.times, self.anew = folder / "held", folder / "times", folder / "anew"
        self.held.touch()
        self._seen = []
        self._server = ReportServer(str(folder / "reports"), ["robot_0"])
        self.report = self._server.reports["robot_0"]
        with Bag(folder / "recorded.bag") as bag:
            for tenth in range(10, 10 * LENGTH):
                bag.add(tenth * SECOND // 10, "base_scan", bag.scan(tenth * SECOND // 10), 0, "/robot")
        with opened([folder / "recorded.bag"]) as reader:
            cut(reader, folder / "played.bag", Span(SECOND, LENGTH * SECOND), is_played(["map_merger"]))
        told = {"robot_name": "robot_0", "report_socket": str(folder / "reports"), "nodes": "map_merger"}
        self.set(use_sim_time=True, replay_monitor=told)
        self.start("map_merger", sys.executable, HERE / "slow_merger.py", self.held, self.times, self.anew)
        self.start("monitor", sys.executable, HERE.parent / "nodes" / "replay_monitor")
        play = find_executable("rosbag", "play")
        self.start("player", play, *player_options(), folder / "played.bag", "__name:=player")
        self.until(lambda: not self.report.missing)
        self._server.request("robot_0", request="go")

    def until(self, done):
        def done_or_wait():
            self._server.wait(0.1)
            return done()

        self.wait_for(done_or_wait)

    def caught_up_and_now(self):
        """s of recorded time, as the node knows it."""
        return map(float, self.times.read_text().split())

    def stands_still_or_is_far_ahead(self):
        caught_up, now = self.caught_up_and_now()
        self._seen = [*self._seen, now][-10:]
        return self._seen == [now] * 10 or now - caught_up > AHEAD

    def close(self):
        super().close()
        self._server.close()


@pytest.fixture
def replay(tmp_path):
    live = LiveReplay(tmp_path)
    try:
        yield live
    finally:
        live.close()


def test_time_stands_still_until_the_node_has_caught_up(replay):
    """It ran on: what the node had not worked up was not in the map that was saved at the end, and nobody was told."""
    replay.until(replay.times.exists)
    replay.until(replay.stands_still_or_is_far_ahead)
    caught_up, now = replay.caught_up_and_now()
    assert now - caught_up <= AHEAD
    assert replay.report.time <= caught_up
    replay.held.unlink()
    replay.until(lambda: replay.report.time >= LENGTH - 1)


def test_a_node_that_begins_anew_is_waited_for(replay):
    """Time stood still from then on."""
    replay.anew.touch()
    replay.held.unlink()
    replay.until(lambda: not replay.anew.exists())
    replay.until(lambda: replay.report.time >= LENGTH - 1)
