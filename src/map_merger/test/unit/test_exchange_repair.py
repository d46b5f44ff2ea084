"""Exchanges of several robots on virtual time: losses, restarts, partitions, and what a lost message may hold up."""

from dataclasses import replace

import numpy as np
import pytest

from map_merger.delivery import Delivery
from map_merger.effects import DELIVERED, Note, Outcome, Purpose, Send
from map_merger.exchange import Exchange, bounds
from map_merger.exchange_benchmark import reconnect
from map_merger.messages import NO_BOOT, Anchor, Request, Tile
from map_merger.options import options_of
from mr_grid import UNKNOWN, GridInfo, OccupancyGrid

INFO = GridInfo(0, 0, 0.05)


def exchange_of(name="robot_0", boot=(1, 0), **changes):
    return Exchange(options_of({"debug": False, **changes}, name), boot)


def square(size=20, value=0):
    return OccupancyGrid(GridInfo(size, size, 0.05), np.full((size, size), value, np.int8))


def tile(number, boot=(1, 1), robot="robot_1", size=4):
    return Tile(robot, (number,), 0, 0, np.zeros((size, size), np.int8), 0.05, boot, number + 1)


def sends(exchange, purpose=None):
    return [each for each in exchange.effects() if isinstance(each, Send) and purpose in (None, each.purpose)]


def notes(exchange):
    return [each for each in exchange.effects() if isinstance(each, Note)]


def drive(exchange, begin, end, step=0.25):
    """Ticks from `begin` to `end`; every send arrives."""
    found = []
    for index in range(round((end - begin) / step)):
        now = begin + index * step
        exchange.tick(now)
        for send in sends(exchange):
            found.append((now, send))
            exchange.on_sent(send, DELIVERED, now)
    return found


def requests(found, robot="robot_1"):
    return [now for now, send in found if send.purpose is Purpose.REQUEST and send.destination == robot]


@pytest.mark.parametrize("seed", range(4))
def test_after_losses_restarts_and_a_partition_all_maps_are_equal_within_ten_seconds(seed):
    outcome = reconnect(seed)
    assert outcome.seconds is not None and outcome.seconds <= 10.0


# Runs


def test_one_late_tile_of_another_run_is_asked_about_a_few_times_only():
    """It made a robot ask for everything for ever: 210 requests in 10 minutes."""
    exchange = exchange_of()
    exchange.on_anchor(Anchor("robot_1", INFO, (1, 1), 1), 0.0)
    exchange.on_tile(tile(0), 0.0)
    exchange.on_tile(tile(7, boot=(5, 5)), 0.0)
    assert 1 <= len(requests(drive(exchange, 0.0, 600.0))) <= 6


def test_one_late_tile_of_a_former_run_is_not_asked_about():
    exchange = exchange_of()
    for boot in ((5, 5), (1, 1)):
        exchange.on_anchor(Anchor("robot_1", INFO, boot, 1), 0.0)
        exchange.on_tile(tile(0, boot), 0.0)
    exchange.on_tile(tile(7, (5, 5)), 0.0)
    assert requests(drive(exchange, 0.0, 600.0)) == []


def test_a_restart_is_told_once_and_a_repeated_anchor_is_no_news():
    """Every anchor counted as a change of the map, and everything was drawn again."""
    exchange = exchange_of()
    exchange.on_anchor(Anchor("robot_1", INFO, (1, 1), 1), 0.0)
    exchange.on_tile(tile(0), 0.0)
    before = exchange.version_of("robot_1"), exchange.run_of("robot_1")
    for now in range(100):
        exchange.on_anchor(Anchor("robot_1", INFO, (1, 1), 1), float(now))
    assert (exchange.version_of("robot_1"), exchange.run_of("robot_1")) == before
    exchange.effects()
    exchange.on_anchor(Anchor("robot_1", INFO, (2, 1), 0), 100.0)
    assert ["restarted" in note.text for note in notes(exchange)] == [True]
    assert exchange.run_of("robot_1") == before[1] + 1 and exchange.map_of("robot_1") is None


