"""The agent on virtual time: exchange, restart, merging, positions, base station, parameters."""

import math

import numpy as np
import pytest
from team import Team, options, survey, team_of

from map_merger.agent import Agent
from map_merger.alignment import Alignment
from map_merger.effects import Note, Outcome, PublishMap, Send
from map_merger.evidence import Evidence
from map_merger.job import Versioned
from map_merger.messages import Anchor, Position, Request, Tile
from map_merger.registration import Registration, Verdict
from map_merger.synthetic import pair_of
from map_merger.transform import displacement
from map_merger.view import NoTransform
from mr_grid import UNKNOWN, GridInfo, OccupancyGrid, Pose


def square(size=20, value=0, x=0.0):
    return OccupancyGrid(GridInfo(size, size, 0.05, Pose(x, 0.0, 0.0)), np.full((size, size), value, np.int8))


@pytest.fixture(autouse=True)
def walls_convince(monkeypatch):
    """How much wall convinces in a building that repeats is a matter of registration."""
    monkeypatch.setattr("map_merger.registration.LARGEST_LOOKALIKE", math.inf)


@pytest.fixture(scope="module")
def maps():
    return survey(3)


def known(grid):
    return int((grid.cells != UNKNOWN).sum())


def error_of(team, robot, other, maps, own=0, index=1):
    """Largest error in metres of a transform over the other's map."""
    truth = pair_of(maps[own], maps[index]).truth
    points = np.array([[0.0, 0.0], [8.0, 0.0], [0.0, 8.0], [-8.0, -8.0]])
    return displacement(truth, team.agents[robot].view.transforms()[other], points).max()


def test_alone_the_global_map_is_the_local_one_at_once():
    team = team_of("robot_0")
    grid = square()
    team.agents["robot_0"].on_local_map(grid, team.now)
    team.run(0.25)
    shown = team.maps["robot_0"][-1]
    assert shown.info == grid.info and np.array_equal(shown.cells, grid.cells)


def test_the_anchor_goes_before_the_first_tile_and_changes_go_once(maps):
    team = team_of("robot_0", "robot_1")
    team.agents["robot_0"].on_local_map(square(), team.now)
    team.run(30.0)
    payloads = [
        payload for _, _, to, payload in team.sends if to == "mc_robot_0" and isinstance(payload, (Anchor, Tile))
    ]
    assert isinstance(payloads[0], Anchor) and payloads[0].info.width == 0
    assert len(team.sent(Tile)) == 1


def test_three_robots_merge_without_start_poses_and_maps_are_complete(maps):
    team = team_of("robot_0", "robot_1", "robot_2")
    for index in range(3):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(40.0)
    for index, other in ((1, "robot_1"), (2, "robot_2")):
        assert error_of(team, "robot_0", other, maps, index=index) < 0.2
    merged = team.maps["robot_0"][-1]
    assert known(merged) > known(maps[0].grid)
    assert dict(team.transforms["robot_0"]).keys() == {"robot_1", "robot_2"}


def test_lost_messages_are_asked_for_again(maps):
    random = np.random.default_rng(1)
    team = team_of("robot_0", "robot_1", split_size=32)
    team.lost = lambda *_: random.random() < 0.4
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(20.0)
    team.lost = lambda *_: False
    team.run(60.0)
    assert error_of(team, "robot_0", "robot_1", maps) < 0.2
    whole = team_of("robot_0", "robot_1")
    for index in range(2):
        whole.agents[f"robot_{index}"].on_local_map(maps[index].grid, whole.now)
    whole.run(60.0)
    assert known(team.maps["robot_0"][-1]) == pytest.approx(known(whole.maps["robot_0"][-1]), rel=0.002)


def test_a_group_send_that_failed_is_repeated_with_growing_pauses():
    agent = Agent(options("robot_0"), (1, 0))
    agent.on_local_map(square(), 0.0)
    times = []
    for step in range(1, 1200):
        agent.tick(step * 0.25)
        for effect in agent.effects():
            if isinstance(effect, Send) and any(isinstance(payload, Tile) for payload in effect.payloads):
                times.append(step * 0.25)
                agent.on_sent(effect, Outcome(effect.payloads), step * 0.25)
    pauses = np.diff(times)
    assert 4 <= len(times) <= 12
    assert pauses[0] <= 15.0 and pauses[-1] >= 55.0


