"""Output folder of a mission: maps, picture, summary.json, record.json and the final table."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from mr_grid import OccupancyGrid
from mr_launch.maps import load_raw, save_map
from mr_launch.mission import Outcome
from mr_launch.plan import TRUTH_FILE, Plan, RobotPlan
from mr_launch.reports import RobotReport
from mr_launch.summary import mission_summary, robot_summary, team_summary
from mr_launch.truth import Truth
from mr_launch.view import percent
from mr_launch.world import Measures, load_known
from mr_measures.record.robot_record import MapFigures


def write_results(
    plan: Plan, outcome: Outcome, reports: list[RobotReport], truth: Truth, cpu: dict[str, dict[str, float]]
) -> dict[str, Any]:
    """Write everything that the mission gave, however it ended, and return the summary."""
    from mr_launch.record import merges_of, mission_record  # what it needs is slow to import
    from mr_measures.record.files import write_record

    measures = Measures(plan.world, plan.options.slam, Path(plan.socket(TRUTH_FILE)))
    grids = save_maps(plan, outcome)
    robots: dict[str, dict[str, Any]] = {}
    figures: dict[str, MapFigures] = {}
    finish = last_finish(reports, outcome)
    for robot, report in zip(plan.robots, reports):
        movement = truth.tracks[robot.name].statistics(outcome.start, exploration_end(report, outcome), outcome.end)
        figures[robot.name] = measures.of(grids.get(robot.name), robot.start)
        robots[robot.name] = robot_summary(report, outcome.start, movement, figures[robot.name])
    team = team_summary(robots, truth.real_time_factor(outcome.start, finish), radio_statistics(plan))
    team["cpu"] = cpu
    summary = mission_summary(plan, robots, team, outcome.reason, outcome.notes, outcome.restarts)
    draw(plan, outcome, grids, robots, truth)
    (Path(plan.out) / "summary.json").write_text(json.dumps(summary, indent=2) + "\n")
    names = [robot.name for robot in plan.robots]
    merges = {report.robot: merges_of(report, outcome.start, names) for report in reports}
    known = load_known({name: raw_map_file(plan, name) for name in names})
    record = mission_record(plan, summary, outcome, truth, grids, figures, merges, known)
    write_record(record, Path(plan.out) / "record.json")
    return summary


def last_finish(reports: list[RobotReport], outcome: Outcome) -> float:
    """Simulation time (s) at which the last robot finished exploring; the end if one did not."""
    return max(exploration_end(report, outcome) for report in reports)


def exploration_end(report: RobotReport, outcome: Outcome) -> float:
    """Simulation time (s) at which a robot finished exploring; the end if it did not."""
    return report.start_time + report.exploration_time if report.exploration_finished else outcome.end


def raw_map_file(plan: Plan, robot: str) -> Path:
    """Where a robot's monitor puts its final map."""
    return Path(plan.socket(f"{robot}.npz"))


def save_maps(plan: Plan, outcome: Outcome) -> dict[str, OccupancyGrid]:
    grids = {}
    for robot in plan.robots:
        raw = raw_map_file(plan, robot.name)
        if not raw.exists():
            if outcome.start > 0.0:
                outcome.notes.append(f"{robot.name} gave no global map")
            continue
        grids[robot.name] = load_raw(raw)
        folder = plan.robot_folder(robot)
        folder.mkdir(parents=True, exist_ok=True)
        save_map(grids[robot.name], folder / "map")
    return grids


def radio_statistics(plan: Plan) -> dict[str, Any] | None:
    try:
        return json.loads((Path(plan.out) / "radio.json").read_text())
    except (OSError, ValueError):
        return None


