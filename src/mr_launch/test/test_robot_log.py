"""What the monitor tells of a robot's course, and what the runner makes of it."""

import json
import math

import numpy as np
import pytest

from mr_grid import Pose
from mr_launch.monitor import MOST_EVENTS, Digest, RunnerLink
from mr_launch.reports import ReportServer, RobotReport
from mr_launch.robot_log import RobotLog, Sample
from mr_measures.motion import RECORD
from mr_measures.record.mission_record import Note
from mr_measures.record.robot_record import Auction, Goal, Merge, Offer

START = 6.0  # s of simulation time


def told(digest, log, now=9.0):
    """One report on its way to the runner."""
    values = json.loads(json.dumps(digest.report(now)))
    report = RobotReport("a")
    report.update(values)
    log.take(report.sample(), values["events"])
    return report


def test_digest_tells_what_is_missing():
    digest = Digest("a")
    digest.seen("map")
    result = digest.report(10.0)
    assert "map" not in result["missing"] and "explorer" in result["missing"]


def test_goals_end_once_and_replace_each_other():
    digest, log = Digest("a"), RobotLog()
    digest.goal("first", 1.0, 2.0, 6.5)
    digest.goal("second", 3.0, 4.00001, 7.0)
    digest.goal_end("first", "cancelled", "", 7.1)
    told(digest, log)
    digest.goal_end("second", "failed", "no way", 8.0)
    digest.goal("third", 5.0, 6.0, 9.0)
    told(digest, log)
    digest.goal_end("third", "reached", "Goal reached.", 10.0)
    digest.goal("fourth", 7.0, 8.0, 11.0)
    told(digest, log)
    assert log.goals(START) == (
        Goal(0.5, 1.0, 2.0, 1.0, "replaced", "", 1), Goal(1.0, 3.0, 4.0, 2.0, "failed", "no way", 2),
        Goal(3.0, 5.0, 6.0, 4.0, "reached", "", 3), Goal(5.0, 7.0, 8.0, id=4),
    )  # fmt: skip


def test_transforms_are_told_when_they_have_changed():
    digest, log, near = Digest("a"), RobotLog(), Pose(1.0, 2.0, 0.5)
    assert not told(digest, log).sees_merges, "nobody has told of them"
    digest.believes({"b": near, "base": near}, 5.0)
    digest.believes({"b": Pose(1.01, 2.0, 0.5), "base": near}, 6.0)
    assert told(digest, log).merged == ["b", "base"]
    digest.believes({}, 7.0)
    report = told(digest, log)
    assert report.sees_merges and report.merged == []
    assert log.merges(START, ["a", "b"]) == (Merge("b", 0.0, near), Merge("b", 1.0, None))


def test_poses_are_told_as_the_robot_drives():
    digest, log = Digest("a"), RobotLog()
    for step in range(5):
        digest.located(Pose(0.05 * step, 1.0, 0.1 * step), 7.0 + step)
    told(digest, log)
    assert [time for time, _ in log.poses] == [7.0, 9.0, 11.0]
    assert log.poses[1][1] == pytest.approx(Pose(0.1, 1.0, 0.2))


def test_auctions_bids_and_notes():
    digest, log = Digest("a"), RobotLog()
    digest.auction(17, 4, 8.0)
    digest.bid()
    digest.bid()
    digest.note("explorer: lost", True, 5.0)
    report = told(digest, log)
    told(digest, log)  # an event is told once
    assert log.auctions(START) == (Auction(2.0, 17, 4),) and report.bids == 2
    assert log.notes(START, "a") == (Note(0.0, "a", "explorer: lost", True),)


def test_what_came_of_an_auction_is_told_once():
    digest, log = Digest("a"), RobotLog()
    offer = {"x": 1.0, "y": 2.0, "bids": {"a": 4.5, "b": 3.0}, "explored_by": "b"}
    digest.auction_result(3, 7, [offer], 7.0)  # of before the monitor began
    digest.auction(17, 1, 8.0)
    digest.auction_result(17, 7, [offer], 9.0)
    digest.auction(18, 2, 9.5)
    digest.auction_result(17, 7, [offer], 10.0)
    assert [event["kind"] for event in json.loads(json.dumps(digest.report(10.0)))["events"]].count(
        "auction_result"
    ) == 2
    digest.auction(17, 1, 8.0)
    digest.answer(17, "b", 8.5)
    digest.answer(16, "b", 8.6)  # for the auction of another robot
    digest.auction_result(19, 7, [], 9.0)
    digest.auction_result(20, 7, [{**offer, "bids": {"a": math.inf}}], 9.5)
    told(digest, log)
    log.take(Sample(11.0), [{"kind": "auction_result", "at": 9.0, "number": 17, "unit": 7, "offers": [offer]}])
    assert log.auctions(START) == (
        Auction(2.0, 17, 1, 7, (Offer(1.0, 2.0, {"a": 4.5, "b": 3.0}, "b"),), {"b": 2.5}, 3.0),
    )
    assert "not finite" in log.notes(START, "a")[0].text


def test_what_waits_is_bounded():
    digest = Digest("a")
    for number in range(MOST_EVENTS + 5):
        digest.note(str(number), False, 1.0)
    events = digest.report(1.0)["events"]
    assert len(events) == MOST_EVENTS and events[-1]["text"] == str(MOST_EVENTS + 4)
    assert digest.report(1.0)["events"] == []


