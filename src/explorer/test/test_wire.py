"""Frontiers and auctions through messages and back: who detected what, in simulation and on real robots."""

import pkgutil
from dataclasses import replace
from io import BytesIO

import pytest

import explorer

# The generated messages lie in a folder of their own, and where ROS is not installed there are none.
explorer.__path__ = pkgutil.extend_path(explorer.__path__, "explorer")
for package in ("adhoc_communication.msg", "explorer.msg", "move_base_msgs.msg"):
    pytest.importorskip(package, reason="the messages of ROS are not here")

from explorer import ros_io, ros_verdicts  # noqa: E402
from explorer.auction import OpenAuction, reply_message  # noqa: E402
from explorer.clusters import Cluster  # noqa: E402
from explorer.foreign import Element  # noqa: E402
from explorer.frontiers import Frontier  # noqa: E402
from explorer.messages import Auction, Bid, SendStatement  # noqa: E402
from explorer.statement import MOST_LEFT, MOST_VERDICTS, Decided, Kind, LeftPlace, Stage, Statement  # noqa: E402

SENDERS = [("robot_0", "robot_1", True), ("joy", "bob", False), ("7", "8", False), ("robot_3", "robot_4", False)]


@pytest.mark.parametrize("sender, receiver, simulation", SENDERS)
def test_points_keep_their_robot_however_many_there_are(sender: str, receiver: str, simulation: bool) -> None:
    """In simulation the 10000th point of robot_0 was taken for one of robot_1."""
    elements = [Element(sender, number, 1.0, 2.0) for number in (0, 9999, 10000, 123456)]
    message = ros_io.Wire(simulation).frontier_to(elements)
    assert ros_io.Wire(simulation).elements_from(message) == tuple(elements)
    keys = tuple(element.key for element in elements)
    auction = Auction(sender, 5, True, occupied=keys, requested=(Bid(keys, 2.5),), available=(Bid(keys, -1.0),))
    assert ros_io.Wire(simulation).auction_from(ros_io.Wire(simulation).auction_to(auction)) == auction


@pytest.mark.parametrize("sender, receiver, simulation", SENDERS)
def test_bids_find_their_cluster_however_high_its_numbers_are(sender: str, receiver: str, simulation: bool) -> None:
    """Bids for such points were dropped, and the bidder was taken for one that has finished."""
    cluster = Cluster(3, tuple(Frontier(number, 0.1 * number, 0.0) for number in (9999, 10000, 20001)))
    auction = OpenAuction(7, [cluster], sender, {receiver}, 1.0)
    here, there = ros_io.Wire(simulation), ros_io.Wire(simulation)
    start = there.auction_from(here.auction_to(auction.start_message({3: 4.0})))
    reply = reply_message(receiver, start.auction_id, [Bid(bid.elements, 6.5) for bid in start.requested])
    assert auction.add(here.auction_from(there.auction_to(reply)))
    assert auction.bids == {receiver: {3: 6.5}}


def test_numbers_count_only_in_simulation_where_the_name_is_missing() -> None:
    message = ros_io.Wire(True).frontier_to([Element("robot_2", 20001, 0.0, 0.0)])
    assert message.frontier_element[0].detected_by_robot == 2
    message.frontier_element[0].detected_by_robot_str = ""
    assert ros_io.Wire(True).elements_from(message)[0].key == ("robot_2", 20001)
    auction = ros_io.Wire(True).auction_to(Auction("robot_2", 5, True, occupied=(("robot_2", 20001),)))
    auction.occupied_ids[0].detected_by_robot_str = ""
    assert auction.robot_name == "2"
    decoded = ros_io.Wire(True).auction_from(auction)
    assert (decoded.robot, decoded.occupied) == ("robot_2", (("robot_2", 20001),))


def test_a_real_robot_may_have_a_number_for_a_name() -> None:
    """A robot named "7" became "robot_7", which nobody knew."""
    assert ros_io.Wire(False).auction_from(ros_io.Wire(False).auction_to(Auction("7", 1, True))).robot == "7"


@pytest.mark.parametrize("simulation", [True, False])
@pytest.mark.parametrize("kind", ["start", "answer"])
def test_the_unit_of_bids_travels_where_nobody_looks(simulation: bool, kind: str) -> None:
    """The list that the contract has for messages of that kind is as before."""
    bids = (Bid((("robot_1", 20001),), 2.5), Bid((("robot_1", 20002),), -1.0))
    given = {"requested": bids} if kind == "start" else {"available": bids}
    paper = Auction("robot_1", 5, status=kind == "start", start=kind == "start", **given)
    metres = replace(paper, unit=7)
    sender, receiver = ros_io.Wire(simulation), ros_io.Wire(simulation)
    plain, told = sender.auction_to(paper), sender.auction_to(metres)
    assert not (plain.available_clusters if kind == "start" else plain.requested_clusters)
    read, hidden = ("requested_clusters", "available_clusters")[:: 1 if kind == "start" else -1]
    assert getattr(told, read) == getattr(plain, read)
    assert [(list(entry.ids_contained), entry.bid) for entry in getattr(told, hidden)] == [([], 7.0)]
    assert receiver.auction_from(plain) == paper and receiver.auction_from(told) == metres


@pytest.mark.parametrize("bid", [float("nan"), float("inf"), 1e300])
def test_a_unit_that_is_none_is_not_one(bid: float) -> None:
    message = ros_io.Wire(True).auction_to(Auction("robot_1", 5, status=True, start=True))
    message.available_clusters = [ros_io.ExpCluster(bid=bid)]
    assert ros_io.Wire(True).auction_from(message).unit == 1


def sent(statement: Statement) -> ros_verdicts.TeamVerdicts:
    octets = BytesIO()
    ros_verdicts.verdicts_to(SendStatement(statement)).serialize(octets)
    return ros_verdicts.TeamVerdicts().deserialize(octets.getvalue())


def test_a_statement_arrives_as_it_was_said() -> None:
    verdicts = (Decided(1.5, -2.0, Kind.GIVEN_UP, 0.25), Decided(3.0, 4.0, Kind.LOOKED, 0.0))
    said = Statement("bob", 2**32 - 1, 3, Stage.ENDED, 40.5, verdicts, (LeftPlace(1.0, 2.0, 0.5, "inside a wall"),))
    assert ros_verdicts.statement_from(sent(said)) == said


def test_of_a_statement_no_more_is_read_than_there_may_be() -> None:
    verdicts = (Decided(1.0, 2.0, Kind.VISITED, 0.0),) * 300
    said = Statement("bob", 1, 1, Stage.ENDED, 1.0, verdicts, (LeftPlace(1.0, 2.0, 0.5, ""),) * 300)
    read = ros_verdicts.statement_from(sent(said))
    assert read is not None and (len(read.verdicts), len(read.left)) == (MOST_VERDICTS, MOST_LEFT)


def test_stages_and_kinds_that_there_are_not() -> None:
    message = sent(Statement("bob", 1, 1, Stage.ENDED, 1.0, (Decided(1.0, 2.0, Kind.VISITED, 0.0),) * 2))
    message.verdicts[0].kind = 9
    read = ros_verdicts.statement_from(message)
    assert read is not None and len(read.verdicts) == 1
    message.stage = 4
    assert ros_verdicts.statement_from(message) is None