def test_a_send_that_is_not_finished_holds_back_the_next():
    agent = Agent(options("robot_0"), (1, 0))
    agent.on_local_pose(Pose(), 0.0)
    agent.on_robot("robot_1", 0.0)
    sends = []
    for step in range(400):
        agent.on_local_map(square(value=step % 50), step * 0.25)
        agent.tick(step * 0.25)
        sends.extend(effect for effect in agent.effects() if isinstance(effect, Send))
    assert len([send for send in sends if send.destination == "mc_robot_0"]) == 3, "changes, position, anchor: one each"


def cells_of(team, robot):
    """Sizes of the tiles that a robot sent."""
    return {tile.cells.shape for tile in team.sent(Tile, robot)}


@pytest.mark.parametrize(("splitted", "shapes"), [(True, {(20, 20), (20, 10)}), (False, {(20, 50)})])
def test_maps_are_sent_in_tiles_of_the_given_size_or_each_change_in_one_piece(splitted, shapes):
    team = team_of("robot_0", "robot_1", splitted=splitted, split_size=20)
    grid = OccupancyGrid(GridInfo(50, 20, 0.05, Pose()), np.zeros((20, 50), np.int8))
    team.agents["robot_0"].on_local_map(grid, team.now)
    team.run(1.0)
    assert cells_of(team, "robot_0") == shapes


@pytest.mark.parametrize("splitted", [True, False])
def test_pieces_that_are_too_large_to_be_sent_are_halved_and_that_is_said_once(maps, splitted):
    team = team_of("robot_0", "robot_1", splitted=splitted)
    team.largest_tile = 5000
    team.agents["robot_0"].on_local_map(maps[0].grid, team.now)
    team.run(40.0)
    assert max(rows * columns for rows, columns in cells_of(team, "robot_0")) > 500
    assert known(team.agents["robot_1"].exchange.map_of("robot_0")) == known(maps[0].grid)
    assert len([note for note in team.notes["robot_0"] if "max_packet_size" in note]) == 1


def test_pieces_are_not_halved_for_ever(maps):
    team = team_of("robot_0", "robot_1")
    team.largest_tile = 0
    team.agents["robot_0"].on_local_map(maps[0].grid, team.now)
    team.run(300.0)
    assert len([note for note in team.notes["robot_0"] if "max_packet_size" in note]) == 2
    assert min(maps[0].grid.cells.shape) > 2 * 16, "there was something to halve"


def test_an_answer_that_is_too_large_comes_in_smaller_pieces(maps):
    team = team_of("robot_0")
    team.agents["robot_0"].on_local_map(maps[0].grid, team.now)
    team.run(5.0)
    team.largest_tile = 5000
    team.agents["robot_1"] = Agent(options("robot_1"), (1, 5))
    team.agents["robot_1"].on_robot("robot_0", team.now)
    team.run(60.0)
    assert known(team.agents["robot_1"].exchange.map_of("robot_0")) == known(maps[0].grid)


def test_an_unknown_sender_is_added_and_asked_for_its_anchor():
    team = team_of("robot_0", "robot_1")
    team.agents["robot_0"].on_tile(Tile("robot_1", (4,), 0, 0, np.zeros((2, 2), np.int8), 0.05, (1, 1), 5), team.now)
    team.run(2.0)
    assert Request("robot_0", ()) in team.sent(Request, "robot_0", "robot_1")


def test_requests_become_rarer_while_nobody_answers():
    agent = Agent(options("robot_0"), (1, 0))
    agent.on_robot("robot_1", 0.0)
    asked = 0
    for step in range(1, 2400):
        agent.tick(step * 0.25)
        for effect in agent.effects():
            if isinstance(effect, Send):
                asked += effect.destination == "robot_1"
                agent.on_sent(effect, Outcome(effect.payloads), step * 0.25)
    assert 15 <= asked <= 30


