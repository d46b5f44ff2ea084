"""summary.json: what a mission came to. Built from plain values, so that it can be tested without a mission."""

from __future__ import annotations

from typing import Any, Mapping

from mr_launch.plan import Plan
from mr_launch.reports import RobotReport
from mr_measures.record.robot_record import MapFigures


def robot_summary(
    report: RobotReport, mission_start: float, movement: Mapping[str, Any], figures: MapFigures
) -> dict[str, Any]:
    """One robot's part; `figures`: of its final map. ``time`` is T_r in s from the start of the mission, None if it did
    not finish."""
    finished = report.exploration_finished
    late = report.start_time - mission_start
    return {
        "finished": finished,
        "time": round(report.exploration_time + late, 2) if finished else None,
        "state": report.state_name,
        **movement,
        "coverage": _rounded(figures.coverage, 4),
        "wrong_walls": _rounded(figures.wrong_walls, 4),
        "free_cells": figures.free_cells,
        "map_error": _rounded(figures.error, 3),
        "map_error_reason": figures.error_reason,
        "goals_reached": report.goals_reached,
        "auctions": report.auctions,
        "unreachable_frontiers": report.unreachable,
        "merged_with": sorted(report.merged),
        "merge_times": {name: round(time - mission_start, 1) for name, time in sorted(report.merge_times.items())},
        "radio": report.radio,
    }


def _rounded(value: float | None, digits: int) -> float | None:
    return None if value is None else round(value, digits)


def packets_by_hops(robots: Mapping[str, Mapping[str, Any]]) -> dict[str, int]:
    """Packets received by all robots, keyed by the number of hops they took."""
    total: dict[str, int] = {}
    for robot in robots.values():
        for index, count in enumerate(robot["radio"].get("packets_received_by_hops", [])):
            if count:
                key = str(index + 1)
                total[key] = total.get(key, 0) + count
    return total


def team_summary(
    robots: Mapping[str, Mapping[str, Any]], real_time_factor: float | None, radio: Mapping[str, Any] | None
) -> dict[str, Any]:
    """The team's part. Exploration time T = max T_r, None while one of them is missing."""
    times = [robot["time"] for robot in robots.values()]
    complete = bool(times) and all(time is not None for time in times)

    def total(name: str) -> int:
        return sum(robot["radio"].get(name, 0) for robot in robots.values())

    return {
        "finished": complete,
        "exploration_time": max(times) if complete else None,
        "real_time_factor": None if real_time_factor is None else round(real_time_factor, 3),
        "frames_sent": total("frames_sent"),
        "bytes_sent": total("bytes_sent"),
        "packets_sent": total("packets_sent"),
        "packets_failed": total("packets_failed"),
        "packets_by_hops": packets_by_hops(robots),
        "merges": sum(len(robot["merged_with"]) for robot in robots.values()),
        "collisions": sum(robot.get("collisions", 0) for robot in robots.values()),
        "radio": radio,
    }


def mission_summary(
    plan: Plan,
    robots: dict[str, dict[str, Any]],
    team: dict[str, Any],
    reason: str,
    notes: list[str],
    restarts: Mapping[str, Mapping[str, int]],
) -> dict[str, Any]:
    """Everything, with the options that make the mission repeatable."""
    return {
        "world": plan.world,
        "isolation": plan.isolation,
        "options": plan.options.to_dict(),
        "finished": team["finished"] and not reason,
        "reason": reason,
        "notes": notes,
        "restarts": {name: dict(counts) for name, counts in restarts.items() if counts},
        "team": team,
        "robots": robots,
    }


def cpu_shares(
    before: Mapping[int, tuple[str, float, int]],
    after: Mapping[int, tuple[str, float, int]],
    launches: Mapping[str, int],
    seconds: float,
) -> dict[str, dict[str, float]]:
    """Share of one core by robot and process between two readings of processes.cpu_seconds.

    ``launches`` maps a robot to the process id of its roslaunch; what is below none of them counts as ``team``.
    """
    owners = {pid: name for name, pid in launches.items()}
    shares: dict[str, dict[str, float]] = {}
    for pid, (command, used, _) in after.items():
        share = (used - before.get(pid, ("", 0.0, 0))[1]) / seconds if seconds > 0 else 0.0
        if share < 0.0005:
            continue
        owner = _owner(pid, after, owners)
        name = process_name(command)
        shares.setdefault(owner, {})
        shares[owner][name] = round(shares[owner].get(name, 0.0) + share, 4)
    return {owner: dict(sorted(values.items(), key=lambda item: -item[1])) for owner, values in sorted(shares.items())}


def _owner(pid: int, table: Mapping[int, tuple[str, float, int]], owners: Mapping[int, str]) -> str:
    while pid in table:
        if pid in owners:
            return owners[pid]
        pid = table[pid][2]
    return "team"


def process_name(command: str) -> str:
    """ROS node name if the command line has one, otherwise the program's."""
    words = command.split()
    for word in words:
        if word.startswith("__name:="):
            return word[len("__name:=") :]
    scripts = [word for word in words[1:2] if words and "python" in words[0]] or words[:1]
    if scripts == ["-m"]:
        scripts = words[2:3]
    return scripts[0].rsplit("/", 1)[-1] if scripts else "?"
