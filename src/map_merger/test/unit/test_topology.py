"""The centralized topology on virtual time: robots and a base that merges for all."""

import math

import numpy as np
import pytest
from team import Agent, Team, options, survey

from map_merger.delivery import Delivery
from map_merger.effects import PublishMap, Purpose, Send
from map_merger.exchange import Exchange
from map_merger.messages import Anchor, Request, Tile, run_after
from map_merger.synthetic import pair_of
from map_merger.topology import topology_of
from map_merger.transform import displacement
from mr_grid import UNKNOWN, GridInfo, OccupancyGrid, Pose

ROBOTS = ("robot_0", "robot_1", "robot_2")
BASE = "base"


@pytest.fixture(autouse=True)
def walls_convince(monkeypatch):
    """How much wall convinces in a building that repeats is a matter of registration."""
    monkeypatch.setattr("map_merger.registration.LARGEST_LOOKALIKE", math.inf)


@pytest.fixture(scope="module")
def maps():
    return survey(3, stages=(0.5, 1.0))


def centralized(name, boot, **changes):
    """An agent of a centralized team; the base has no map of its own."""
    values = dict(topology="centralized", base_station=BASE, has_local_map=name != BASE)
    return Agent(options(name, **{**values, **changes}), boot)


def meet(team):
    """Everybody hears of everybody."""
    for agent in team.agents.values():
        for name in team.agents:
            agent.on_robot(name, team.now, returned=True)


def team_with_base(maps, stage=-1):
    """Three robots with maps of one building, and a base."""
    team = Team({name: centralized(name, (1, number)) for number, name in enumerate((*ROBOTS, BASE))})
    meet(team)
    show(team, maps, stage)
    return team


def show(team, maps, stage):
    """The robots' local maps at a stage of their ways."""
    for index, name in enumerate(ROBOTS):
        team.agents[name].on_local_map(maps[index].stages[stage], team.now)


def known(grid):
    return int((grid.cells != UNKNOWN).sum())


def agreement(team, name):
    """Share of the known cells of the base's global map that the robot's global map has in the same place."""
    base, own = team.agents[BASE].view.global_map, team.agents[name].view.global_map
    rows, columns = np.nonzero(base.cells != UNKNOWN)
    centres = np.stack([columns, rows], axis=1) + 0.5
    points = base.info.origin.apply(centres * base.info.resolution)
    points = team.agents[name].view.transforms()[BASE].apply(points)
    cells = np.floor(own.info.origin.inverse().apply(points) / own.info.resolution).astype(int)
    inside = ((cells >= 0) & (cells < (own.info.width, own.info.height))).all(axis=1)
    same = own.cells[cells[inside, 1], cells[inside, 0]] == base.cells[rows[inside], columns[inside]]
    return np.count_nonzero(same) / len(cells)


def assert_all_have_the_map_of_the_base(team):
    """But for cells about which a robot and the base, that is its mates, disagree; and where frames are turned
    against one another a wall lies on the next cell here and there."""
    reference = team.agents[BASE]._reference.robot
    for name in ROBOTS:
        assert agreement(team, name) > (0.998 if name == reference else 0.98), name


def assert_transforms_are_right(team, frames):
    """`frames`: by robot, the map whose frame its own one is."""
    points = np.array([[0.0, 0.0], [8.0, 0.0], [0.0, 8.0], [-8.0, -8.0]])
    for name, own in frames.items():
        transforms = team.agents[name].view.transforms()
        assert set(transforms) == {*frames, BASE} - {name}
        for other in set(frames) - {name}:
            assert displacement(pair_of(own, frames[other]).truth, transforms[other], points).max() < 0.3


def test_every_robot_ends_with_the_map_of_the_base_in_its_own_frame(maps):
    team = team_with_base(maps)
    team.run(30.0)
    assert_all_have_the_map_of_the_base(team)
    assert_transforms_are_right(team, dict(zip(ROBOTS, maps)))
    assert all(known(team.agents[name].view.global_map) > 1.02 * known(maps[1].grid) for name in ROBOTS)
    assert team.agents["robot_1"].view.transform_point("robot_2", 1.0, 0.0)


def test_robots_tell_their_maps_to_the_base_only_and_the_base_tells_all(maps):
    team = team_with_base(maps, 0)
    team.run(30.0)
    show(team, maps, 1)
    team.run(30.0)
    for kind in (Tile, Anchor):
        told = {(sender, to) for _, sender, to, payload in team.sends if isinstance(payload, kind)}
        assert told <= {*((name, BASE) for name in ROBOTS), (BASE, "mc_base"), *((BASE, name) for name in ROBOTS)}
    assert {to for _, sender, to, payload in team.sends if isinstance(payload, Request) and sender in ROBOTS} == {BASE}
    assert team.jobs and all(team.agents[name]._own_transforms.registrar.believed() == {} for name in ROBOTS)
    assert_all_have_the_map_of_the_base(team)