def test_a_robot_that_left_is_not_asked_and_gets_the_last_update_when_it_returns():
    team = team_of("robot_0")
    agent = team.agents["robot_0"]
    agent.on_local_map(square(), team.now)
    agent.on_robot("robot_1", team.now)
    team.run(5.0)
    agent.on_robot_lost("robot_1", team.now)
    team.sends.clear()
    team.run(60.0)
    assert not team.sent(Request)
    agent.on_robot("robot_1", team.now, returned=True)
    (answer,) = agent.effects()
    assert answer.destination == "robot_1"
    assert [type(payload) for payload in answer.payloads] == [Anchor, Tile]


@pytest.mark.parametrize("numbers", [(-1,), (-1, 0), (99,)])
def test_requests_to_be_ignored(numbers):
    team = team_of("robot_0")
    agent = team.agents["robot_0"]
    agent.on_local_map(square(), team.now)
    team.run(1.0)
    team.sends.clear()
    agent.on_request(Request("robot_1", numbers), team.now)
    team.settle("robot_0")
    assert not team.sent(Tile)


def test_a_restarted_robot_loses_its_map_and_transform(maps):
    team = team_of("robot_0", "robot_1")
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(30.0)
    assert team.agents["robot_0"].view.transforms()
    team.agents["robot_1"] = Agent(options("robot_1"), (2, 0))
    team.agents["robot_1"].on_local_map(square(), team.now)
    team.run(10.0)
    assert not team.agents["robot_0"].view.transforms()
    assert np.array_equal(team.maps["robot_0"][-1].cells, maps[0].grid.cells)
    assert any("restarted" in note for note in team.notes["robot_0"])


def test_a_robot_that_restarts_itself_gets_the_maps_again(maps):
    team = team_of("robot_0", "robot_1")
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(30.0)
    team.agents["robot_0"] = Agent(options("robot_0"), (2, 0))
    team.agents["robot_0"].on_local_map(maps[0].grid, team.now)
    team.run(30.0)
    assert error_of(team, "robot_0", "robot_1", maps) < 0.2


def test_the_neighbours_are_asked_for_once_five_seconds_after_the_start():
    team = team_of("robot_0")
    team.run(4.5)
    assert team.asked == []
    team.run(60.0)
    assert team.asked == ["robot_0"]


def test_positions_and_points_in_the_own_frame(maps):
    team = team_of("robot_0", "robot_1")
    with pytest.raises(NoTransform, match="not known"):
        team.agents["robot_0"].view.transform_point("robot_1", 0.0, 0.0)
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
        team.agents[f"robot_{index}"].on_local_pose(Pose(1.0, 0.5, 0.2), team.now)
    team.run(30.0)
    truth = pair_of(maps[0], maps[1]).truth
    (place,) = team.places["robot_0"]
    assert place.robot == "robot_1"
    assert math.dist((place.x, place.y), truth.apply_point(1.0, 0.5)) < 0.1
    point = team.agents["robot_0"].view.transform_point("robot_1", 3.0, 1.0)
    assert math.dist(point, truth.apply_point(3.0, 1.0)) < 0.15
    assert team.agents["robot_0"].view.transform_point("robot_0", 3.0, 1.0) == (3.0, 1.0)


@pytest.mark.parametrize("away, period", [(2.0, 0.5), (4.0, 2.0)])
def test_robots_near_one_another_tell_often_where_they_are(maps, away, period):
    """A Turtlebot turned into one beside it, beyond its field of view, whose last word was 2.6 s old."""
    team = team_of("robot_0", "robot_1")
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    own = Pose(1.0, 0.5, 0.2)
    there = pair_of(maps[0], maps[1]).truth.inverse().compose(own.compose(Pose(away, 0.0, 0.0)))
    team.agents["robot_0"].on_local_pose(own, team.now)
    team.agents["robot_1"].on_local_pose(there, team.now)
    team.run(60.0)
    for name in ("robot_0", "robot_1"):
        told = [now for now, who, _, sent in team.sends if who == name and isinstance(sent, Position)][-8:]
        assert np.allclose(np.diff(told), period)


