"""One row for each kind of mission among records: how long, how far, how much was known, and what went wrong."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from mr_experiments.bench.bench_explore import BEST, NEAREST
from mr_experiments.bench.explore_missions import MissionRow, row_of
from mr_experiments.bench.mishaps import contacts, far_from_home
from mr_experiments.common.statistics import mean_interval
from mr_measures.record.mission_record import BIAS, MissionRecord

KEYS = ("world", "scenario", "odometry", "strategy", "robots")
DEFAULTS = {"odometry": BIAS}  # of records that do not name it
WRONG_WALLS = 0.005  # share from which a map counts as one with walls out of place

Row = dict[str, Any]


def mission_rows(records: Sequence[MissionRecord]) -> list[Row]:
    """Sorted by KEYS; None for what there is not. Missions that failed are counted and enter nothing else."""
    groups: dict[tuple, list[MissionRecord]] = {}
    for record in records:
        groups.setdefault(tuple(record.asked.settings.get(key, DEFAULTS.get(key)) for key in KEYS), []).append(record)
    return [
        {**dict(zip(KEYS, key)), **_summary(group)} for key, group in sorted(groups.items(), key=lambda group: group[0])
    ]


def _summary(records: Sequence[MissionRecord]) -> Row:
    all_missions = [row_of(record) for record in records]
    came_to_a_result = [record for record in records if not record.failed]
    missions = [row_of(record) for record in came_to_a_result]
    finished = [mission for mission in missions if mission.time is not None]
    robots = [robot for record in came_to_a_result for robot in record.survivors.values()]
    maps = [robot.map for robot in robots]
    walls = [each.wrong_walls for each in maps if each.wrong_walls is not None]
    coverages = [each.coverage or 0.0 for each in maps]  # who has no map knows nothing
    errors = [abs(each.error) for each in maps if each.error is not None]
    return {
        "trials": len(records),
        "failed": len(records) - len(missions),
        "finished": sum(mission.status == "finished" for mission in missions),
        **_of_times(finished),
        "distance": _mean([mission.distance for mission in missions]),
        "coverage_mean": _mean(coverages),
        "coverage_worst": min(coverages, default=None),
        "abs_error_mean": _mean(errors),
        "wrong_walls_mean": _mean(walls),
        "wrong_walls_worst": max(walls, default=None),
        "wrong_maps": sum(share > WRONG_WALLS for share in walls),
        "maps": len(maps),
        "collisions": sum(sum(contacts(record).values()) for record in came_to_a_result),
        "not_home": sum(len(far_from_home(record)) for record in came_to_a_result),
        "first_seed": min(mission.seed for mission in all_missions),
        "last_seed": max(mission.seed for mission in all_missions),
        "code": " ".join(sorted({mission.code for mission in all_missions})),
    }


def _of_times(missions: Sequence[MissionRow]) -> Row:
    """T and what is told by it, of missions that finished."""
    times = [mission.time for mission in missions if mission.time is not None]
    interval = mean_interval(times)
    after = [1.0 - m.known_at / m.time for m in missions if m.time and m.known_at is not None]
    spread = [m.time - m.first_end for m in missions if m.time and m.first_end is not None]
    return {
        "time_mean": _mean(times),
        "time_low": None if interval is None else interval.low,
        "time_high": None if interval is None else interval.high,
        "time_median": float(np.median(times)) if times else None,
        "time_longest": max(times, default=None),
        "after_known": _mean(after),
        "ends_median": float(np.median(spread)) if spread else None,
        "ends_most": max(spread, default=None),
    }


def _mean(values: Sequence[float]) -> float | None:
    return float(np.mean(values)) if values else None


def world_rows(missions: Sequence[MissionRow]) -> list[Row]:
    """Of missions in generated worlds: what more robots and the best strategy bring, by kind of world and for all."""
    full = [mission for mission in missions if mission.world.startswith("generated:") and not mission.fast]
    kinds = sorted({mission.world.split(":")[1] for mission in full})
    groups = [(kind, [m for m in full if m.world.split(":")[1] == kind]) for kind in kinds]
    return [{"kind": kind, **_ratios(group)} for kind, group in [*groups, ("all", full)]]


def _ratios(missions: Sequence[MissionRow]) -> Row:
    times = {(m.world, m.robots, m.strategy): m.time for m in missions}
    worlds = sorted({m.world for m in missions})

    def mean(above: tuple[int, int], below: tuple[int, int]) -> float | None:
        pairs = [(times.get((world, *above)), times.get((world, *below))) for world in worlds]
        return _mean([one / other for one, other in pairs if one and other])

    row: Row = {"worlds": len(worlds)}
    for robots in (2, 4):
        row[f"t{robots}_over_t1"] = mean((robots, BEST), (1, BEST))
    for robots in (1, 2, 4):
        row[f"best_over_nearest_{robots}"] = mean((robots, BEST), (robots, NEAREST))
        after = [1.0 - m.known_at / m.time for m in missions
                 if (m.robots, m.strategy) == (robots, BEST) and m.time and m.known_at is not None]  # fmt: skip
        row[f"after_known_{robots}"] = _mean(after)
    return row
