"""What a soak came to, as rows like those of the other benchmarks: what, bar, value, unit, holds, detail."""

from __future__ import annotations

import math
from collections import Counter
from typing import Any, Mapping, Sequence

from mr_launch.soak.memory import Sample, Samples, cpu_share, slope
from mr_launch.soak.missions import ROBOTS, Outcome

Row = dict[str, Any]
OWN_NODES = ("adhoc_communication", "map_merger", "explorer", "move_base")  # a robot's, without simulator and SLAM
OF_A_ROBOT = (*OWN_NODES, "slam", "roslaunch", "master", "rosout")  # robot.launch, all it starts, what they need
ALL_NODES = (*OF_A_ROBOT, "robot", "bag", "monitor", "page")  # of a robot of a team with a status page
CPU_BAR, PSS_BAR_MB = 0.20, 350.0
SLOPE_BAR = 0.2  # MB per minute of any node, less twice the standard error
# After a mission caches fill, allocators reach their high-water mark and the last registrations end: some MB in the
# first minutes, without a leak. A late step of 1 MB is a slope of 0.15 MB per minute in ten minutes, of 1.5 in one.
SETTLE_S, WATCHED_S = 300.0, 600.0  # of the hold: before memory is looked at, and for which it is at least
LEAST_HOLD_S = SETTLE_S + WATCHED_S


def row(what: str, bar: str, value: Any, unit: str, holds: bool, detail: str) -> Row:
    """Prints and returns a row."""
    print(f"{'ok  ' if holds else 'MISS'} {what}: {value} {unit} (bar {bar}) {detail}", flush=True)
    return {"what": what, "bar": bar, "value": value, "unit": unit, "holds": holds, "detail": detail}


def rows_of(outcomes: Sequence[Outcome], long: bool = True) -> list[Row]:
    """`long`: False where the robots stood too short a time for a verdict on memory, and were meant to."""
    memory = _memory(outcomes, long)
    return [*_survival(outcomes), *_faults(outcomes), *_disk(outcomes), *memory, *_resources(outcomes)]


def _survival(outcomes: Sequence[Outcome]) -> list[Row]:
    total = len(outcomes)
    good = sum(outcome.survived for outcome in outcomes)
    stuck = [f"{outcome.name}: {name}" for outcome in outcomes for name in outcome.stuck]
    left = [f"{outcome.name}: {entry}" for outcome in outcomes for entry in outcome.left]
    codes = [f"{outcome.name}: exit code {outcome.code}" for outcome in outcomes if outcome.code]
    return [
        row("soak: missions survived", f"{total} of {total}", good, "missions", good == total, "; ".join(codes)),
        row("soak: robots stuck", "0", len(stuck), "robots", not stuck, "; ".join(stuck)),
        row("soak: processes, namespaces, mounts left", "0", len(left), "", not left, "; ".join(left)),
    ]


def _faults(outcomes: Sequence[Outcome]) -> list[Row]:
    """Each kind: in how many missions it happened, and how many of those were survived."""
    rows = []
    for kind in dict.fromkeys(fault.kind for outcome in outcomes for fault in outcome.faults):
        hit = [outcome for outcome in outcomes if any(fault.kind == kind for fault in outcome.faults)]
        good = sum(outcome.survived for outcome in hit)
        events = sum(fault.kind == kind and fault.hurts for outcome in hit for fault in outcome.faults)
        bar = f"{len(hit)} of {len(hit)}"
        rows.append(row(f"survived: {kind}", bar, good, "missions", good == len(hit), f"{events} events"))
    omitted = [f"{outcome.name}: {fault.what}" for outcome in outcomes for fault in outcome.omitted]
    rows.append(row("faults that could not be done", "0", len(omitted), "events", not omitted, "; ".join(omitted)))
    restarts: Counter[str] = Counter()
    for outcome in outcomes:
        for counts in outcome.restarts.values():
            restarts.update(counts)
    came = ", ".join(f"{name} {count}" for name, count in sorted(restarts.items()))
    rows.append(row("started again", "-", sum(restarts.values()), "nodes", True, came))
    return rows


def _disk(outcomes: Sequence[Outcome]) -> list[Row]:
    """Each robot's recording ends with one line, and nothing else is said of the disk."""
    hit = [outcome for outcome in outcomes if any(fault.kind == "full disk" for fault in outcome.faults)]
    if not hit:
        return []
    others = []
    for outcome in hit:
        lines = [line for line in outcome.said if "MB are free" in line or "o space left" in line]
        told = [sum(line.startswith(f"team: {name}: ") for line in lines) for name in ROBOTS]
        if told != [1] * len(ROBOTS) or len(lines) != len(ROBOTS):
            others.append(f"{outcome.name}: {'; '.join(lines) or 'nothing'}")
    bar, good = f"{len(hit)} of {len(hit)}", len(hit) - len(others)
    return [row("full disk: one line of each robot", bar, good, "missions", not others, " | ".join(others))]