def test_a_position_is_listed_when_it_comes(maps):
    team = team_of("robot_0", "robot_1", seconds_send_position=100)
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(30.0)
    team.agents["robot_0"].on_position(Position("robot_1", Pose(1.0, 0.5, 0.2)), team.now)
    team.settle("robot_0")
    assert [place.robot for place in team.places["robot_0"]] == ["robot_1"]


def test_without_transform_no_position_is_listed_and_points_fail_with_the_reason():
    team = team_of("robot_0", "robot_1")
    for name in ("robot_0", "robot_1"):
        team.agents[name].on_local_map(square(), team.now)
        team.agents[name].on_local_pose(Pose(), team.now)
    team.run(20.0)
    assert team.places["robot_0"] == ()
    with pytest.raises(NoTransform, match="no transform to robot_1 yet"):
        team.agents["robot_0"].view.transform_point("robot_1", 0.0, 0.0)
    for x in (math.nan, math.inf, 1.7e308):
        with pytest.raises(NoTransform, match="finite"):
            team.agents["robot_0"].view.transform_point("robot_1", x, 0.0)


def test_old_positions_are_not_listed(maps):
    team = team_of("robot_0", "robot_1")
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.agents["robot_1"].on_local_pose(Pose(), team.now)
    team.run(30.0)
    assert team.places["robot_0"]
    del team.agents["robot_1"]
    team.run(40.0)
    assert team.places["robot_0"] == ()


def test_positions_are_not_exchanged_unless_wanted():
    team = team_of("robot_0", exchange_position=False)
    team.agents["robot_0"].on_local_pose(Pose(), team.now)
    team.run(10.0)
    assert not team.sent(Position) and "robot_0" not in team.places


def test_base_station_takes_the_first_map_as_reference_and_merges_the_others(maps):
    team = team_of("robot_1", "robot_2")
    team.agents["base"] = Agent(options("base", has_local_map=False), (1, 9))
    team.agents["robot_1"].on_local_map(maps[0].grid, team.now)
    team.run(10.0)
    team.agents["robot_2"].on_local_map(maps[1].grid, team.now)
    team.agents["robot_1"].on_local_pose(Pose(1.0, 2.0, 0.0), team.now)
    team.run(40.0)
    base = team.agents["base"]
    assert error_of(team, "base", "robot_2", maps) < 0.2
    assert base.view.transform_point("robot_1", 1.0, 2.0) == (1.0, 2.0)
    assert known(team.maps["base"][-1]) > known(maps[0].grid)
    assert ("robot_1", 1.0, 2.0) in team.places["base"]
    assert dict(team.transforms["base"])["robot_1"] == Pose()
    assert not team.sent(Tile, "base") and not team.sent(Position, "base")


def test_when_its_reference_robot_restarts_the_base_station_drops_every_transform(maps):
    """The maps of all others stayed where the former frame of the reference robot had put them: a wrong merge."""
    team = team_of("robot_1", "robot_2")
    team.agents["base"] = Agent(options("base", has_local_map=False), (1, 9))
    for index in range(2):
        team.agents[f"robot_{index + 1}"].on_local_map(maps[index].grid, team.now)
    team.run(30.0)
    base = team.agents["base"]
    assert set(base.view.transforms()) == {"robot_1", "robot_2"}
    team.agents["robot_1"] = Agent(options("robot_1"), (2, 0))
    team.agents["robot_1"].on_local_map(square(), team.now)
    base.on_anchor(Anchor("robot_1", square().info, (2, 0)), team.now)
    assert base.view.transforms() == {} and base.view.local_map is None and base.view.global_map is None
    team.run(10.0)
    assert np.array_equal(team.maps["base"][-1].cells, square().cells)
    team.agents["robot_1"].on_local_map(maps[2].grid, team.now)
    team.run(30.0)
    assert error_of(team, "base", "robot_2", maps, own=2, index=1) < 0.2


