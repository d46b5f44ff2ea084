"""What becomes of what a robot tells."""

import math

import pytest
from made_messages import decision, exploration, merger, network

from mr_grid import Pose
from mr_page.state import PageState
from mr_page.watch import LOG_LINES, POINTS, RobotWatch


@pytest.fixture
def state():
    return PageState()


@pytest.fixture
def watch(state):
    return RobotWatch(state, "robot_0")


def items(state, stream):
    return state.stream("robot_0", stream).since(0)[1]


def test_trail_and_way(state, watch):
    for step in range(11):
        watch.pose(Pose(0.04 * step, 0.0, 1.0))
    assert items(state, "trail") == [[0.0, 0.0], [0.12, 0.0], [0.24, 0.0], [0.36, 0.0]]
    assert state.get("robot_0", "driven") == pytest.approx(0.4, abs=0.05)
    watch.pose(None)
    assert state.get("robot_0", "pose") is None


def test_a_choice_is_a_goal_that_is_another(state, watch):
    watch.decision(decision(goal=[3.0, 4.0]), 1.0)
    watch.decision(decision(goal=[3.2, 4.0]), 2.0)  # follows its frontier
    watch.decision(decision(goal=[9.0, 4.0], reason="near"), 3.0)
    watch.decision(decision(goal=None), 4.0)
    watch.decision(decision(goal=[9.0, 4.0]), 5.0)
    assert [(item[0], item[1], item[3]) for item in items(state, "choices")] == [
        (1.0, 3.0, "bid 7.2 m, the lowest of 4 clusters"), (3.0, 9.0, "near"),
        (5.0, 9.0, "bid 7.2 m, the lowest of 4 clusters"),
    ]  # fmt: skip


def test_each_auction_is_told_once_with_all_bids(state, watch):
    """Those that lost, too; the decision that changes every second does not carry them along."""
    watch.decision(decision(), 0.5)
    won = [1.0, 2.0, {"robot_0": 7.2, "robot_1": 9.1}, "robot_0"]
    offers = [won, [5.0, 6.0, {"robot_0": 3.1, "robot_1": 3.0}, "robot_1"]]
    for now, number, told in ((1.0, 4, offers), (2.04, 4, offers), (3.0, 5, offers[:1]), (4.0, 4, offers)):
        watch.decision(decision(auction_id=number, auction=told, area=now), now)
    assert items(state, "auctions") == [[1.0, 4, 7, offers], [3.0, 5, 7, offers[:1]], [4.0, 4, 7, offers]]
    assert not {"auction", "auction_id"} & set(state.get("robot_0", "decision"))


def test_the_known_area_goes_on_when_the_clock_was_set_back(state, watch):
    for now in (3600.0, 0.0, 1.0, 2.0):
        watch.decision(decision(area=now), now)
    assert [item[0] for item in items(state, "area")] == [3600.0, 0.0, 2.0]


@pytest.mark.parametrize("odd", [math.nan, math.inf])
def test_what_is_no_place_is_passed_over(state, watch, odd):
    watch.pose(Pose(1.0, odd, 0.0))
    watch.points("plan", [(1.0, 2.0), (odd, 3.0)])
    watch.peers({"b": (1.0, 2.0), "c": (1.0, odd)})
    watch.cluster(0, [(odd, 1.0), (3.0, 4.0)])
    assert state.get("robot_0", "pose") is None and items(state, "trail") == []
    assert state.get("robot_0", "plan") == [[1.0, 2.0]]
    assert state.get("robot_0", "peers") == {"b": [1.0, 2.0]}
    assert state.get("robot_0", "clusters") == [[[3.0, 4.0]]]


def test_places_found_and_given_up_are_events(state, watch):
    watch.merger(merger(robot_0=True, robot_1=False), 1.0)
    watch.merger(merger(robot_0=True, robot_1=True), 2.0)
    watch.merger(merger(robot_0=True, robot_1=True), 3.0)
    watch.merger(merger(robot_0=True, robot_1=False), 4.0)
    assert items(state, "events") == [
        [2.0, "placed", "robot_0 placed robot_1: because of robot_1", "robot_1"],
        [4.0, "revoked", "robot_0 gave up the place of robot_1: because of robot_1", "robot_1"],
    ]


def test_traffic_is_per_second_and_survives_a_radio_that_begins_anew(state, watch):
    watch.network(network(1000, 500), 1.0)
    watch.network(network(3000, 500), 2.0)
    watch.network(network(10, 20), 4.0)
    assert items(state, "traffic") == [[2.0, 2000, 0], [4.0, 0, 0]]


def test_links_that_come_and_go_are_events(state, watch):
    for now, links in ((1.0, ["b"]), (2.0, ["b", "c"]), (3.0, ["c"])):
        watch.network(network(links=links), now)
    assert [item[2] for item in items(state, "events")] == ["robot_0 hears c", "robot_0 does not hear b any more"]


def test_the_mission_begins_when_the_robot_does(state, watch):
    watch.time(5.0)
    watch.exploration(exploration("starting"), 50.0)
    watch.exploration(exploration("exploring"), 51.0)
    watch.exploration(exploration("exploring"), 52.0)
    assert state.get("robot_0", "begin") == 50.0
    assert items(state, "events") == [[51.0, "exploring", "robot_0: exploring", ""]]


def test_a_refused_service_call_is_told_in_the_words_of_the_service(state, watch):
    watch.log("error", "/adhoc_communication", "Exception thrown while processing service call: no route to b", 1.0)
    assert items(state, "log") == [[1.0, "error", "adhoc_communication", "no route to b"]]


def test_logs_are_held_back(state, watch):
    for number in range(100):
        watch.log("warning", "/slam", f"line {number}", 3.0)
    assert len(items(state, "log")) == LOG_LINES
    for number in range(100):
        watch.log("error", "/slam", "again and again", 10.0 + 0.1 * number)
    assert len(items(state, "log")) == LOG_LINES + 1


def test_points_are_thinned(state, watch):
    watch.points("frontiers", [(0.1 * i, 0.0) for i in range(5000)])
    watch.points("plan", [])
    assert 0.5 * POINTS < len(state.get("robot_0", "frontiers")) <= POINTS and state.get("robot_0", "plan") == []


def test_answers_over_the_radio_are_events(state, watch):
    def told(number, answered, answer):
        return {"robots": {"b": {"order": "pause", "answered": answered, "answer": answer, "number": number}}}

    for now, values in enumerate(
        (told(3, True, "of old"), told(3, False, "of old"), told(4, True, "paused"), told(4, True, "paused"))
    ):
        watch.team(values, float(now))
    assert items(state, "events") == [[2.0, "command", "b: pause: paused", "b"]]
