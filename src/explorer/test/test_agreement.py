"""What robots say of their verdicts and of the end: believed, lifted, agreed on, and safe whatever is lost."""

from dataclasses import replace
from typing import Any, List, Optional, Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_agent import IDENTITY, Bench, closed, corridor, reply

from explorer.agreement import Agreement
from explorer.foreign import Element, ForeignFrontiers
from explorer.heard import Heard, HeardVerdict, Witness
from explorer.messages import Auction, Note, SendStatement
from explorer.places import Places
from explorer.statement import Decided, Kind, LeftPlace, Stage, Statement
from explorer.status import State
from explorer.team import MAXIMUM_ROBOTS


def said(
    stage: Stage = Stage.EXPLORING,
    number: int = 1,
    verdicts: Sequence[Decided] = (),
    left: Sequence[LeftPlace] = (),
    robot: str = "robot_1",
    mission: int = 7,
    area: float = 1000.0,
) -> Statement:
    return Statement(robot, mission, number, stage, area, tuple(verdicts), tuple(left))


def placed(robot: str = "robot_1", transform: Optional[np.ndarray] = IDENTITY) -> Agreement:
    foreign = ForeignFrontiers()
    foreign.set_transform(robot, transform)
    return Agreement(foreign)


def statements(bench: Bench, seconds: float = 0.0) -> List[Statement]:
    """All that were sent, after it has run for so long."""
    bench.run(seconds)
    return [effect.statement for effect in bench.effects if isinstance(effect, SendStatement)]


# ---- what is heard ------------------------------------------------------------------------------------------------


def test_verdicts_are_placed_by_the_newest_transform() -> None:
    agreement = placed()
    agreement.take(said(verdicts=[Decided(1.0, 2.0, Kind.VISITED, 3.0)]), 0.0)
    assert agreement.heard(1.0).verdicts == (HeardVerdict(1.0, 2.0, Kind.VISITED, 3.0, "robot_1"),)
    agreement._foreign.set_transform("robot_1", np.array([[0.0, -1.0, 5.0], [1.0, 0.0, 0.0]]))
    assert agreement.heard(1.0).verdicts[0][:2] == (3.0, 1.0)


def test_points_and_transforms_that_are_told_again_change_nothing() -> None:
    """Else everything would be perceived anew with each message."""
    agreement = placed()
    agreement.take(said(Stage.ENDED, verdicts=[Decided(1.0, 2.0, Kind.VISITED, 3.0)]), 0.0)
    before = agreement.heard(1.0)
    agreement._foreign.add(Element("robot_1", 3, 1.0, 1.0))
    agreement._foreign.set_transform("robot_1", IDENTITY.copy())
    assert agreement.heard(1.0) is before


def test_without_a_transform_a_robot_says_nothing_of_places() -> None:
    agreement = placed(transform=None)
    agreement.take(said(Stage.ENDED, verdicts=[Decided(1.0, 2.0, Kind.VISITED, 3.0)]), 0.0)
    heard = agreement.heard(1.0)
    assert heard.verdicts == heard.witnesses == () and heard.vouched(["robot_1"])
    assert agreement.stage("robot_1") == Stage.ENDED


def test_with_a_robot_goes_its_word() -> None:
    agreement = placed()
    agreement.take(said(Stage.ENDED, verdicts=[Decided(1.0, 2.0, Kind.VISITED, 3.0)]), 0.0)
    agreement.forget(["robot_1", "robot_2"])
    assert agreement.heard(1.0) == Heard() and agreement.stage("robot_1") is None


def test_a_new_mission_of_a_robot_counts_from_the_start() -> None:
    agreement = placed()
    assert agreement.take(said(Stage.ENDED, number=9), 0.0)
    assert not agreement.take(said(number=8), 0.0) and agreement.stage("robot_1") == Stage.ENDED
    assert agreement.take(said(number=1, mission=8), 0.0) and agreement.stage("robot_1") == Stage.EXPLORING