def test_a_sender_without_anchor_gets_one_warning():
    exchange = exchange_of()
    exchange.on_tile(tile(0, NO_BOOT), 0.0)
    warnings = []
    for step in range(200):
        exchange.tick(0.5 * step)
        warnings += [note for note in notes(exchange) if note.warning]
    assert len(warnings) == 1 and "no anchor" in warnings[0].text
    assert exchange.map_of("robot_1").info.shape == (4, 4)


# Pauses


def test_what_is_missing_is_asked_for_at_once_when_a_robot_is_back():
    """The pause had grown to half a minute while the robot was away."""
    exchange = exchange_of()
    exchange.on_robot("robot_1", 0.0)
    drive(exchange, 0.0, 300.0)
    exchange.on_robot_lost("robot_1")
    assert requests(drive(exchange, 300.0, 400.0)) == []
    exchange.on_robot("robot_1", 400.0, returned=True)
    assert requests(drive(exchange, 400.0, 402.0))[0] <= 401.0


def test_the_first_message_of_a_lost_robot_is_as_good_as_its_return():
    exchange = exchange_of()
    exchange.on_robot("robot_1", 0.0)
    drive(exchange, 0.0, 300.0)
    exchange.on_robot_lost("robot_1")
    exchange.on_heard("robot_1")
    assert exchange.present("robot_1")
    assert requests(drive(exchange, 300.0, 302.0))[0] <= 301.0


def test_a_tile_that_does_not_fit_is_asked_for_with_growing_pauses():
    """It came again every two seconds, for ever."""
    exchange, asked = exchange_of(), 0
    exchange.on_anchor(Anchor("robot_1", INFO, (1, 1), 1), 0.0)
    for second in range(600):
        found = requests(drive(exchange, float(second), second + 1.0))
        asked += len(found)
        for now in found:
            exchange.on_tile(replace(tile(0), resolution=0.1), now)
    assert 15 <= asked <= 30


def test_a_robot_that_has_no_map_yet_is_not_asked_more_often_for_telling_its_position():
    exchange = exchange_of()
    asked = 0
    for second in range(600):
        exchange.on_heard("robot_1")
        asked += len(requests(drive(exchange, float(second), second + 1.0)))
    assert asked <= 30


def test_a_clock_that_jumps_back_wedges_nothing():
    exchange = exchange_of()
    exchange.on_local_map(square())
    exchange.on_robot("robot_1", 1000.0)
    drive(exchange, 1000.0, 1100.0)
    exchange.on_local_map(square(value=100))
    found = drive(exchange, 0.0, 40.0)
    assert any(send.purpose is Purpose.CHANGES for _, send in found)
    assert any(send.purpose is Purpose.ANCHOR for _, send in found)
    assert requests(found)


# Sends


def strip(size=80):
    """Sent in four tiles of 20 cells."""
    return OccupancyGrid(GridInfo(size, 20, 0.05), np.zeros((20, size), np.int8))


def group_send(exchange, now=0.0):
    exchange.tick(now)
    (send,) = sends(exchange, Purpose.CHANGES)
    return send


def test_one_undelivered_tile_does_not_end_a_group_send():
    send = Send(1, Purpose.CHANGES, "mc_robot_0", tuple(tile(number) for number in range(4)))
    delivery, tried = Delivery(send), []
    while delivery.next is not None:
        tried.append(delivery.next)
        delivery.ended(len(tried) != 2)
    assert tried == list(send.payloads)
    assert reported(delivery) == Outcome((send.payloads[1],))


def test_an_answer_stops_at_the_first_failure():
    send = Send(1, Purpose.ANSWER, "robot_1", tuple(tile(number) for number in range(4)))
    delivery = Delivery(send)
    delivery.ended(True)
    delivery.ended(False, too_large=True)
    assert delivery.next is None
    assert reported(delivery) == Outcome(send.payloads[1:], send.payloads[1])


