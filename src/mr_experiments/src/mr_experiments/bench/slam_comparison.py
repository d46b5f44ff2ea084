"""SLAM beside its peers on the same logs: the table, and whether ours is the best."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mr_experiments.bench.rows import Row
from mr_sim.slam_evaluation import Evaluation

OURS = "ours"


@dataclass(frozen=True)
class Measure:
    """A figure of an engine in one setting, over so many logs. `counts`: whether the best engine has to be ours; time
    per scan does not, for it has a bar of its own."""

    name: str
    unit: str
    value: float
    counts: bool = True
    logs: int = 1


Setting = tuple[str, str]  # kind of log, odometry
Engines = Mapping[str, Sequence[Measure]]  # engine -> its figures, the same ones in the same order


def measures_of(results: Sequence[Evaluation]) -> list[Measure]:
    """Of one engine on the logs of one kind."""
    walls = [100.0 * each.wrong_walls for each in results]
    spent, logs = [each.milliseconds for each in results], len(results)
    return [
        Measure("wrong walls, mean", "%", float(np.mean(walls)), logs=logs),
        Measure("wrong walls, worst", "%", max(walls), logs=logs),
        Measure("position error, q95", "m", float(np.mean([each.q95_error for each in results])), logs=logs),
        Measure("time per scan, mean", "ms", float(np.mean([mean for mean, _ in spent])), False, logs),
        Measure("time per scan, worst", "ms", max(worst for _, worst in spent), False, logs),
    ]


def comparison_rows(settings: Mapping[Setting, Engines]) -> list[Row]:
    """Whether ours is as good as the best peer, for each setting and measure; one that does not count has no bar."""
    return [
        _row(setting, measure, {name: figures[index] for name, figures in engines.items() if name != OURS})
        for setting, engines in settings.items()
        for index, measure in enumerate(engines[OURS])
    ]


def _row(setting: Setting, ours: Measure, peers: Mapping[str, Measure]) -> Row:
    best = min(peers, key=lambda name: peers[name].value)
    good = math.isfinite(ours.value) and ours.value <= peers[best].value
    told = ", ".join(f"{name} {peer.value:.3g}" for name, peer in peers.items())
    return {
        "what": f"{ours.name}, {setting[0]}, odometry with {setting[1]}, beside MRPT",
        "bar": f"<= {peers[best].value:.3g} ({best})" if ours.counts else "-",
        "value": ours.value,
        "unit": ours.unit,
        "holds": good or not ours.counts,
        "detail": f"{told}; {ours.logs} log{'s' * (ours.logs != 1)}",
    }


def table(settings: Mapping[Setting, Engines]) -> str:
    """One line for each setting and engine; the measures of the first setting head the columns."""
    first = next(iter(next(iter(settings.values())).values()))
    lines: list[list[str]] = [["logs", "odometry", "engine", *(f"{m.name} [{m.unit}]" for m in first)]]
    for (kind, odometry), engines in settings.items():
        lines += [[kind, odometry, name, *(f"{m.value:.3g}" for m in figures)] for name, figures in engines.items()]
    widths = [max(len(line[column]) for line in lines) for column in range(len(lines[0]))]
    return "\n".join("  ".join(text.ljust(width) for text, width in zip(line, widths)).rstrip() for line in lines)
