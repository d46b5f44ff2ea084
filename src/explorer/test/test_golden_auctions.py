"""What strategy 1 says in its auctions, message by message, beside what the paper's contract makes of it (3.7).

Bids are squared distances in m^2 as the crow flies, cut to whole ones. The corridor of `test_agent` is open at x = -4
and x = 4; robot_0 stands at x = 0.5. The transcripts in `golden_auctions.txt` were checked by hand;
`python3 test_golden_auctions.py` prints them.
"""

import math
from pathlib import Path
from typing import Callable, Dict, List

import pytest
from test_agent import Bench, corridor, opened, reply, side_of

from explorer.foreign import Element
from explorer.messages import Auction, Bid, SendAuction, SetGoal

GOLDEN = Path(__file__).parent / "golden_auctions.txt"


def all_answer() -> Bench:
    bench, start = opened(peers=("robot_1", "robot_2"))
    for robot, right, left in (("robot_1", 1.0, 81.0), ("robot_2", 400.0, 900.0)):
        bids = [0.0, 0.0]
        bids[side_of(start, bench, 1.0)], bids[side_of(start, bench, -1.0)] = right, left
        bench.agent.on_auction(reply(start, robot, bids), bench.now)
    bench.run(0.4)
    return bench


def nobody_answers() -> Bench:
    """The other robot's place counts for its bids: it is nearer to the left end, and robot_0 to the right one."""
    bench, _ = opened(position=(-3.0, 0.0))
    bench.run(1.4)
    return bench


def end_of_robot_1(side: float) -> List[Element]:
    """Its points along one end of the corridor."""
    first = 20000 if side > 0 else 20100
    return [Element("robot_1", first + i, 3.95 * side, -1.0 + 0.2 * i) for i in range(11)]


def one_end_is_taken() -> Bench:
    """As before, but robot_1 has said that it explores the right end. The assignment still gives the free one to
    robot_1, which is nearer; robot_0 takes it when nobody has claimed it for 4 s."""
    bench = Bench(1).map(corridor()).join("robot_1", position=(-3.0, 0.0))
    right = end_of_robot_1(1.0)
    bench.agent.on_frontiers(right, bench.now)
    occupied = tuple(element.key for element in right)
    bench.agent.on_auction(Auction("robot_1", 20005, True, finished=True, occupied=occupied), bench.now)
    bench.run(6.0)
    return bench


def another_one_asks() -> Bench:
    """It bids for both ends, though it explores one of them; a cluster that it does not know is worth -1."""
    bench = Bench(1).map(corridor()).join("robot_1", position=(-3.0, 0.0))
    bench.run(1.6)
    bench.effects.clear()
    ends = [end_of_robot_1(side) for side in (1.0, -1.0)]
    bench.agent.on_frontiers([*ends[0], *ends[1]], bench.now)
    asked = tuple(Bid(tuple(element.key for element in end), 1.0) for end in ends)
    asked += (Bid((("robot_1", 4711),), 1.0),)
    bench.agent.on_auction(Auction("robot_1", 20007, True, start=True, requested=asked), bench.now)
    bench.run(0.2)
    return bench


SCENES: Dict[str, Callable[[], Bench]] = {
    "all answer": all_answer,
    "nobody answers": nobody_answers,
    "one end is taken": one_end_is_taken,
    "another one asks": another_one_asks,
}


def transcript(bench: Bench) -> List[str]:
    """One line for each auction message and goal."""
    lines = []
    for effect in bench.effects:
        if isinstance(effect, SendAuction):
            lines.append(_said(effect.auction, bench))
        elif isinstance(effect, SetGoal):
            lines.append(f"drives to the {'right' if effect.pose.x > 0 else 'left'}")
    return lines


def _said(auction: Auction, bench: Bench) -> str:
    kind = "start" if auction.start else "closing" if auction.status else "answer"
    bids = sorted(f"{_end(bid, bench)} {bid.bid:g}" for bid in (*auction.requested, *auction.available))
    taken = [_end(Bid(auction.occupied), bench)] if auction.occupied else []
    return f"{kind} {auction.auction_id}: {', '.join([*bids, *(f'takes the {end}' for end in taken)]) or 'nothing'}"


def _end(bid: Bid, bench: Bench) -> str:
    own = bench.agent.perception.frontiers.frontiers
    told = {element.key: element.x for side in (1.0, -1.0) for element in end_of_robot_1(side)}
    places = [own[key[1]].x if key[0] == "robot_0" else told.get(key, math.nan) for key in bid.elements]
    return "unknown" if math.isnan(places[0]) else "right" if places[0] > 0 else "left"


def golden() -> Dict[str, List[str]]:
    blocks = [block.splitlines() for block in GOLDEN.read_text().strip().split("\n\n")]
    return {block[0].rstrip(":"): [line.strip() for line in block[1:]] for block in blocks}


@pytest.mark.parametrize("name", SCENES)
def test_auctions_of_strategy_1_are_as_ever(name: str) -> None:
    assert transcript(SCENES[name]()) == golden()[name]


if __name__ == "__main__":
    for name, scene in SCENES.items():
        print(f"{name}:", *transcript(scene()), sep="\n  ", end="\n\n")