def test_a_delivery_of_everything_and_one_of_nothing():
    delivery = Delivery(Send(1, Purpose.ANSWER, "robot_1", (tile(0),)))
    delivery.ended(True)
    assert reported(delivery) == DELIVERED
    assert reported(Delivery(Send(1, Purpose.ANSWER, "robot_1", ()))) == DELIVERED


def reported(delivery):
    class Sender:
        def on_sent(self, send, outcome, now):
            self.outcome = outcome

    sender = Sender()
    delivery.report(sender, 0.0)
    return sender.outcome


def test_only_the_tiles_that_were_not_delivered_are_sent_again():
    """One undelivered tile of a group send brought all of them again."""
    exchange = exchange_of(split_size=20)
    exchange.on_local_map(strip())
    send = group_send(exchange)
    assert [payload.numbers for payload in send.payloads[1:]] == [(0,), (1,), (2,), (3,)]
    exchange.on_sent(send, Outcome((send.payloads[3],)), 0.0)
    exchange.tick(1.0)
    (again,) = sends(exchange, Purpose.CHANGES)
    assert [payload.numbers for payload in again.payloads] == [(2,)]
    exchange.on_sent(again, DELIVERED, 1.0)
    assert not [send for _, send in drive(exchange, 2.0, 100.0) if send.purpose is Purpose.CHANGES]


def test_undelivered_updates_are_bounded_and_the_rest_is_left_to_requests():
    exchange = exchange_of(split_size=4)
    exchange.on_local_map(square(60))
    send = group_send(exchange)
    assert len(send.payloads) > 2 * bounds.MOST_RESENT
    exchange.on_sent(send, Outcome(send.payloads), 0.0)
    exchange.tick(1.0)
    (again,) = sends(exchange, Purpose.CHANGES)
    tiles = [payload for payload in again.payloads if isinstance(payload, Tile)]
    assert len(tiles) == bounds.MOST_RESENT and tiles[-1].numbers == (exchange.updates - 1,)


def test_a_slow_group_send_holds_back_neither_answers_nor_requests_nor_anchors():
    """They waited in one queue; here as well no send waits for the end of one with another purpose."""
    exchange = exchange_of()
    exchange.on_local_map(square())
    group_send(exchange)
    exchange.on_request(Request("robot_1", ()), 1.0)
    found = []
    for step in range(40):
        exchange.tick(1.0 + 0.25 * step)
        found += [send.purpose for send in sends(exchange)]
    assert {Purpose.ANSWER, Purpose.REQUEST, Purpose.ANCHOR} <= set(found) and Purpose.CHANGES not in found


def test_an_answer_goes_on_where_it_failed_and_ends_when_nothing_arrives():
    exchange = exchange_of(split_size=20)
    exchange.on_local_map(strip())
    exchange.on_sent(group_send(exchange), DELIVERED, 0.0)
    exchange.on_request(Request("robot_1", (0, 1, 2, 3)), 1.0)
    (answer,) = sends(exchange)
    exchange.on_sent(answer, Outcome(answer.payloads[2:]), 1.0)
    (rest,) = sends(exchange)
    assert rest.payloads == answer.payloads[2:]
    tries = 0
    while rest:
        tries += 1
        exchange.on_sent(rest, Outcome(rest.payloads), 1.0)
        rest = next(iter(sends(exchange)), None)
    assert tries == bounds.ANSWER_TRIES
    exchange.on_request(Request("robot_1", (3,)), 2.0)
    assert len(sends(exchange)) == 1, "the next request is answered"