def test_an_explorer_that_was_started_anew_leaves_no_points_of_its_former_run_to_others() -> None:
    """Its numbers begin at 0 again, so that a claim of them would be of two places."""
    agent = Bench().map(corridor()).agent
    agent.on_robots(["robot_1"], 100.0)
    agent.on_transform("robot_1", IDENTITY, 100.0)
    agent.on_statement(said(mission=7), 100.0)
    agent.on_frontiers([Element("robot_1", 0, 1.0, 0.0), Element("robot_1", 1, 9.0, 0.0)], 100.0)
    agent.on_statement(said(mission=8), 101.0)
    agent.on_frontiers([Element("robot_1", 0, 5.0, 0.0)], 101.0)
    assert agent.foreign.places("robot_1") == [(5.0, 0.0)]


def test_robots_beyond_the_bound_are_not_heard() -> None:
    agreement = Agreement(ForeignFrontiers())
    taken = [agreement.take(said(robot=f"robot_{number}"), 0.0) for number in range(MAXIMUM_ROBOTS + 1)]
    assert taken == [True] * MAXIMUM_ROBOTS + [False] and agreement.take(said(robot="robot_1", number=2), 0.0)


@given(st.lists(st.integers(1, 20), min_size=1))
def test_lost_doubled_and_reordered_statements_end_in_the_newest(order: List[int]) -> None:
    agreement = placed()
    for number in order:
        agreement.take(said(Stage(number % 4), number), 0.0)
    assert agreement.stage("robot_1") == Stage(max(order) % 4)


@pytest.mark.parametrize("known, believed", [(2.0, True), (1.0, True), (2.5, False)])
def test_a_verdict_holds_until_the_own_map_shows_more_there(known: float, believed: bool) -> None:
    """Less than the other robot knew means that the own map has yet to show it."""
    heard = Heard((HeardVerdict(1.0, 1.0, Kind.VISITED, 2.0, "robot_1"),))
    points = np.array([(1.2, 1.1), (1.5, 1.0)])
    assert heard.decided(points, lambda x, y: known) == ({0: "robot_1"} if believed else {})


def test_a_closer_look_is_no_verdict_on_a_point() -> None:
    heard = Heard((HeardVerdict(1.0, 1.0, Kind.LOOKED, 0.0, "robot_1"),))
    assert heard.decided(np.array([(1.0, 1.0)]), lambda x, y: 0.0) == {}
    assert heard.looks_near(1.5, 1.0, 1.0) == 1 and heard.looks_near(3.0, 1.0, 1.0) == 0


@pytest.mark.parametrize(
    "area, left, denied", [(100.0, (9.0, 9.0), True), (90.0, (9.0, 9.0), False), (100.0, (1.5, 2.0), False)]
)
def test_a_robot_denies_what_it_would_have_to_know(area: float, left: tuple, denied: bool) -> None:
    """Not with a map that has less in it, and not what it leaves itself."""
    heard = Heard(witnesses=(Witness("robot_1", area, np.array([left]), True),))
    assert heard.denied_by(np.array([(1.0, 1.0), (1.2, 1.0)]), 100.0) == ("robot_1" if denied else None)


# ---- what is said -------------------------------------------------------------------------------------------------


def test_alone_nothing_is_said() -> None:
    bench = Bench(7).map(corridor())
    bench.run(30.0)
    assert not statements(bench)


def test_the_stage_is_said_at_once_and_again_now_and_then() -> None:
    bench = Bench(7).map(corridor()).join("robot_1")
    bench.run(1.0)
    assert [each.stage for each in statements(bench)] == [Stage.EXPLORING]
    bench.map(closed()).run(0.6)
    assert [each.stage for each in statements(bench)] == [Stage.EXPLORING, Stage.NOTHING_LEFT]
    bench.map(closed()).run(25.0)
    stages = [each.stage for each in statements(bench)]
    assert stages[:3] == [Stage.EXPLORING, Stage.NOTHING_LEFT, Stage.ENDED] and 4 <= len(stages) <= 6
    numbers = [each.number for each in statements(bench)]
    assert numbers == sorted(set(numbers)) and len({each.mission for each in statements(bench)}) == 1