def test_the_base_tells_changes_only(maps):
    team = team_with_base(maps)
    team.run(30.0)
    before = len(team.sends)
    local = maps[0].grid
    cells = local.cells.copy()
    row, column = np.argwhere(cells == 0)[0]
    cells[row : row + 3, column : column + 3] = 100
    team.agents["robot_0"].on_local_map(OccupancyGrid(local.info, cells), team.now)
    team.run(20.0)
    told = [payload for _, who, _, payload in team.sends[before:] if who == BASE and isinstance(payload, Tile)]
    assert 0 < sum(tile.cells.size for tile in told) < 400
    assert_all_have_the_map_of_the_base(team)


def test_nothing_is_sent_while_nothing_changes(maps):
    team = team_with_base(maps)
    team.run(30.0)
    tiles, published = len(team.sent(Tile)), {name: len(grids) for name, grids in team.maps.items()}
    team.run(60.0)
    assert len(team.sent(Tile)) == tiles
    assert {name: len(grids) for name, grids in team.maps.items()} == published


def test_a_tile_that_did_not_reach_the_base_is_repeated(maps):
    """A send to a robot ends at the first loss; all that came after it has to be sent again."""
    team = team_with_base(maps)
    for name in ROBOTS:
        team.agents[name] = centralized(name, (2, 0), split_size=32)
    meet(team)
    show(team, maps, 1)
    random = np.random.default_rng(3)
    team.lost = lambda sender, receiver, payload: isinstance(payload, (Tile, Anchor)) and random.random() < 0.3
    team.run(60.0)
    for index, name in enumerate(ROBOTS):
        assert team.agents[BASE].exchange.missing(name) is None
        assert known(team.agents[BASE].exchange.map_of(name)) == known(maps[index].grid)
    assert_all_have_the_map_of_the_base(team)


def test_a_base_that_restarts_gets_all_maps_and_tells_them_again(maps):
    team = team_with_base(maps)
    team.run(30.0)
    team.agents[BASE] = centralized(BASE, (2, 9))
    for name in ROBOTS:
        team.agents[BASE].on_robot(name, team.now)
    team.run(30.0)
    assert_all_have_the_map_of_the_base(team)
    assert_transforms_are_right(team, dict(zip(ROBOTS, maps)))


def test_without_the_base_robots_go_on_with_what_they_know_and_rejoin(maps):
    team = team_with_base(maps, 0)
    team.run(30.0)
    before = {name: known(team.agents[name].view.global_map) for name in ROBOTS}
    transforms = {name: team.agents[name].view.transforms() for name in ROBOTS}
    team.lost = lambda sender, receiver, payload: BASE in (sender, receiver)
    for name in ROBOTS:
        team.agents[name].on_robot_lost(BASE, team.now)
        team.agents[BASE].on_robot_lost(name, team.now)
    show(team, maps, 1)
    sent = len(team.sent(Tile))
    team.run(60.0)
    assert len(team.sent(Tile)) == sent, "there is nobody to send maps to"
    for index, name in enumerate(ROBOTS):
        assert team.agents[name].view.transforms() == transforms[name]
        assert known(team.agents[name].view.global_map) > max(before[name], known(maps[index].stages[1]))
        assert team.agents[name].view.verdict("robot_9") == "robot not known"
    team.lost = lambda sender, receiver, payload: False
    meet(team)
    team.run(20.0)
    assert_all_have_the_map_of_the_base(team)
    for index, name in enumerate(ROBOTS):
        assert known(team.agents[BASE].exchange.map_of(name)) == known(maps[index].grid)


def test_when_the_reference_robot_restarts_the_base_begins_a_new_run(maps):
    """Its frame is another one: what it told before, map and transforms, must not be mixed with what it tells now."""
    team = team_with_base(maps)
    team.run(30.0)
    reference = team.agents[BASE]._reference.robot
    index, other = ROBOTS.index(reference), (ROBOTS.index(reference) + 1) % 3
    turned = maps[other].grid
    team.agents[reference] = centralized(reference, (2, 0))
    meet(team)
    team.agents[reference].on_local_map(turned, team.now)
    for _ in range(160):
        team.run(0.25)
        for name in ROBOTS:
            runs = (team.agents[name].exchange.boot_of(BASE), team.agents[BASE]._own_transforms._boot)
            if team.agents[name].exchange.map_of(BASE) is not None and runs[0] == runs[1]:
                assert known(team.agents[name].exchange.map_of(BASE)) <= known(team.agents[BASE].view.global_map) * 1.05
    boots = {anchor.boot for anchor in team.sent(Anchor, BASE)}
    assert len(boots) == 2
    frames = dict(zip(ROBOTS, maps))
    frames[ROBOTS[index]] = maps[other]
    assert_all_have_the_map_of_the_base(team)
    assert_transforms_are_right(team, frames)


