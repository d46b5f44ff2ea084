"""Output folder of a mission: its record, maps, picture and the final table."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Mapping, Sequence

from rich.console import Console
from rich.table import Table

from mr_grid import OccupancyGrid
from mr_launch.maps import load_raw, save_map
from mr_launch.mission import Outcome
from mr_launch.plan import TRUTH_FILE, Plan, RobotPlan
from mr_launch.truth import Truth
from mr_launch.view import percent
from mr_launch.world import Measures, load_known, own_map_file, project_worlds
from mr_measures.record.files import STACK_RECORD

if TYPE_CHECKING:
    from mr_launch.reports import ReportServer, RobotReport
    from mr_measures.record.mission_record import MissionRecord


def write_results(
    plan: Plan,
    outcome: Outcome,
    server: ReportServer,
    truth: Truth,
    begun: float,
    cpu: Mapping[str, Mapping[str, float]],
) -> MissionRecord:
    """Write everything that the mission gave, however it ended, and return its record. `begun`: s since the epoch."""
    from mr_launch.record import Course, Ran, Seen, mission_record  # what it needs is slow to import
    from mr_measures.record.files import write_record
    from mr_measures.record.versions import versions

    measures = Measures(plan.world, plan.options.slam, Path(plan.socket(TRUTH_FILE)))
    grids = save_maps(plan, outcome)
    files = {robot.name: raw_map_file(plan, robot.name) for robot in plan.robots}
    known = load_known(files)
    courses = [
        Course(
            robot, server.reports[robot.name], server.logs[robot.name], truth.tracks[robot.name],
            measures.of(grids.get(robot.name), robot.start), grids.get(robot.name),
            _loaded(own_map_file(files[robot.name])), known.get(robot.name),
        )
        for robot in plan.robots
    ]  # fmt: skip
    factor = truth.real_time_factor(outcome.start, last_finish(list(server.reports.values()), outcome))
    made = versions("mr_launch", project_worlds())
    base = None if plan.base is None else server.logs[plan.base.name]
    seen, ran = Seen(courses, base, measures.reference), Ran(begun, cpu, factor)
    record = mission_record(plan, outcome, seen, ran, made)
    write_record(record, Path(plan.out) / STACK_RECORD)
    draw(plan, outcome, grids, record, truth)
    return record


def last_finish(reports: Sequence[RobotReport], outcome: Outcome) -> float:
    """Simulation time (s) at which the last robot finished exploring; the end if one did not."""
    return max(exploration_end(report, outcome) for report in reports)


def exploration_end(report: RobotReport, outcome: Outcome) -> float:
    """Simulation time (s) at which a robot finished exploring; the end if it did not."""
    return report.start_time + report.exploration_time if report.exploration_finished else outcome.end


def raw_map_file(plan: Plan, robot: str) -> Path:
    """Where a robot's monitor puts its final map."""
    return Path(plan.socket(f"{robot}.npz"))


def _loaded(path: Path) -> OccupancyGrid | None:
    return load_raw(path) if path.exists() else None


def save_maps(plan: Plan, outcome: Outcome) -> dict[str, OccupancyGrid]:
    grids = {}
    for robot in plan.robots:
        grid = _loaded(raw_map_file(plan, robot.name))
        if grid is None:
            if outcome.start > 0.0:
                outcome.notes.append(f"{robot.name} gave no global map")
            continue
        grids[robot.name] = grid
        folder = plan.robot_folder(robot)
        folder.mkdir(parents=True, exist_ok=True)
        save_map(grid, folder / "map")
    return grids


def draw(plan: Plan, outcome: Outcome, grids: Mapping[str, OccupancyGrid], record: MissionRecord, truth: Truth) -> None:
    """The most complete map with all paths."""
    if not os.access(Path.home(), os.W_OK):
        os.environ.setdefault("MPLCONFIGDIR", plan.socket("matplotlib"))  # it keeps a cache, and warns without a place
    from mr_launch.pictures import draw_mission  # matplotlib is slow to import and needed only here

    known: list[RobotPlan] = [robot for robot in plan.robots if robot.name in grids]
    if not known:
        return
    best = max(known, key=lambda robot: int((grids[robot.name].cells >= 0).sum()))
    time = record.team.exploration_time
    done = "not finished" if time is None else f"explored in {time:.0f} s"
    count = f"{len(plan.robots)} robot{'s' * (len(plan.robots) != 1)}"
    title = f"{Path(plan.world).stem}: {count}, {done}; global map of {best.name}"
    path = Path(plan.out) / "team.png"
    draw_mission(grids[best.name], best.start, truth.tracks, title, path, sizes_of(plan), outcome.start)


def sizes_of(plan: Plan) -> dict[str, tuple[float, float]]:
    """Length and width in m of each robot: of the preset made from the world, or of the usual one."""
    from mr_robot.platforms.engines import USUAL
    from mr_robot.platforms.preset import load_platform

    files = {
        robot.name: str(plan.preset_file(robot.preset)) if robot.preset in plan.presets else USUAL
        for robot in plan.robots
    }
    known = {name: load_platform(preset).footprint for name, preset in files.items()}
    return {name: (footprint.length, footprint.width) for name, footprint in known.items()}


COLUMNS = (
    "robot", "finished", "time", "coverage", "wrong walls", "map error", "distance", "collisions", "merged with",
)  # fmt: skip


def print_results(plan: Plan, record: MissionRecord) -> None:
    """The final table, and where the files are."""
    console = Console(soft_wrap=True, emoji=False, width=None if sys.stdout.isatty() else 120)
    table = Table(box=None, pad_edge=False, header_style="bold")
    for title in COLUMNS:
        table.add_column(title, justify="left" if title in ("robot", "merged with") else "right")
    for name, robot in record.robots.items():
        table.add_row(
            name,
            f"no ({robot.state})" if robot.finished_at is None else "yes",
            "-" if robot.finished_at is None else f"{robot.finished_at:.1f} s",
            percent(robot.map.coverage),
            percent(robot.map.wrong_walls),
            "-" if robot.map.error is None else f"{round(robot.map.error, 2) + 0.0:+.2f} %",
            f"{robot.distance:.1f} m",
            str(robot.collisions.total),
            ", ".join(robot.partners) or "-",
        )
    console.print(table)
    for line in [*_team_lines(record), f"Files in {shown(plan.out)}: {', '.join(files_of(plan))}"]:
        console.print(line, markup=False, highlight=False)


def _team_lines(record: MissionRecord) -> list[str]:
    time, factor = record.team.exploration_time, record.measured.real_time_factor
    told = "unfinished" if time is None else f"exploration time {time:.1f} s"
    frames, octets = (
        sum(robot.sent(name) for robot in record.robots.values()) for name in ("frames_sent", "bytes_sent")
    )
    hops = ", ".join(f"{count} over {hop} hop{'s' * (hop != 1)}" for hop, count in record.packets_by_hops.items())
    return [
        f"Team: {told}, real-time factor {'unknown' if factor is None else f'{factor:.2f}'}, "
        f"{frames} frames ({octets / 1e6:.1f} MB) sent,",
        f"packets received: {hops or 'none'}",
        *(f"Note: {note.text}" for note in record.notes if not note.robot),
    ]


def files_of(plan: Plan) -> list[str]:
    """What is in the output folder, one robot standing for all."""
    out, first = Path(plan.out), plan.robots[0].name
    names = (
        STACK_RECORD,
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