def draw(
    plan: Plan, outcome: Outcome, grids: dict[str, OccupancyGrid], robots: dict[str, dict[str, Any]], truth: Truth
) -> None:
    """The most complete map with all paths."""
    if not os.access(Path.home(), os.W_OK):
        os.environ.setdefault("MPLCONFIGDIR", plan.socket("matplotlib"))  # it keeps a cache, and warns without a place
    from mr_launch.pictures import draw_mission  # matplotlib is slow to import and needed only here

    known: list[RobotPlan] = [robot for robot in plan.robots if robot.name in grids]
    if not known:
        return
    best = max(known, key=lambda robot: int((grids[robot.name].cells >= 0).sum()))
    times = [robot["time"] for robot in robots.values()]
    done = f"explored in {max(times):.0f} s" if all(time is not None for time in times) else "not finished"
    count = f"{len(plan.robots)} robot{'s' * (len(plan.robots) != 1)}"
    title = f"{Path(plan.world).stem}: {count}, {done}; global map of {best.name}"
    start = outcome.start if robots else 0.0
    draw_mission(grids[best.name], best.start, truth.tracks, title, Path(plan.out) / "team.png", start, sizes_of(plan))


def sizes_of(plan: Plan) -> dict[str, tuple[float, float]]:
    """Length and width in m of each robot whose preset was made from the world."""
    from mr_robot.platforms.preset import load_platform

    files = {robot.name: Path(plan.preset_file(robot.preset)) for robot in plan.robots if robot.preset in plan.presets}
    known = {name: load_platform(str(path)).footprint for name, path in files.items()}
    return {name: (footprint.length, footprint.width) for name, footprint in known.items()}


def print_results(plan: Plan, summary: dict[str, Any]) -> None:
    """The final table, and where the files are."""
    console = Console(soft_wrap=True, emoji=False, width=None if sys.stdout.isatty() else 120)
    table = Table(box=None, pad_edge=False, header_style="bold")
    columns = (
        "robot",
        "finished",
        "time",
        "coverage",
        "wrong walls",
        "map error",
        "distance",
        "collisions",
        "merged with",
    )
    for title in columns:
        table.add_column(title, justify="left" if title in ("robot", "merged with") else "right")
    for name, robot in summary["robots"].items():
        error = robot.get("map_error")
        table.add_row(
            name,
            "yes" if robot["finished"] else f"no ({robot['state']})",
            "-" if robot["time"] is None else f"{robot['time']:.1f} s",
            percent(robot.get("coverage")),
            percent(robot.get("wrong_walls")),
            "-" if error is None else f"{error:+.2f} %",
            f"{robot['distance']:.1f} m",
            str(robot["collisions"]),
            ", ".join(robot["merged_with"]) or "-",
        )
    console.print(table)
    team = summary["team"]
    time = "unfinished" if team["exploration_time"] is None else f"exploration time {team['exploration_time']:.1f} s"
    factor = "unknown" if team["real_time_factor"] is None else f"{team['real_time_factor']:.2f}"
    hops = ", ".join(f"{count} over {hop} hop{'s' * (hop != '1')}" for hop, count in team["packets_by_hops"].items())
    lines = [
        f"Team: {time}, real-time factor {factor}, "
        f"{team['frames_sent']} frames ({team['bytes_sent'] / 1e6:.1f} MB) sent,",
        f"packets received: {hops or 'none'}",
        *(f"Note: {note}" for note in summary["notes"]),
        f"Files in {shown(plan.out)}: {', '.join(files_of(plan))}",
    ]
    for line in lines:
        console.print(line, markup=False, highlight=False)


def files_of(plan: Plan) -> list[str]:
    """What is in the output folder, one robot standing for all."""
    out, first = Path(plan.out), plan.robots[0].name
    names = (
        "summary.json",
        "record.json",
        "team.png",
        "truth.csv",
        "logs",
        f"{first}/map.png",
        f"{first}/map.yaml",
        f"{first}/{first}.bag",
    )
    return [name for name in names if (out / name).exists()]


def shown(path: str) -> str:
    """A path as people like to read it: relative if that is shorter."""
    try:
        relative = str(Path(path).relative_to(Path.cwd()))
    except ValueError:
        return path
    return relative
