"""What more robots and a better strategy bring in worlds that nothing was tuned on. Rows as the other benchmarks'."""

from __future__ import annotations

import math
from typing import Callable, Mapping, Sequence

import numpy as np

from mr_experiments.bench.bench_merging import row
from mr_experiments.bench.explore_missions import OFFICE, Bounds, MissionRow
from mr_experiments.bench.rows import Row

BEST, NEAREST = 7, 0  # strategies
MOST = 4  # robots of the teams that the bars are for
TWO_BAR, FOUR_BAR, WORST_FOUR_BAR = 0.65, 0.48, 0.8
BOUND_BARS = {1: 3.0, MOST: 2.5}
STRATEGY_BARS = {1: 0.8, MOST: 0.6}
MEAN_COVERAGE_BAR, WORST_COVERAGE_BAR = 0.999, 0.995
FAST_BARS = 0.85, 1.15  # mean T in fast mode over mean T in full mode
AFTER_BAR = 12.0  # percent of T
END_BAR = 10.0  # s

Missions = Mapping[tuple, MissionRow]  # world, robots, strategy -> mission


def table(rows: Sequence[MissionRow], bounds: Bounds) -> list[Row]:
    """The rows that the missions suffice for. A ratio is taken world by world, of missions that finished; worlds in
    which one of the two did not are counted in the detail, and the bar is missed."""
    everything, rows = rows, [mission for mission in rows if mission.world != OFFICE and not mission.fast]
    missions = {(mission.world, mission.robots, mission.strategy): mission for mission in rows}
    best = [mission for mission in rows if mission.strategy == BEST]
    found = [
        _ratios("mean T(2) / T(1)", missions, (2, BEST), (1, BEST), TWO_BAR),
        _ratios(f"mean T({MOST}) / T(1)", missions, (MOST, BEST), (1, BEST), FOUR_BAR),
        _ratios(f"worst T({MOST}) / T(1)", missions, (MOST, BEST), (1, BEST), WORST_FOUR_BAR, max),
        *(_against_bound(best, bounds, robots, bar) for robots, bar in BOUND_BARS.items()),
        *(_ratios(f"strategy {BEST} over strategy {NEAREST}, R = {robots}: mean T / T", missions, (robots, BEST),
                  (robots, NEAREST), bar) for robots, bar in STRATEGY_BARS.items()),
        *_fast_over_full(everything), *_coverage(best), _after_known(best), _ends(best), *_mishaps(rows),
        _complete(rows),
    ]  # fmt: skip
    return [entry for entry in found if entry is not None]


def _fast_over_full(rows: Sequence[MissionRow]) -> list[Row]:
    """For each team size, of missions that finished in both modes."""
    full = {mission.key[:-1]: mission for mission in rows if not mission.fast}
    pairs = [(fast, full[fast.key[:-1]]) for fast in rows if fast.fast and fast.key[:-1] in full]
    return [_fast_row(size, [pair for pair in pairs if pair[0].robots == size]) for size in
            sorted({fast.robots for fast, _ in pairs})]  # fmt: skip


def _fast_row(robots: int, pairs: Sequence[tuple[MissionRow, MissionRow]]) -> Row:
    times = [(fast.time, full.time) for fast, full in pairs if fast.time and full.time]
    what, least, most = f"mean T, fast mode over full, R = {robots}", *FAST_BARS
    if not times:
        return row(what, f"{least:g} to {most:g}", math.inf, "", False, f"none of {len(pairs)} pairs finished")
    ratios = [fast / full for fast, full in times]
    value = sum(fast for fast, _ in times) / sum(full for _, full in times)
    detail = f"{min(ratios):.2f} to {max(ratios):.2f}; {len(times)} of {len(pairs)} pairs of missions finished"
    return row(what, f"{least:g} to {most:g}", value, "", least <= value <= most and len(times) == len(pairs), detail)


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values))


def _ratios(
    what: str, missions: Missions, above: tuple[int, int], below: tuple[int, int], bar: float,
    summary: Callable[[Sequence[float]], float] = _mean,
) -> Row | None:  # fmt: skip
    """`above`, `below`: robots and strategy."""
    worlds = sorted({world for world, _, _ in missions})
    asked = [((world, *above), (world, *below)) for world in worlds]
    pairs = [(missions[one], missions[other]) for one, other in asked if one in missions and other in missions]
    ratios = {one.world: one.time / other.time for one, other in pairs if one.time and other.time}
    return _summed_up(what, ratios, len(pairs), f"<= {bar:g}", bar, summary)


