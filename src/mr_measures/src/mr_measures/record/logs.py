"""Lists that grow while a mission runs, in every host: the goals of one robot, and notes."""

from __future__ import annotations

from dataclasses import replace

from mr_measures.record.mission_record import Note
from mr_measures.record.robot_record import Goal

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


class NoteLog:
    """The first MOST_NOTES of a mission; the last says that more were dropped."""

    def __init__(self) -> None:
        self.notes: list[Note] = []

    def add(self, note: Note) -> None:
        if len(self.notes) < MOST_NOTES:
            self.notes.append(note)
            if len(self.notes) == MOST_NOTES:
                self.notes[-1] = replace(note, text="further notes were dropped", warning=True)