def _memory(outcomes: Sequence[Outcome], long: bool) -> list[Row]:
    """By node the robot with the steepest slope, less twice its standard error."""
    rows = []
    for outcome in outcomes:
        start, end = outcome.hold
        if end <= start:
            continue
        settled = start + SETTLE_S if long else start
        if long and end - settled < WATCHED_S:
            what, detail = "memory at rest: time to look at it", "the mission ended before"
            rows.append(row(what, f">= {WATCHED_S / 60.0:g}", round((end - settled) / 60.0, 1), "min", False, detail))
            continue
        seen = outcome.samples.between(settled, end)
        for name in sorted({*ALL_NODES, *(node.name for node in seen)}):
            slopes = {node.robot: slope(samples) for node, samples in seen.items() if node.name == name}
            rows.append(_slope_row(name, slopes, (end - settled) / 60.0, long))
    return rows


def _slope_row(name: str, slopes: Mapping[str, tuple[float, float]], minutes: float, long: bool) -> Row:
    """`slopes`: of each robot's node, with the standard error, MB/min."""
    bar = f"<= {SLOPE_BAR:g}" if long else "no verdict"
    missing = [robot for robot in ROBOTS if robot not in slopes]
    if missing:
        what = f"memory at rest: slope of {name}"
        return row(what, bar, None, "MB/min", False, f"not seen the whole time: {', '.join(missing)}")
    rate, error = max(slopes.values(), key=_at_least)
    detail = f"+- {2.0 * error:.3f}, {minutes:.1f} min at rest"
    if not long:
        detail += f"; a verdict needs {LEAST_HOLD_S / 60.0:g}"
    holds = not long or _at_least((rate, error)) <= SLOPE_BAR
    return row(f"memory at rest: slope of {name}, worst robot", bar, round(rate, 3), "MB/min", holds, detail)


def _at_least(slope: tuple[float, float]) -> float:
    rate, error = slope
    return rate - 2.0 * error


def alone_rows(outcome: Outcome) -> list[Row]:
    """What one robot needs that nobody shares pages with: the most at a time during its mission."""
    what, bar = "a robot alone: memory (PSS), most at a time", f"<= {PSS_BAR_MB:g}"
    moments = _moments(outcome.samples, OF_A_ROBOT)
    if not moments:
        return [row(what, bar, None, "MB", False, f"never seen together: {', '.join(OF_A_ROBOT)}")]
    most = max(moments, key=lambda moment: sum(sample.pss for sample in moment.values()))
    total, own = (sum(sizes) / 1e6 for sizes in zip(*((sample.pss, sample.own) for sample in most.values())))
    shown = ", ".join(f"{name} {sample.pss / 1e6:.0f}" for name, sample in most.items())
    end = "finished" if outcome.survived else "did not finish"
    detail = f"{shown}; {own:.0f} of it are no files; {len(moments)} moments of a mission that {end}"
    return [row(what, bar, round(total, 1), "MB", outcome.survived and total <= PSS_BAR_MB, detail)]


def _moments(samples: Samples, names: Sequence[str]) -> list[dict[str, Sample]]:
    """These nodes whenever all of them were looked at in one go."""
    by_time: dict[float, dict[str, Sample]] = {}
    for node, taken in samples.by_node.items():
        for sample in taken:
            by_time.setdefault(sample.time, {})[node.name] = sample
    return [{name: found[name] for name in names} for found in by_time.values() if set(names) <= set(found)]


def _resources(outcomes: Sequence[Outcome]) -> list[Row]:
    """One robot's own nodes while an undisturbed team explores."""
    rows = []
    for outcome in outcomes:
        if outcome.hold[1] <= outcome.hold[0]:
            continue
        found = outcome.samples.between(*outcome.exploring)
        cpu, pss = [], []
        for robot in ROBOTS:
            own = [samples for node, samples in found.items() if node.robot == robot and node.name in OWN_NODES]
            seen = len({node.name for node in found if node.robot == robot and node.name in OWN_NODES})
            whole = seen == len(OWN_NODES)
            cpu.append(sum(cpu_share(samples) for samples in own) if whole else math.inf)
            moments = [sum(sample.pss for sample in moment) / 1e6 for moment in zip(*own)] if whole else []
            pss.append(max(moments, default=math.inf))
        nodes = f"{', '.join(OWN_NODES)}; by robot"
        what, shown = "own nodes of a robot, R = 3", ", ".join(f"{share:.3f}" for share in cpu)
        rows.append(row(f"{what}: CPU, worst robot", f"<= {CPU_BAR:.0%}", round(max(cpu), 3), "of a core",
                        max(cpu) <= CPU_BAR, f"{nodes} {shown}"))  # fmt: skip
        shown = ", ".join(f"{size:.0f}" for size in pss)
        rows.append(row(f"{what}: memory (PSS), worst robot", f"<= {PSS_BAR_MB:g}", round(max(pss), 1), "MB",
                        max(pss) <= PSS_BAR_MB, f"{nodes} {shown}"))  # fmt: skip
    return rows