def test_maps_that_flicker_do_not_flood_the_radio() -> None:
    bench = Bench(7).map(corridor()).join("robot_1")
    for _ in range(25):
        bench.map(closed()).run(0.2)
        bench.map(corridor()).run(0.2)
    assert len(statements(bench)) <= 21


def test_a_robot_that_comes_late_hears_it_also_from_one_that_has_ended() -> None:
    bench = Bench(7, return_home=False).map(closed()).join("robot_1")
    bench.run(10.0)
    assert bench.agent.state == State.FINISHED
    bench.effects.clear()
    bench.join("robot_1", "robot_2").run(0.4)
    assert [each.stage for each in statements(bench)] == [Stage.ENDED]


def test_a_robot_that_was_stopped_does_not_say_that_nothing_is_left() -> None:
    bench = Bench(7).map(corridor()).join("robot_1")
    bench.run(1.0)
    bench.agent.stop(bench.now)
    bench.run(0.4)
    assert statements(bench)[-1].stage == Stage.QUIT


def test_visited_points_are_told_with_what_was_known() -> None:
    bench = Bench(7).map(corridor(left=False)).join("robot_1")
    bench.run(0.4)
    for _ in range(2):
        for point in bench.agent.perception.frontiers.ordered():
            bench.agent.mission.verdicts.look(point.number, lambda _: True, lambda x, y: 0.0, bench.now)
        for _ in range(3):
            bench.map(corridor(left=False)).run(1.0)
    bench.run(3.0)
    told = statements(bench)[-1].verdicts
    assert told and {each.kind for each in told} == {Kind.VISITED}
    assert all(1.0 < each.known < 3.2 for each in told)


# ---- what is made of it -------------------------------------------------------------------------------------------


def frontier_points(bench: Bench) -> List[tuple]:
    return [(point.x, point.y) for point in bench.agent.perception.frontiers.ordered()]


def test_what_another_robot_has_visited_is_no_goal_and_says_who_told_it() -> None:
    bench = Bench(7).map(corridor(left=False)).join("robot_1")
    bench.run(0.4)
    verdicts = [Decided(x, y, Kind.VISITED, 3.0) for x, y in frontier_points(bench)]
    bench.agent.on_statement(said(verdicts=verdicts), bench.now)
    bench.run(0.4)
    assert not bench.agent.perception.worth.goals
    assert set(bench.agent.perception.worth.reasons.values()) == {"told by robot_1"}
    bench.agent.on_robots([], bench.now)
    bench.run(0.4)
    assert bench.agent.perception.worth.goals


def test_a_statement_of_a_robot_out_of_reach_is_not_heard() -> None:
    bench = Bench(7).map(corridor(left=False))
    bench.agent.on_transform("robot_1", IDENTITY, bench.now)
    bench.run(0.4)
    verdicts = [Decided(x, y, Kind.VISITED, 3.0) for x, y in frontier_points(bench)]
    bench.agent.on_statement(said(verdicts=verdicts), bench.now)
    bench.run(0.4)
    assert bench.agent.perception.worth.goals


@pytest.mark.parametrize("place", [(np.nan, 0.0, 1.0), (0.0, np.inf, 1.0), (0.0, 0.0, np.inf), (0.0, 0.0, -1.0)])
def test_places_that_cannot_be_are_not_believed(place: tuple) -> None:
    bench = Bench(7).map(corridor()).join("robot_1")
    bench.agent.on_statement(said(verdicts=[Decided(place[0], place[1], Kind.VISITED, place[2])]), bench.now)
    bench.agent.on_statement(said(left=[LeftPlace(*place, "noise")]), bench.now)
    bench.agent.on_statement(said(robot="robot_0", number=3), bench.now)
    assert bench.agent.mission.agreement.stage("robot_1") is None
    bench.run(1.0)
    assert sum(isinstance(effect, Note) and effect.warning for effect in bench.effects) == 1