def test_anchors_that_are_heard_again_redraw_nothing(maps):
    """Every anchor counted as news of the map: all was drawn and published again every five seconds."""
    team = team_of("robot_0", "robot_1")
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(60.0)
    assert team.agents["robot_0"].view.transforms()
    before, anchors = len(team.maps["robot_0"]), len(team.sent(Anchor, "robot_1"))
    team.run(60.0)
    assert len(team.sent(Anchor, "robot_1")) >= anchors + 10
    assert len(team.maps["robot_0"]) == before


@pytest.mark.parametrize("told", [True, False])
def test_a_robot_that_announces_no_anchor_is_merged_after_a_while_with_one_warning(maps, told):
    """The original has no anchors: its map was never drawn. Nor does it tell the resolution."""
    team = team_of("robot_0")
    agent, grid = team.agents["robot_0"], maps[1].grid
    agent.on_local_map(maps[0].grid, team.now)
    agent.on_tile(Tile("robot_1", (0,), 0, 0, grid.cells, grid.info.resolution if told else 0.0), team.now)
    team.run(9.0)
    assert not agent.view.transforms()
    team.run(60.0)
    from_corner = pair_of(maps[0], maps[1]).truth.compose(grid.info.origin)
    points = np.array([[0.0, 0.0], [8.0, 0.0], [0.0, 8.0]])
    assert displacement(from_corner, agent.view.transforms()["robot_1"], points).max() < 0.2
    assert sum("announces no anchor" in note for note in team.notes["robot_0"]) == 1


def base_with(*heard):
    """A base station that has heard of these robots."""
    team = Team({"base": Agent(options("base", has_local_map=False), (1, 9))})
    for name in heard:
        team.agents["base"].on_robot(name, team.now)
    return team, team.agents["base"]


def send_map(team, agent, robot, grid, boot=(1, 1)):
    agent.on_anchor(Anchor(robot, grid.info, boot, 1), team.now)
    agent.on_tile(Tile(robot, (0,), 0, 0, grid.cells, grid.info.resolution, boot, 1), team.now)


def test_the_base_station_does_not_wait_for_a_robot_that_never_sends_a_map():
    """It adopted the first robot heard, and had no map for ever when that one sent none."""
    team, base = base_with("robot_1", "robot_2")
    base.on_anchor(Anchor("robot_1", square().info, (1, 1), 0), team.now)
    assert base.view.local_map is None
    send_map(team, base, "robot_2", square(value=100))
    assert base.view.local_map is not None and base.view.transform_point("robot_2", 1.0, 2.0) == (1.0, 2.0)


def test_the_base_station_takes_another_robot_when_the_first_is_lost_for_long_before_anything_was_merged():
    team, base = base_with("robot_1", "robot_2")
    send_map(team, base, "robot_1", square())
    send_map(team, base, "robot_2", square(value=100), (1, 2))
    base.on_robot_lost("robot_1", team.now)
    team.run(50.0)
    assert base.view.transform_point("robot_1", 1.0, 2.0) == (1.0, 2.0), "it may come back"
    team.run(15.0)
    assert base.view.transform_point("robot_2", 1.0, 2.0) == (1.0, 2.0)
    assert np.array_equal(base.view.local_map.cells, square(value=100).cells)
    with pytest.raises(NoTransform):
        base.view.transform_point("robot_1", 1.0, 2.0)


def test_the_base_station_keeps_a_reference_into_which_it_has_merged(maps):
    team, base = base_with("robot_1", "robot_2")
    send_map(team, base, "robot_1", maps[0].grid)
    send_map(team, base, "robot_2", maps[1].grid, (1, 2))
    team.run(20.0)
    assert base.view.transforms()
    base.on_robot_lost("robot_1", team.now)
    team.run(200.0)
    assert base.view.transform_point("robot_1", 1.0, 2.0) == (1.0, 2.0)