@pytest.mark.parametrize("event", [
    {"kind": "dance", "at": 1.0}, {"at": 1.0}, {"kind": "goal", "at": 1.0, "x": 1.0}, {"kind": "merge", "at": 1.0},
    {"kind": "goal", "at": 1.0, "id": 1, "x": math.nan, "y": 0.0},
    {"kind": "merge", "at": 1.0, "partner": "b", "transform": [0.0, math.inf, 0.0]},
])  # fmt: skip
def test_what_is_no_event_is_a_note_and_the_rest_is_kept(event):
    """A goal that was no number left a mission that had finished without its record."""
    log = RobotLog()
    log.take(Sample(1.0), [event, {"kind": "goal", "at": 1.5, "id": 1, "x": 1.0, "y": 2.0}])
    assert log.goals(1.0) == (Goal(0.5, 1.0, 2.0, id=1),) and log.merges(1.0, ["b"]) == ()
    (note,) = log.notes(1.0, "a")
    assert note.warning and note.text.startswith("an event that the monitor told is left out: ")


def test_what_a_node_says_is_cut():
    digest = Digest("a")
    digest.note("x" * 2_000_000, True, 1.0)
    assert len(json.dumps(digest.report(1.0))) < 2000


def test_a_robot_that_is_started_again_believes_nothing_and_what_it_sent_still_counts():
    log, place = RobotLog(), [1.0, 2.0, 0.0]
    log.take(Sample(START + 1.0, bytes=100, frames=10, bids=1), [
        {"kind": "merge", "at": START + 1.0, "partner": "b", "transform": place},
        {"kind": "goal", "at": START + 1.0, "id": 1, "x": 0.0, "y": 0.0},
    ])  # fmt: skip
    log.begin_anew(START + 2.0)
    log.take(Sample(START + 3.0, bytes=5, frames=1), [{"kind": "goal", "at": START + 3.0, "id": 1, "x": 4.0, "y": 0.0}])
    assert [(one.partner, one.transform) for one in log.merges(START, ["b"])][-1] == ("b", None)
    assert log.goals(START) == (Goal(1.0, 0.0, 0.0, 2.0, "cancelled", "", 1), Goal(3.0, 4.0, 0.0, id=2))
    motion = np.zeros(2, dtype=RECORD)
    motion["time"] = 0.0, 4.0
    assert log.series(START, motion).bytes[-1] == 105


def test_one_wrong_reading_of_the_clock_does_not_stop_the_series():
    log = RobotLog()
    for time in (1.0, 61.0, 2.0, 3.0):
        log.take(Sample(START + time, explored=time), [])
    motion = np.zeros(5, dtype=RECORD)
    motion["time"] = np.arange(5.0)
    assert log.series(START, motion).explored == (0.0, 1.0, 2.0, 3.0, 3.0)


def test_a_motion_that_ends_a_whisker_before_a_second_has_its_series():
    """133.3 - 10.2 is less than 123.1: the series asked for a row that is not there, and the record was lost."""
    motion = np.zeros(3, dtype=RECORD)
    motion["time"] = 0.0, 61.0, np.nextafter(123.0, 0.0)
    assert RobotLog().series(START, motion).time[-1] == pytest.approx(123.0)


def test_series_have_what_was_told_last_at_each_second_of_true_motion():
    motion = np.zeros(81, dtype=RECORD)
    motion["time"] = 0.05 * np.arange(81)
    motion["x"] = 0.5 * motion["time"]
    motion["stalled"][21:41] = 1
    log = RobotLog()
    log.take(Sample(START + 0.5, explored=1.0, state=1, neighbors=("b",)), [])
    log.take(Sample(START + 0.6, explored=9.0), [])  # too soon after the one before
    log.take(Sample(START + 2.4, own=2.0, bytes=70, frames=7, bids=1, state=2), [])
    series = log.series(START, motion)
    assert series.time == (0.0, 1.0, 2.0, 3.0, 4.0) and series.x == (0.0, 0.5, 1.0, 1.5, 2.0)
    assert series.distance == (0.0, 0.5, 1.0, 1.5, 2.0) and series.stalled == (0.0, 0.0, 1.0, 1.0, 1.0)
    assert series.explored == (0.0, 1.0, 1.0, 0.0, 0.0) and series.own == (0.0, 0.0, 0.0, 2.0, 2.0)
    assert series.bytes == (0, 0, 0, 70, 70) and series.frames[-1] == 7 and series.bids == (0, 0, 0, 1, 1)
    assert series.state == (0, 1, 1, 2, 2) and series.neighbors == ((), ("b",), ("b",), (), ())


def test_a_base_station_is_no_robot_and_goes_by_the_robots_clock(tmp_path):
    """It has no simulation time: its node tells that of the computer."""
    server = ReportServer(str(tmp_path / "reports"), ["a", "b"], "base")
    base, link = Digest("base"), RunnerLink(str(tmp_path / "reports"))
    server.wait(1.0)  # for the connection
    for second in (7.0, 8.0):
        for report in server.reports.values():
            report.time = second
        base.set(radio={"bytes_sent": 100 * second, "frames_sent": second})
        base.note("map_merger: hello", False, 1.7e9 + second)
        link.send(base.report(1.7e9 + second))
        server.wait(1.0)
    told = server.logs["base"].samples_at(np.array([6.0, 7.5, 8.5]))
    assert [(one.bytes, one.frames) for one in told] == [(0, 0), (700, 7), (800, 8)]
    assert [note.at for note in server.logs["base"].notes(START, "base")] == [1.0, 2.0]
    assert server._bases["base"].radio == {"bytes_sent": 800.0, "frames_sent": 8.0}
    server.begin_anew("base")
    assert server._bases["base"].radio == {} and list(server.reports) == ["a", "b"]
    server.close()


def test_without_motion_there_is_no_series():
    assert RobotLog().series(START, np.zeros(0, dtype=RECORD)).time == ()