@pytest.mark.parametrize(
    ("area", "heard"), [(2.5e6, True), (0.0, True), (-1.0, False), (np.nan, False), (np.inf, False)]
)
def test_areas_may_be_as_large_as_maps_are(area: float, heard: bool) -> None:
    """A robot that knew more than 10 hectares was not heard: areas were measured by how far places may be."""
    bench = Bench(7).map(corridor()).join("robot_1")
    bench.agent.on_statement(said(area=area, left=[LeftPlace(0.0, 0.0, max(0.0, min(area, 2e5)), "noise")]), bench.now)
    assert (bench.agent.mission.agreement.stage("robot_1") is not None) == heard


def told_all_explored(bench: Bench) -> None:
    elements = [Element("robot_1", i, *place) for i, place in enumerate(frontier_points(bench))]
    bench.agent.on_visited_frontiers(elements, bench.now)


def ends_within(bench: Bench, seconds: float, occupancy: Any) -> bool:
    bench.map(occupancy).run(0.2)
    bench.map(occupancy).run(seconds - 0.2)
    return bench.agent.finished_at is not None


@pytest.mark.parametrize("speaks", [True, False])
def test_the_word_of_a_robot_that_says_what_it_leaves_is_not_waited_out(speaks: bool) -> None:
    """One that speaks the original's protocol alone is believed for 8 s, and the end waits for the map to show it."""
    bench = Bench(7).map(corridor(left=False)).join("robot_1")
    bench.run(0.4)
    if speaks:
        bench.agent.on_statement(said(Stage.NOTHING_LEFT, area=1.0), bench.now)
    told_all_explored(bench)
    assert ends_within(bench, 5.0, corridor(left=False)) == speaks


def test_a_frontier_that_has_only_moved_is_not_explored() -> None:
    """The other robot has numbered its points anew: some have vanished, others are still beside them."""
    bench = Bench(7).map(corridor(left=False)).join("robot_1")
    bench.run(0.4)
    x, y = frontier_points(bench)[0]
    bench.agent.on_frontiers([Element("robot_1", 500, x, y + 0.4)], bench.now)
    told_all_explored(bench)
    bench.map(corridor(left=False)).run(0.4)
    assert bench.agent.perception.worth.goals


def pocketed() -> Any:
    """A closed corridor whose wall hides an unknown pocket of 2 m x 0.5 m, where no robot fits in."""
    occupancy = closed()
    cells = occupancy.cells.copy()
    cells[26:31, 110:130] = -1
    return replace(occupancy, cells=cells)


@pytest.mark.parametrize("area, left, goes", [(64.0, (), False), (60.0, (), True), (64.0, ((1.9, 1.0),), True)])
def test_nobody_drives_on_for_what_a_robot_that_has_ended_does_not_see(area: float, left: tuple, goes: bool) -> None:
    """Unless that robot's map has less in it, or it leaves the place itself, as not worth its way."""
    bench = Bench(7).map(pocketed()).join("robot_1", position=(-5.0, 0.0))
    places = [LeftPlace(x, y, 0.5, "not worth the way") for x, y in left]
    bench.agent.on_statement(said(Stage.ENDED, left=places, area=area), bench.now)
    bench.run(0.4)
    assert bool(bench.goals()) == goes
    assert ends_within(bench, 8.0, pocketed()) != goes


@pytest.mark.parametrize("area, goes", [(64.0, False), (60.0, True)])
def test_what_the_team_leaves_is_not_taken_up_by_the_last(area: float, goes: bool) -> None:
    """Alone a robot would drive there in the end, far as it is."""
    bench = Bench(7).join("robot_1", position=(-9.0, 0.5))
    bench.place(-8.0, 0.0)
    bench.map(pocketed())
    bench.agent.on_statement(said(Stage.ENDED, left=[LeftPlace(1.9, 1.0, 0.5, "noise")], area=area), bench.now)
    bench.run(1.0)
    assert bool(bench.goals()) == goes


