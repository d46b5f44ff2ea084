"""How long a robot of a large team takes to decide on a large map. Rows as the other benchmarks'."""

from __future__ import annotations

import argparse
import gc
import statistics
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from explorer.agent import ExplorerAgent
from explorer.foreign import Key
from explorer.geometry import distance
from explorer.messages import Auction, Bid, SendAuction, SendFrontiers, SetGoal
from explorer.options import load
from mr_experiments.bench.rows import Row, exit_code, printed, row_of, write_rows
from mr_experiments.bench.scripted_team import ScriptedTeam
from mr_experiments.trial.trial_world import description_of

KIND, SEED, SIZE, ROBOTS = "office", 7, (100.0, 100.0), 8
WORLD = "office26x15"  # whose first robot all are
MEDIAN_BAR, WORST_BAR = 60.0, 200.0  # ms
MAP_PERIOD, TICK, SPEED = 2.0, 0.2, 0.5  # s, s, m/s
SHARES = (0.15, 0.4, 0.65)  # of the cells known when a stage begins
IDENTITY = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


class Bench:
    """One agent among robots whose part is played: all but the last answer its auctions and claim what is nearest to
    them. `first`, `maps`, `between`: ms of processor time of the steps with the first maps of the stages, with the
    other maps, and without a map; a step is what the agent does between two waits."""

    def __init__(self, team: ScriptedTeam, strategy: int) -> None:
        self._team = team
        self._names = [f"robot_{number}" for number in range(len(team.poses))]
        self._agent = ExplorerAgent(load({"frontier_selection": strategy}, host_name=self._names[0]))
        self._places: dict[Key, tuple[float, float]] = {}
        self._now = 100.0
        self.first: list[float] = []
        self.maps: list[float] = []
        self.between: list[float] = []
        self._agent.start(self._now)
        self._agent.on_robots(self._names[1:], self._now)
        for name in self._names[1:]:
            self._agent.on_transform(name, IDENTITY, self._now)

    def stage(self, maps: int) -> None:
        """The team drives on, and the agent takes so many maps after the first one, which shows much that is new."""
        for number in range(maps + 1):
            self._team.drive(MAP_PERIOD * SPEED)
            self._tell_poses()
            occupancy = self._team.map()
            (self.maps if number else self.first).append(self._step(occupancy))
            for _ in range(round(MAP_PERIOD / TICK) - 1):
                self._now += TICK
                self.between.append(self._step(None))
            self._now += TICK

    def _tell_poses(self) -> None:
        poses = self._team.poses
        self._agent.on_pose(poses[0], self._now)
        self._agent.on_positions({n: (p.x, p.y) for n, p in zip(self._names[1:], poses[1:])}, self._now)

    def _step(self, occupancy: Any) -> float:
        """ms until nothing is left to do, with the answers of the others at once."""
        begun = time.process_time()
        if occupancy is not None:
            self._agent.on_global_map(occupancy, self._now)
            self._agent.on_own_map(self._now)
        effects = self._agent.tick(self._now)
        spent = time.process_time() - begun
        replies = self._replies(effects)
        while replies:
            begun = time.process_time()
            for reply in replies:
                self._agent.on_auction(reply, self._now)
            effects = self._agent.tick(self._now)
            spent += time.process_time() - begun
            replies = self._replies(effects)
        return 1e3 * spent

    def _replies(self, effects: Sequence[Any]) -> list[Auction]:
        replies: list[Auction] = []
        for effect in effects:
            if isinstance(effect, SetGoal):
                self._agent.on_goal_accepted(effect.goal_id, self._now)
            elif isinstance(effect, SendFrontiers):
                self._places.update({element.key: (element.x, element.y) for element in effect.elements})
            elif isinstance(effect, SendAuction) and effect.auction.start:
                for name, pose in list(zip(self._names, self._team.poses))[1:-1]:
                    replies += self._answers(name, (pose.x, pose.y), effect.auction)
        return replies

    def _answers(self, name: str, place: tuple[float, float], start: Auction) -> list[Auction]:
        """The bids of a robot, and its claim."""
        bids = []
        for offer in start.requested:
            gaps = [distance(place, self._places[key]) for key in offer.elements if key in self._places]
            bids.append(Bid(offer.elements, 1.3 * min(gaps, default=10.0)))
        nearest = min(bids, key=lambda bid: bid.bid)
        claim = Auction(name, start.auction_id + 1, status=True, finished=True, occupied=nearest.elements)
        return [Auction(name, start.auction_id, status=False, available=tuple(bids), unit=start.unit), claim]


def row(what: str, bar: float, times: Sequence[float], value: float, detail: str = "") -> Row:
    """Prints and returns a row."""
    holds, value = value <= bar, round(value, 1)
    detail += f"{len(times)} steps, median {statistics.median(times):.1f}, worst {max(times):.1f} ms"
    return printed(row_of(what, f"<= {bar:g}", value, "ms", holds, detail))


def rows(maps: int, strategy: int) -> list[Row]:
    """`maps`: of each stage."""
    team = ScriptedTeam(KIND, SEED, SIZE, ROBOTS, description_of(WORLD).robots[0])
    bench = Bench(team, strategy)
    shares = []
    gc.disable()  # its pauses depend on what else is in memory
    for share in SHARES:
        while team.known < share and team.drive(MAP_PERIOD * SPEED):
            pass
        shares.append(team.known)
        bench.stage(maps)
    gc.enable()
    where = f"{ROBOTS} robots, {team.info.width} x {team.info.height} cells"
    detail = f"from {', '.join(f'{100.0 * share:.0f}' for share in shares)} % known; "
    return [
        row(f"decision on a new map, {where}, median", MEDIAN_BAR, bench.maps, statistics.median(bench.maps), detail),
        row(f"decision on a new map, {where}, worst", WORST_BAR, bench.maps, max(bench.maps), detail),
        row(f"first map of a stage, {where}, worst", WORST_BAR, bench.first, max(bench.first)),
        row(f"steps between maps, {where}, worst", WORST_BAR, bench.between, max(bench.between)),
    ]


def main(argv: Sequence[str]) -> int:
    """Prints the rows, writes them if asked; returns 0 when every bar holds, 1 otherwise."""
    parser = argparse.ArgumentParser(prog="bench decisions", description="Time to decide on a large map.")
    parser.add_argument("--out", type=Path, metavar="FILE", help="JSON file to write the rows to")
    parser.add_argument("--maps", type=int, default=40, metavar="N", help="of each stage (default: %(default)s)")
    parser.add_argument("--strategy", type=int, default=7, metavar="N", help="(default: %(default)s)")
    arguments = parser.parse_args(argv)
    if arguments.maps < 1:
        parser.error(f"--maps {arguments.maps} must be at least 1")
    made = rows(arguments.maps, arguments.strategy)
    if arguments.out:
        write_rows(made, arguments.out)
    return exit_code(made)