def test_initial_poses_are_a_prior_and_not_a_fact(maps):
    truth = pair_of(maps[0], maps[1]).truth
    for offset, found in ((Pose(1.0, -1.0, 0.2), True), (Pose(9.0, 9.0, 2.0), False)):
        poses = {
            "robot_0": Pose(5.0, 5.0, 1.0),
            "robot_1": Pose(5.0, 5.0, 1.0).compose(truth).compose(offset),
        }
        team = team_of("robot_0", "robot_1", initial_poses=poses)
        for index in range(2):
            team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
        team.run(30.0)
        assert bool(team.agents["robot_0"].view.transforms()) == found
        if found:
            assert error_of(team, "robot_0", "robot_1", maps) < 0.2


@pytest.mark.parametrize("limit", [{"max_rotation_robots": 1.0}, {"max_trans_robots": 0.0}])
def test_limits_refuse_and_say_so_once(maps, limit):
    team = team_of("robot_0", "robot_1", **limit)
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(60.0)
    assert not team.agents["robot_0"].view.transforms()
    assert sum("-1 lifts a limit" in note for note in team.notes["robot_0"]) == 1


def test_features_method_merges_too(maps):
    team = team_of("robot_0", "robot_1", registration="features")
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(30.0)
    for transform in team.agents["robot_0"].view.transforms().values():
        points = np.array([[0.0, 0.0], [8.0, 0.0]])
        assert displacement(transform, pair_of(maps[0], maps[1]).truth, points).max() < 0.25


def test_timers_have_their_periods():
    team = team_of("robot_0", "robot_1", seconds_send_timer=7, seconds_send_position=3, seconds_meta_timer=11)
    agent = team.agents["robot_0"]
    agent.on_robot("robot_1", team.now)
    agent.on_local_pose(Pose(), team.now)
    for step in range(60):
        agent.on_local_map(square(value=step), team.now)
        team.run(1.0)
    tiles = [now for now, who, to, payload in team.sends if to == "mc_robot_0" and isinstance(payload, Tile)]
    positions = [now for now, who, to, payload in team.sends if to == "mc_robot_0" and isinstance(payload, Position)]
    anchors = [now for now, who, to, payload in team.sends if to == "mc_robot_0" and isinstance(payload, Anchor)]
    assert set(np.diff(tiles)) == {7.0}
    assert set(np.diff(positions)) == {3.0}
    assert anchors == anchors[:1], "changes tell as much"
    before = team.now
    team.run(60.0)
    anchors = [now for now, _, to, payload in team.sends if to == "mc_robot_0" and isinstance(payload, Anchor)]
    assert set(np.diff([now for now in anchors if now > before + 22.0])) == {11.0}


def test_news_of_others_come_with_the_publish_timer_and_own_news_at_once(maps):
    team = team_of("robot_0", "robot_1", seconds_pub_timer=9)
    team.agents["robot_0"].on_local_map(maps[0].grid, team.now)
    team.run(0.25)
    assert len(team.maps["robot_0"]) == 1
    team.agents["robot_1"].on_local_map(maps[1].grid, team.now)
    team.run(8.0)
    assert len(team.maps["robot_0"]) == 1
    team.run(20.0)
    assert known(team.maps["robot_0"][-1]) > known(maps[0].grid)


@pytest.mark.parametrize("period, refined", [(-1, False), (4, True)])
def test_known_transforms_are_refined_unless_the_period_is_minus_one(maps, period, refined):
    team = team_of("robot_0", "robot_1", seconds_recompute_transform=period)
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(30.0)
    before = team.jobs
    cells = maps[0].grid.cells.copy()
    cells[0, 0] = 0
    team.agents["robot_0"].on_local_map(OccupancyGrid(maps[0].grid.info, cells), team.now)
    team.run(10.0)
    assert (team.jobs > before) == refined


def test_no_registration_while_nothing_changes(maps):
    team = team_of("robot_0", "robot_1")
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(30.0)
    before = team.jobs
    team.run(120.0)
    assert team.jobs == before


def test_a_contradicted_transform_is_revoked(maps):
    team = team_of("robot_0", "robot_1")
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(30.0)
    assert team.agents["robot_0"].view.transforms()
    wrong = Registration(Verdict.CONTRADICTED, Pose(), Evidence(20.0, 5.0, 0.4, 0.5, 0.1))
    alignment = team.agents["robot_0"]._own_transforms.registrar.alignment("robot_1")
    assert alignment.finished(wrong) == ""
    assert alignment.transform is not None
    assert alignment.finished(wrong) == "revoked"
    assert alignment.transform is None


