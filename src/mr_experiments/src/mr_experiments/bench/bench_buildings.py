"""Whether teams come to their end, come home, touch nothing and draw right walls in other buildings, with other robots
and in larger teams than those of the office."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Callable, Mapping, NamedTuple, Sequence

import numpy as np

from mr_experiments.bench.bench_merging import row
from mr_experiments.bench.explore_missions import LIMIT, world_name
from mr_experiments.bench.mishaps import contacts, far_from_home, revoked_though_right
from mr_experiments.bench.rows import Row
from mr_experiments.trial.scenario import load_scenario
from mr_experiments.trial.trial import Trial
from mr_measures.record.mission_record import BIAS, MissionRecord

STRATEGY = 7
HALL, LOOP = "generated:hall:{}:48x20", "generated:loop:{}:45x40"  # wider than a Pioneer's laser reaches

Bars = tuple[float, float]  # percent of wrong walls: mean and worst of all maps
PIONEERS: Bars = (0.5, 3.0)
TURTLEBOTS: Bars = (3.0, 8.0)
WIDE_HALLS: Bars = (5.0, 5.0)


@dataclass(frozen=True)
class Kind:
    """`world`: from a seed; empty is the scenario's own. `unrevoked`: transforms that are right must stay. `limit`: s
    for a mission, the scenario's own if 0."""

    scenario: str
    teams: tuple[int, ...]
    walls: Bars = PIONEERS
    world: Callable[[int], str] = lambda seed: ""
    unrevoked: bool = False
    limit: float = 0.0


KINDS: Mapping[str, Kind] = {
    "narrow": Kind("narrow", (2, 4)),
    "unknown_poses": Kind("unknown_poses", (4,)),
    "turtlebot": Kind("turtlebot", (1, 2, 3, 4), TURTLEBOTS, unrevoked=True),
    "mixed": Kind("mixed", (4,), TURTLEBOTS, unrevoked=True),
    "halls": Kind("paper", (1, 4), WIDE_HALLS, HALL.format, unrevoked=True),
    "loops": Kind("paper", (1, 4), WIDE_HALLS, LOOP.format, unrevoked=True),
    "generated": Kind("paper", (1, 4), world=world_name, limit=LIMIT),
    "large": Kind("large", (4,)),
    "many": Kind("many", (8, 16)),
}
HUGE = ("large", "many")  # a quarter of an hour and more for each mission


class Group(NamedTuple):
    """Missions of one kind and team size, whose odometry errs in one way."""

    kind: str
    team: int
    odometry: str = BIAS

    @property
    def name(self) -> str:
        walks = "" if self.odometry == BIAS else f", {self.odometry.replace('_', ' ')}"
        return f"{self.kind}{walks}, R = {self.team}"


def trials_of(
    names: Sequence[str], seeds: Sequence[int], huge_seeds: Sequence[int], odometry: str = BIAS
) -> dict[Group, list[Trial]]:
    return {
        Group(name, team, odometry): [
            _trial(KINDS[name], team, seed, odometry) for seed in (huge_seeds if name in HUGE else seeds)
        ]
        for name in names
        for team in KINDS[name].teams
    }


def _trial(kind: Kind, team: int, seed: int, odometry: str) -> Trial:
    trial = load_scenario(kind.scenario).trial(team, STRATEGY, seed, kind.world(seed))
    return replace(trial, limit=kind.limit or trial.limit, odometry=odometry)


def table(groups: Mapping[Group, Sequence[MissionRecord]]) -> list[Row]:
    return [made for group, records in groups.items() for made in _rows_of(group, records)]


def _rows_of(group: Group, records: Sequence[MissionRecord]) -> list[Row]:
    what, kind = group.name, KINDS[group.kind]
    finished = [record for record in records if record.finished]
    late = _named([(record, record.outcome.reason) for record in records if not record.finished])
    rows = [_row(f"{what}: missions that finished", "all", len(finished), f"of {len(records)}",
                 len(finished) == len(records), _times(finished) + late)]  # fmt: skip
    away = [(record, f"{robot} is {off:.1f} m from home") for record in records for robot, off in far_from_home(record)]
    rows.append(_row(f"{what}: robots that did not get home", "0", len(away), "", not away, _named(away)))
    touched = [(record, robot, count) for record in records for robot, count in contacts(record).items()]
    total, who = sum(count for _, _, count in touched), _named([(record, robot) for record, robot, _ in touched])
    rows.append(_row(f"{what}: robots that touched something", "0", len(touched), "", not touched, who))
    rows.append(_row(f"{what}: contacts", "0", total, "", not total, ""))
    rows += _wall_rows(what, kind.walls, records)
    if kind.unrevoked and group.team > 1:
        revoked = [(record, f"{one} of {other} at {at:.0f} s") for record in records for one, other, at in
                   revoked_though_right(record)]  # fmt: skip
        rows.append(_row(f"{what}: right transforms revoked", "0", len(revoked), "", not revoked, _named(revoked)))
    return rows


def _wall_rows(what: str, bars: Bars, records: Sequence[MissionRecord]) -> list[Row]:
    """A robot that died has no say."""
    maps = [(record, name, 100.0 * robot.map.wrong_walls) for record in records
            for name, robot in record.survivors.items() if robot.map.wrong_walls is not None]  # fmt: skip
    if not maps:
        return [_row(f"{what}: wrong walls", "-", math.inf, "%", False, "no map")]
    shares = [share for _, _, share in maps]
    mean, worst = float(np.mean(shares)), max(shares)
    bad = _named([(record, f"{name} {share:.0f} %") for record, name, share in maps if share > bars[1]])
    return [
        _row(f"{what}: wrong walls, mean", f"<= {bars[0]:g}", mean, "%", mean <= bars[0], f"{len(maps)} maps"),
        _row(f"{what}: wrong walls, worst", f"<= {bars[1]:g}", worst, "%", worst <= bars[1], bad),
    ]


def _times(records: Sequence[MissionRecord]) -> str:
    times = [record.team.exploration_time for record in records if record.team.exploration_time is not None]
    return f"T {min(times):.0f} to {max(times):.0f} s, mean {float(np.mean(times)):.0f} s" if times else ""


def _named(cases: Sequence[tuple[MissionRecord, str]], most: int = 6) -> str:
    """The first cases with the seeds of their missions."""
    told = [f"; seed {record.asked.seed}: {text}" for record, text in cases[:most]]
    more = f"; {len(cases) - most} more" if len(cases) > most else ""
    return "".join(told) + more


def _row(what: str, bar: str, value: float, unit: str, holds: bool, detail: str) -> Row:
    return row(what, bar, value, unit, holds, detail.removeprefix("; "))