def test_an_answer_to_a_robot_that_was_lost_meanwhile_ends():
    exchange = exchange_of()
    exchange.on_local_map(square())
    exchange.on_sent(group_send(exchange), DELIVERED, 0.0)
    exchange.on_request(Request("robot_1", ()), 1.0)
    (answer,) = sends(exchange)
    exchange.on_robot_lost("robot_1")
    exchange.on_sent(answer, Outcome(answer.payloads), 1.0)
    assert sends(exchange) == []


# Bounds


def test_robots_beyond_the_bound_are_ignored_with_one_warning():
    exchange = exchange_of()
    for number in range(1, 200):
        exchange.on_robot(f"robot_{number}", 0.0)
    assert len(exchange.robots()) == bounds.MOST_ROBOTS
    assert sum(note.warning for note in notes(exchange)) == 1
    exchange.on_tile(tile(0, robot="robot_199"), 0.0)
    assert exchange.map_of("robot_199") is None and exchange.run_of("robot_199") == 0


def test_nothing_is_known_of_strangers():
    exchange = exchange_of()
    assert exchange.map_of("x") is None and exchange.take_changed("x") is None and exchange.lattice_of("x") is None
    assert exchange.version_of("x") == 0 and exchange.missing("x") == () and not exchange.present("x")
    assert not exchange.meet("robot_0") and not exchange.meet("")


def test_unknown_cells_reach_the_other_side():
    sender, receiver = exchange_of(), exchange_of("robot_1", (1, 1))
    for cells in (np.zeros((8, 8)), np.pad(np.zeros((8, 4)), ((0, 0), (0, 4)), constant_values=UNKNOWN)):
        sender.on_local_map(OccupancyGrid(GridInfo(8, 8, 0.05), cells.astype(np.int8)))
        now = 10.0 * sender.updates
        sender.tick(now)
        for send in sends(sender, Purpose.CHANGES):
            for payload in send.payloads:
                (receiver.on_anchor if isinstance(payload, Anchor) else receiver.on_tile)(payload, now)
            sender.on_sent(send, DELIVERED, now)
    assert receiver.map_of("robot_0").info.shape == (8, 4)


def lone_anchor(robot, updates=1):
    return Anchor(robot, INFO, (1, 1), updates)


def test_a_map_for_which_there_is_no_room_is_asked_for_ever_more_seldom(monkeypatch):
    """Each answer begins with an anchor, and part of it fits; neither makes the next request come sooner."""
    monkeypatch.setattr(bounds, "MOST_MAP_CELLS", 64 * 64)
    exchange, found = exchange_of(), []
    for begin in range(100, 700):
        exchange.on_anchor(lone_anchor("robot_1", 3), begin)
        exchange.on_tile(tile(0), begin)
        exchange.on_tile(replace(tile(1), row=200), begin)
        found += drive(exchange, begin, begin + 1)
    asked = requests(found)
    assert len(asked) < 30
    assert asked[-1] - asked[-2] == pytest.approx(bounds.LONGEST_REQUEST_PAUSE_S, abs=1.5)


def test_a_request_that_is_on_its_way_is_not_followed_by_another():
    exchange, waiting = exchange_of(), []
    for step in range(400):
        now = 100.0 + 0.25 * step
        exchange.on_anchor(lone_anchor("robot_1"), now)
        exchange.tick(now)
        waiting += sends(exchange, Purpose.REQUEST)
    assert len(waiting) == 1
    exchange.on_sent(waiting[0], Outcome(waiting[0].payloads), 200.0)
    assert requests(drive(exchange, 200.0, 240.0))


def test_a_map_that_others_could_not_store_with_its_margin_is_not_sent(monkeypatch):
    monkeypatch.setattr(bounds, "MOST_MAP_CELLS", 128 * 128)
    exchange = exchange_of(split_size=2048)
    exchange.on_robot("robot_1", 100.0)
    exchange.on_local_map(square(120))
    found = drive(exchange, 100.0, 130.0)
    assert not [send for _, send in found if send.purpose is Purpose.CHANGES]