def test_a_last_look_is_auctioned_and_taken_once() -> None:
    """The other robot bids less for it, takes it, and says what it found."""
    bench = Bench(7).join("robot_1", position=(1.0, 0.0))
    bench.place(-8.0, 0.0)
    bench.map(pocketed()).run(0.4)
    start = next(auction for auction in bench.auctions() if auction.start)
    bench.agent.on_auction(reply(start, "robot_1", [2.5] * len(start.requested)), bench.now)
    occupied = start.requested[0].elements
    bench.agent.on_auction(Auction("robot_1", 9, True, finished=True, occupied=occupied), bench.now)
    bench.map(pocketed()).run(3.0)
    assert bench.agent.goal is None and statements(bench)[-1].stage == Stage.EXPLORING
    verdicts = [Decided(x, y, Kind.VISITED, 3.0) for x, y in frontier_points(bench)]
    bench.agent.on_statement(said(Stage.NOTHING_LEFT, verdicts=verdicts), bench.now)
    bench.agent.on_auction(Auction("robot_1", 9, True, finished=True), bench.now)
    assert ends_within(bench, 8.0, pocketed())


@given(st.integers(0, 2**32 - 1), st.sampled_from(["none", "partition", "death"]))
@settings(max_examples=20)
def test_a_team_ends_whatever_is_lost(seed: int, failure: str) -> None:
    """Statements are lost, doubled and late; the robots part from each other, or one falls silent."""
    random = np.random.default_rng(seed)
    robots = {name: Bench(7, robot_name=name, return_home=False) for name in ("robot_0", "robot_1")}
    for name, bench in robots.items():
        bench.map(pocketed()).join(*(other for other in robots if other != name))
    late: List[Any] = []
    for second in range(60):
        for name, bench in robots.items():
            if failure != "none" and second == 5:
                bench.agent.on_robots([], bench.now)
            if failure == "death" and second >= 5 and name == "robot_1":
                continue
            bench.effects.clear()
            bench.place(2.0 - 0.1 * (second < 20), 0.0, 1.5)
            late += [(name, each) for each in statements(bench.map(pocketed() if second < 30 else closed()), 1.0)]
        for name, statement in [each for each in late if random.random() < 0.5]:
            for other, bench in robots.items():
                if other != name and random.random() < 0.7:
                    bench.agent.on_statement(statement, bench.now)
        late = late[-10:]
    assert robots["robot_0"].agent.finished_at is not None
    assert failure == "death" or robots["robot_1"].agent.finished_at is not None


def ended(**options: Any) -> Bench:
    bench = Bench(7, return_home=False, **options).map(closed()).join("robot_1")
    bench.run(10.0)
    assert bench.agent.state == State.FINISHED and bench.agent.finished_at is not None
    return bench


def test_a_robot_that_has_ended_goes_on_when_a_map_shows_an_opening() -> None:
    bench = ended()
    bench.map(corridor()).run(10.0)
    assert bench.agent.finished_at is None and bench.agent.state == State.EXPLORING
    assert statements(bench)[-1].stage == Stage.EXPLORING
    assert ends_within(bench, 5.0, closed())


def test_an_opening_that_is_there_for_a_moment_opens_nothing() -> None:
    bench = ended()
    bench.map(corridor()).run(2.2)
    bench.map(closed()).run(10.0)
    assert bench.agent.state == State.FINISHED and not any("goes on" in each for each in notes(bench))


def notes(bench: Bench) -> List[str]:
    return [effect.text for effect in bench.effects if isinstance(effect, Note)]