def test_debug_images_show_the_map_and_the_one_before():
    team = Team({"robot_0": Agent(options("robot_0", debug=True), (1, 0))})
    first, second = square(), square(value=100)
    team.agents["robot_0"].on_local_map(first, team.now)
    team.run(6.0)
    team.agents["robot_0"].on_local_map(second, team.now)
    team.run(6.0)
    assert len(team.images["robot_0"]) == 2
    assert team.images["robot_0"][1].present is second and team.images["robot_0"][1].before is first


def test_a_local_map_with_another_resolution_is_reported_and_ignored():
    agent = Agent(options("robot_0"), (1, 0))
    agent.on_local_map(square(), 0.0)
    agent.on_local_map(OccupancyGrid(GridInfo(2, 2, 0.1), np.zeros((2, 2), np.int8)), 1.0)
    agent.tick(2.0)
    effects = agent.effects()
    assert any(isinstance(effect, Note) and "resolution" in effect.text for effect in effects)
    assert next(effect for effect in effects if isinstance(effect, PublishMap)).grid.info.resolution == 0.05


def test_a_map_that_does_not_fit_into_the_global_one_is_left_out_with_one_warning(maps):
    """Turned, a map of allowed size has a box beyond all bounds; drawing it raised out of tick and ended the node."""
    team = team_of("robot_0", "robot_1")
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(30.0)
    far = Tile("robot_1", (), 0, 12000, np.zeros((1, 1), np.int8), 0.05, (1, 1))
    for _ in range(2):
        team.agents["robot_0"].on_tile(far, team.now)
        team.agents["robot_0"].on_local_map(maps[0].grid, team.now)
        team.run(5.0)
    assert sum("not drawn" in note for note in team.notes["robot_0"]) == 1
    assert np.array_equal(team.maps["robot_0"][-1].cells, maps[0].grid.cells)


def test_waiting_tiles_that_do_not_fit_do_not_hide_a_restart(maps):
    """An error of a tile that had waited came between the new map and the end of the transform of the old one."""
    team = team_of("robot_0", "robot_1")
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(30.0)
    agent, boot = team.agents["robot_0"], (2, 0)
    for column in (0, 500_000_000):
        agent.on_tile(Tile("robot_1", (), 500_000_000, column, np.zeros((1, 1), np.int8), 0.05, boot), team.now)
    agent.on_anchor(Anchor("robot_1", square().info, boot), team.now)
    assert not agent.view.transforms()


def test_all_maps_of_others_together_are_bounded(monkeypatch):
    monkeypatch.setattr("map_merger.exchange.bounds.MOST_STORED_CELLS", 3 * 64 * 64)
    agent = Agent(options("robot_0"), (1, 0))
    for number in range(1, 5):
        robot = f"robot_{number}"
        agent.on_anchor(Anchor(robot, square().info, (1, number)), 0.0)
        agent.on_tile(Tile(robot, (0,), 0, 0, np.zeros((64, 64), np.int8), 0.05, (1, number)), 0.0)
    (warning,) = [effect.text for effect in agent.effects() if isinstance(effect, Note) and effect.warning]
    assert "robot_4" in warning and "room for 0" in warning


def test_a_local_map_that_grows_too_large_to_be_sent_is_reported_once(monkeypatch):
    """It raised out of tick and ended the node."""
    monkeypatch.setattr("map_merger.exchange.bounds.MOST_MAP_CELLS", 64 * 64)
    team = team_of("robot_0")
    for size in (20, 100, 120):
        team.agents["robot_0"].on_local_map(square(size), team.now)
        team.run(6.0)
    assert sum("local map not sent" in note for note in team.notes["robot_0"]) == 1
    assert team.maps["robot_0"][-1].info.width == 120