def _against_bound(rows: Sequence[MissionRow], bounds: Bounds, robots: int, bar: float) -> Row | None:
    asked = [mission for mission in rows if mission.robots == robots and (mission.world, robots) in bounds]
    ratios = {mission.world: mission.time / bounds[mission.world, robots] for mission in asked if mission.time}
    return _summed_up(f"mean T / bound, R = {robots}", ratios, len(asked), f"<= {bar:g}", bar, _mean)


def _summed_up(
    what: str, ratios: Mapping[str, float], asked: int, bar: str, limit: float,
    summary: Callable[[Sequence[float]], float],
) -> Row | None:  # fmt: skip
    if not asked:
        return None
    if not ratios:
        return row(what, bar, math.inf, "", False, f"none of {asked} worlds finished")
    value = summary(list(ratios.values()))
    worst = max(ratios, key=lambda world: ratios[world])
    detail = f"{min(ratios.values()):.2f} to {ratios[worst]:.2f} ({worst}); {len(ratios)} of {asked} worlds finished"
    return row(what, bar, value, "", value <= limit and len(ratios) == asked, detail)


def _coverage(rows: Sequence[MissionRow]) -> list[Row]:
    """Of every map of every mission, finished or not."""
    shares = [(share, mission) for mission in rows for share in mission.coverage]
    if not shares:
        return []
    mean, (worst, where) = _mean([share for share, _ in shares]), min(shares, key=lambda entry: entry[0])
    detail = f"{len(shares)} maps of {len(rows)} missions"
    return [
        row("coverage, mean", f">= {MEAN_COVERAGE_BAR:g}", mean, "", mean >= MEAN_COVERAGE_BAR, detail),
        row("coverage, worst", f">= {WORST_COVERAGE_BAR:g}", worst, "", worst >= WORST_COVERAGE_BAR,
            f"{where.world}, R = {where.robots}"),
    ]  # fmt: skip


def _after_known(rows: Sequence[MissionRow]) -> Row | None:
    finished = [mission for mission in rows if mission.time]
    shares = [
        100.0 * max(0.0, 1.0 - mission.known_at / mission.time)
        for mission in finished
        if mission.known_at is not None and mission.time
    ]
    if not shares:
        return None
    value = _mean(shares)
    detail = f"{min(shares):.0f} to {max(shares):.0f} %; {len(finished) - len(shares)} of {len(finished)} never knew it"
    return row("after 99 % is known, mean", f"<= {AFTER_BAR:g} % of T", value, "% of T", value <= AFTER_BAR, detail)


def _ends(rows: Sequence[MissionRow]) -> Row | None:
    spans = [m.time - m.first_end for m in rows if m.robots == MOST and m.time and m.first_end is not None]
    if not spans:
        return None
    value = float(np.median(spans))
    what = f"last robot to end after the first, R = {MOST}, median"
    return row(what, f"<= {END_BAR:g} s", value, "s", value <= END_BAR, f"{min(spans):.1f} to {max(spans):.1f} s")


def _complete(rows: Sequence[MissionRow]) -> Row | None:
    if not rows:
        return None
    others = [mission for mission in rows if mission.status != "finished"]
    told = ", ".join(f"{m.world} R{m.robots} strategy {m.strategy} {m.status}" for m in others)
    share = 1.0 - len(others) / len(rows)
    return row("missions that finished", "all", share, "of them", not others, f"of {len(rows)} {told}".rstrip())


def _mishaps(rows: Sequence[MissionRow]) -> list[Row]:
    found = []
    for what, counts in (
        ("robots that did not get home", [(m, m.not_home) for m in rows]),
        ("contacts", [(m, m.contacts) for m in rows]),
    ):
        where = ", ".join(f"{m.world} R{m.robots} strategy {m.strategy}" for m, count in counts if count)
        total = sum(count for _, count in counts)
        found.append(row(what, "0", total, "", not total, f"{len(rows)} missions {where}".rstrip()))
    return found if rows else []


def text_table(rows: Sequence[MissionRow], bounds: Bounds) -> list[str]:
    """A line for each world: T by strategy and team size, and the bound."""
    lines = []
    for world in dict.fromkeys(mission.world for mission in rows):
        told = []
        for mission in (mission for mission in rows if mission.world == world):
            time = "-" if mission.time is None else f"{mission.time:.0f}"
            bound = bounds.get((world, mission.robots))
            mode = " fast" if mission.fast else ""
            told.append(
                f"{mission.strategy}/R{mission.robots}{mode} {time}" + ("" if bound is None else f" ({bound:.0f})")
            )
        lines.append(f"{world}: {', '.join(told)}")
    return lines
