"""Lists that grow while a mission runs, in every host: goals and auctions of one robot, and notes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from mr_measures.record.mission_record import Note
from mr_measures.record.robot_record import Auction, Goal, Offer

REACHED, FAILED, REPLACED, CANCELLED = "reached", "failed", "replaced", "cancelled"
MOST_NOTES = 500


class GoalLog:
    """Of one robot, which has one goal at most: a new one replaces the one before. Times in s of any one clock."""

    def __init__(self) -> None:
        self.goals: list[Goal] = []

    def begin(self, goal: Goal) -> None:
        self.end(goal.set, REPLACED)
        self.goals.append(goal)

    def end(self, at: float, outcome: str, text: str = "") -> None:
        """Of the present goal, if there is one; `text`: why it failed."""
        if self.goals and self.goals[-1].end is None:
            kept = text if outcome == FAILED else ""
            self.goals[-1] = replace(self.goals[-1], end=at, outcome=outcome, text=kept)


class AuctionLog:
    """Of one robot. Times in s of any one clock."""

    def __init__(self) -> None:
        self.auctions: list[Auction] = []

    def begin(self, auction: Auction) -> None:
        self.auctions.append(auction)

    def answer(self, number: int, robot: str, at: float) -> None:
        """Another robot has answered the open auction of this number; answers to others and late ones do not count."""
        latest = self._latest(number)
        if latest is not None and self.auctions[latest].decided is None:
            answered = self.auctions[latest].answered
            self.auctions[latest] = replace(self.auctions[latest], answered={robot: at, **answered})

    def end(self, number: int, at: float, unit: int, offers: Iterable[Offer]) -> None:
        """What came of the latest auction of this number, if there is one."""
        latest = self._latest(number)
        if latest is not None:
            self.auctions[latest] = replace(self.auctions[latest], unit=unit, offers=tuple(offers), decided=at)

    def _latest(self, number: int) -> int | None:
        """Where it is."""
        return max((i for i, auction in enumerate(self.auctions) if auction.id == number), default=None)


class NoteLog:
    """The first MOST_NOTES of a mission; the last says that more were dropped."""

    def __init__(self) -> None:
        self.notes: list[Note] = []

    def add(self, note: Note) -> None:
        if len(self.notes) < MOST_NOTES:
            self.notes.append(note)
            if len(self.notes) == MOST_NOTES:
                self.notes[-1] = replace(note, text="further notes were dropped", warning=True)