def test_a_robot_that_restarts_is_placed_anew_and_its_former_way_forgotten(maps):
    team = team_with_base(maps)
    for name in ROBOTS:
        team.agents[name].on_local_pose(Pose(3.0, 1.0, 0.0), team.now)
    team.run(30.0)
    moved = next(name for name in ROBOTS if name != team.agents[BASE]._reference.robot)
    witness = next(name for name in ROBOTS if name not in (moved, team.agents[BASE]._reference.robot))
    assert len(team.agents[witness]._observations.whereabouts.track(moved).points())
    team.agents[moved] = centralized(moved, (2, 0))
    meet(team)
    team.agents[moved].on_local_map(maps[0].grid, team.now)
    team.run(30.0)
    assert not len(team.agents[witness]._observations.whereabouts.track(moved).points())
    assert_transforms_are_right(team, {**dict(zip(ROBOTS, maps)), moved: maps[0]})


def test_a_robot_may_be_the_base(maps):
    """Its own map and the merged one are on one lattice; only the merged one is told."""
    names = ("robot_0", "robot_1")
    team = Team({name: centralized(name, (1, i), base_station="robot_0") for i, name in enumerate(names)})
    meet(team)
    for index, name in enumerate(names):
        team.agents[name].on_local_map(maps[index].stages[0], team.now)
    team.run(20.0)
    for index, name in enumerate(names):
        team.agents[name].on_local_map(maps[index].stages[1], team.now)
    team.run(20.0)
    told, merged = team.agents["robot_1"].exchange.map_of("robot_0"), team.agents["robot_0"].view.global_map
    assert known(told) == known(merged) > known(maps[0].grid)


def test_why_a_robot_is_not_placed_is_told_in_words():
    topology = topology_of(options("robot_0", topology="centralized", base_station=BASE))
    assert topology.why_not_placed("robot_1", False, False) == "base station base is not heard"
    assert topology.why_not_placed("robot_1", True, False) == "base station base has not placed this robot yet"
    assert topology.why_not_placed("robot_1", True, True) == "base station base has not placed robot_1 yet"


def test_runs_of_one_process_have_names_of_their_own():
    runs = [run_after((5, 999_999_998), count) for count in range(4)]
    assert runs == [(5, 999_999_998), (5, 999_999_999), (6, 0), (6, 1)]


def test_a_send_that_ends_after_the_run_did_counts_for_nothing():
    """The numbers of the former run would be repeated, or the anchor of the new one never announced with its tiles."""
    exchange = Exchange(options(BASE, topology="centralized", base_station=BASE, has_local_map=False), (1, 0))
    info = GridInfo(4, 4, 0.05)
    exchange.on_merged_map(OccupancyGrid(info, np.zeros((4, 4), np.int8)))
    exchange.on_robot("robot_0", 0.0)
    exchange.tick(0.0)
    sends = [each for each in exchange.effects() if isinstance(each, Send) and each.purpose is Purpose.CHANGES]
    assert len(sends) == 1
    exchange.begin_run((1, 1))
    delivery = Delivery(sends[0])
    while delivery.next is not None:
        delivery.ended(isinstance(delivery.next, Anchor))
    delivery.report(exchange, 1.0)
    exchange.on_merged_map(OccupancyGrid(info, np.full((4, 4), 100, np.int8)))
    exchange.tick(10.0)
    sends = [each for each in exchange.effects() if isinstance(each, Send) and each.purpose is Purpose.CHANGES]
    payloads = [payload for send in sends for payload in send.payloads]
    assert [type(payload) for payload in payloads] == [Anchor, Tile]
    assert {payload.boot for payload in payloads} == {(1, 1)}


def test_the_distributed_topology_is_the_default():
    agent = Agent(options("robot_0"), (1, 0))
    agent.on_local_map(OccupancyGrid(GridInfo(4, 4, 0.05), np.zeros((4, 4), np.int8)), 0.0)
    agent.tick(0.0)
    effects = agent.effects()
    assert [each.destination for each in effects if isinstance(each, Send)] == ["mc_robot_0"]
    assert any(isinstance(each, PublishMap) for each in effects)