def test_the_number_of_robots_is_bounded():
    agent = Agent(options("robot_0"), (1, 0))
    for number in range(1, 200):
        agent.on_robot(f"robot_{number}", 0.0)
    assert len(agent.exchange.robots()) == 64


def test_own_messages_are_ignored():
    agent = Agent(options("robot_0"), (1, 0))
    agent.on_robot("robot_0", 0.0)
    agent.on_position(Position("robot_0", Pose()), 0.0)
    agent.on_robot("", 0.0)
    assert not agent.exchange.robots()


def test_a_clock_that_jumps_back_does_not_stop_the_agent():
    team = team_of("robot_0")
    agent = team.agents["robot_0"]
    agent.on_local_map(square(), team.now)
    team.run(10.0)
    team.now = 0.0
    agent.on_local_map(square(value=100), team.now)
    team.run(10.0)
    assert team.maps["robot_0"][-1].cells.max() == 100
    assert len(team.sent(Tile)) == 2


def test_after_the_clock_jumped_back_a_silent_robot_is_asked_again_within_half_a_minute():
    """Requests waited for the time at which they had been due before the jump."""
    team = team_of("robot_0")
    agent = team.agents["robot_0"]
    agent.on_robot("robot_1", team.now)
    team.run(600.0)
    team.now = 0.0
    team.sends.clear()
    team.run(31.0)
    assert len(team.sent(Request, "robot_0", "robot_1")) in (1, 2)


def test_after_the_clock_jumped_back_robots_are_merged(maps):
    """Attempts to register waited for the time at which they had been due before the jump."""
    team = team_of("robot_0", "robot_1")
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(square(), team.now)
    team.run(600.0)
    assert not team.agents["robot_0"].view.transforms()
    team.now = 0.0
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(30.0)
    assert error_of(team, "robot_0", "robot_1", maps) < 0.2


def test_after_the_clock_jumped_back_positions_from_before_are_neither_listed_nor_a_sighting(maps):
    """A position heard at 600 s counted as fresh until the clock was there again."""
    team = team_of("robot_0", "robot_1")
    for index in range(2):
        team.agents[f"robot_{index}"].on_local_map(maps[index].grid, team.now)
    team.run(30.0)
    agent = team.agents["robot_0"]
    agent.on_position(Position("robot_1", Pose()), team.now)
    agent.on_position(Position("robot_2", Pose()), team.now)
    before = agent._observations.sightings.of("robot_2")[0]
    team.run(2.0)
    assert [place.robot for place in team.places["robot_0"]] == ["robot_1"]
    team.now = 0.0
    agent.on_local_map(maps[0].grid, team.now)
    assert agent._observations.sightings.of("robot_2")[0] == before
    del team.agents["robot_1"]
    team.run(3.0)
    assert team.places["robot_0"] == ()


def test_after_the_clock_jumped_back_within_the_first_seconds_the_neighbours_are_asked_all_the_same():
    team = team_of("robot_0")
    team.now = 1000.0
    team.run(2.0)
    team.now = 0.0
    team.run(10.0)
    assert team.asked == ["robot_0"]


def test_a_peer_whose_job_was_started_before_the_clock_jumped_back_does_not_come_last():
    alignment = Alignment()
    map_ = Versioned("map", square())
    alignment.started(600.0, map_, map_, 2.0)
    assert alignment.started_before(600.0) == 600.0
    assert alignment.started_before(5.0) == -math.inf


def test_a_robot_that_is_in_hearing_for_a_minute_without_being_placed_is_to_be_met():
    team = team_of("robot_0", "robot_1")
    for name in team.agents:
        team.agents[name].on_local_map(square(), team.now)
        team.agents[name].on_local_pose(Pose(), team.now)
    team.run(50.0)
    assert team.agents["robot_0"].view.status(team.now).wants_to_meet == ()
    team.run(20.0)
    assert team.agents["robot_0"].view.status(team.now).wants_to_meet == ("robot_1",)
    team.agents["robot_0"].on_robot_lost("robot_1", team.now)
    assert team.agents["robot_0"].view.status(team.now).wants_to_meet == ()
