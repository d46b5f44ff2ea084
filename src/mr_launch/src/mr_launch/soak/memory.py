"""Memory and processor time of the nodes of a mission over time."""

from __future__ import annotations

import os
import time
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple, Sequence

import numpy as np

from mr_launch.soak.running import Node, RunningMission

TICKS = os.sysconf("SC_CLK_TCK")


class Sample(NamedTuple):
    """`time`: s; `pss`: octets, its own and its share of what it shares; `own`: those of it that are no files, which
    stay the same when others that use the same libraries come and go; `cpu`: s so far."""

    time: float
    pss: int
    own: int
    cpu: float


class Samples:
    """By node; a node that was started again is another one."""

    def __init__(self) -> None:
        self.by_node: dict[Node, list[Sample]] = defaultdict(list)

    def take(self, mission: RunningMission) -> None:
        now = time.monotonic()
        for node in mission.nodes():
            try:
                self.by_node[node].append(Sample(now, *memory_of(node.pid), cpu_of(node.pid)))
            except (OSError, ValueError, IndexError):
                continue  # it has just ended

    def between(self, start: float, end: float) -> dict[Node, list[Sample]]:
        """Nodes that lived the whole time, with at least five samples in it."""
        found = {}
        for node, samples in self.by_node.items():
            inside = [sample for sample in samples if start <= sample.time <= end]
            if len(inside) >= 5 and inside[0].time - start < 15.0 and end - inside[-1].time < 15.0:
                found[node] = inside
        return found


def memory_of(pid: int) -> tuple[int, int]:
    """`pss` and `own` of a `Sample`. Raises OSError, and ValueError for a process that is just ending."""
    lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    sizes = {line.split(":")[0]: int(line.split()[1]) * 1024 for line in lines if line.startswith("Pss")}
    if "Pss" not in sizes:
        raise ValueError(f"no memory of {pid}")
    return sizes["Pss"], sizes["Pss_Anon"]


def cpu_of(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def slope(samples: Sequence[Sample]) -> tuple[float, float]:
    """MB of its own per minute by least squares, and its standard error."""
    times = np.array([sample.time for sample in samples]) / 60.0
    sizes = np.array([sample.own for sample in samples]) / 1e6
    centred = times - times.mean()
    spread = float(centred @ centred)
    found = float(centred @ sizes) / spread
    rest = sizes - sizes.mean() - found * centred
    return found, float(np.sqrt(rest @ rest / max(1, len(times) - 2) / spread))


def cpu_share(samples: Sequence[Sample]) -> float:
    """Of one core."""
    return (samples[-1].cpu - samples[0].cpu) / (samples[-1].time - samples[0].time)