def test_what_another_robot_claims_opens_nothing_until_it_is_gone() -> None:
    bench = ended()
    bench.map(corridor(left=False)).run(0.4)
    bench.agent.mission.looking.look(bench.now)
    points = frontier_points(bench)
    bench.agent.on_frontiers([Element("robot_1", i, *place) for i, place in enumerate(points)], bench.now)
    occupied = tuple(("robot_1", i) for i in range(len(points)))
    bench.agent.on_auction(Auction("robot_1", 1, True, finished=True, occupied=occupied), bench.now)
    bench.map(corridor(left=False)).run(12.0)
    assert bench.agent.state == State.FINISHED
    bench.agent.on_robots([], bench.now)
    bench.run(8.0)
    assert bench.agent.finished_at is None


@pytest.mark.parametrize("order", ["stop", "go_home"])
def test_a_robot_that_was_told_to_end_does_not_go_on(order: str) -> None:
    bench = Bench(7, return_home=False).map(corridor()).join("robot_1")
    bench.run(1.0)
    getattr(bench.agent, order)(bench.now)
    bench.map(corridor()).run(20.0)
    assert bench.agent.finished_at is not None


def test_a_robot_comes_to_an_end_however_often_maps_change() -> None:
    bench = ended()
    for _ in range(12):
        bench.map(corridor()).run(8.0)
        bench.map(closed()).run(0.4)
        bench.map(closed()).run(8.0)
    assert sum("goes on" in each for each in notes(bench)) == 5
    bench.map(corridor()).run(30.0)
    assert bench.agent.state == State.FINISHED


@pytest.mark.parametrize("speaks", [False, True])
def test_nobody_is_waited_for_for_ever(speaks: bool) -> None:
    """For one that says nothing of the end not at all, for one that goes on saying that it explores half a
    minute."""
    bench = Bench(7).map(closed()).join("robot_1", "robot_2")
    ends_at = 0
    for second in range(60):
        if speaks:
            bench.agent.on_statement(said(number=second + 1), bench.now)
        bench.map(closed()).run(1.0)
        if bench.agent.finished_at is not None:
            ends_at = second
            break
    assert (30 <= ends_at <= 33) if speaks else (3 <= ends_at <= 8)


@pytest.mark.parametrize("what", ["ends", "falls silent", "leaves", "quits"])
def test_a_robot_stays_no_longer_than_others_explore(what: str) -> None:
    bench = Bench(7).map(closed()).join("robot_1")
    bench.agent.on_statement(said(), bench.now)
    bench.map(closed()).run(10.0)
    assert bench.agent.finished_at is None and statements(bench)[-1].stage == Stage.NOTHING_LEFT
    if what == "leaves":
        bench.agent.on_robots([], bench.now)
    elif what != "falls silent":
        bench.agent.on_statement(said(Stage.ENDED if what == "ends" else Stage.QUIT, number=2), bench.now)
    bench.map(closed()).run(16.0 if what == "falls silent" else 1.0)
    assert bench.agent.finished_at is not None


def test_a_paused_robot_is_not_waited_for() -> None:
    bench = Bench(7).map(corridor()).join("robot_1")
    bench.run(1.0)
    bench.agent.pause(bench.now)
    bench.run(1.0)
    assert statements(bench)[-1].stage == Stage.QUIT
    bench.agent.resume(bench.now)
    bench.run(1.0)
    assert statements(bench)[-1].stage == Stage.EXPLORING


# ---- places -------------------------------------------------------------------------------------------------------


def test_places_are_bounded_and_found_by_the_nearest() -> None:
    places: Places[int] = Places(3, 0.2)
    for number in range(5):
        places.put(0.25 * number, 0.0, number)
    assert len(places.values()) == 3 and places.near(0.0, 0.0) is None
    assert places.near(0.9, 0.05) == 4 and places.near(1.0, 0.25) is None


@given(st.floats(-50, 50), st.floats(-50, 50), st.floats(-0.19, 0.19), st.floats(-0.19, 0.19))
def test_a_place_is_found_across_squares(x: float, y: float, dx: float, dy: float) -> None:
    places: Places[str] = Places(10, 0.2)
    places.put(x, y, "here")
    assert places.near(x + dx, y + dy) == "here"


def test_statements_are_values() -> None:
    assert replace(said(), number=2) != said() and hash(said()) == hash(said())
