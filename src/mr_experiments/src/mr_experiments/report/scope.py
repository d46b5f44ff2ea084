"""The part of a record set that one table or figure shows."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Mapping, Sequence

from mr_experiments.report import paper
from mr_experiments.report.record_set import Chapter, RecordSet
from mr_experiments.report.table import Column
from mr_measures.record.mission_record import BIAS, MissionRecord

ROBOTS = Column("robots", "R")


@dataclass(frozen=True)
class Scope:
    """The part of a record set that a table shows: team sizes of one chapter."""

    chapter: Chapter
    teams: Mapping[int, Sequence[MissionRecord]]

    @property
    def beside_paper(self) -> bool:
        """Whether these are the paper's simulations, repeated."""
        chapter = self.chapter
        is_paper = Path(chapter.world).stem == paper.WORLD and chapter.scenario == paper.SCENARIO
        return is_paper and chapter.odometry == BIAS

    @property
    def merges_judged(self) -> bool:
        return any(record.merges_judged for records in self.teams.values() for record in records)

    def results(self, robots: int) -> list[MissionRecord]:
        """Trials that came to a result, finished or not."""
        return [record for record in self.teams[robots] if not record.failed]


def scopes(records: RecordSet) -> list[Scope]:
    return [Scope(chapter, teams) for chapter, teams in records.chapters.items()]
