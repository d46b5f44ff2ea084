"""The command ``team``: checks everything, then starts."""

from __future__ import annotations

import math
import os
import socket
import sys
from dataclasses import replace
from pathlib import Path
from typing import Sequence

from mr_grid import Pose
from mr_launch import isolation
from mr_launch.arguments import Options, choose_robots, parse_arguments
from mr_launch.begun import write_begun
from mr_launch.errors import UserError
from mr_launch.exit_codes import BAD_CALL, INTERRUPTED
from mr_launch.outside import run_team
from mr_launch.plan import BASE, FIRST_PORT, PLAN_FILE, Plan, RobotPlan
from mr_launch.programs import find_programs, free_ports
from mr_launch.world import check_start, find_world, is_map, keep_generated, presets_of, robots_of, warning_of


def team(arguments: Sequence[str]) -> int:
    """``rosrun mr_launch team``; returns the exit code."""
    try:
        plan = make_plan(parse_arguments(arguments))
        page = page_listener(plan.options.page)
        make_output_folder(plan)
        plan = replace(plan, world=keep_generated(plan.world, Path(plan.out) / "world"))
        note_begin(plan)
        keep_plan(plan)
    except UserError as error:
        print(f"team: {error}", file=sys.stderr)
        return BAD_CALL
    except KeyboardInterrupt:
        print("team: interrupted, nothing was started", file=sys.stderr)
        return INTERRUPTED
    if page is not None:
        print(f"team: status page at http://localhost:{plan.options.page}", file=sys.stderr)
    return run_team(plan, page)


def page_listener(port: int) -> socket.socket | None:
    """For viewers on this computer; None without a port. Raises UserError if others have the port."""
    if not port:
        return None
    from mr_page.server import listening_sockets  # slow to import

    try:
        return listening_sockets(port, "127.0.0.1")[0]
    except OSError as error:
        raise UserError(f"{error} with --page") from None


def make_plan(options: Options) -> Plan:
    """Everything checked that can be checked before anything starts. Raises UserError."""
    world = find_world(options.world, options.starts)
    poses = robots_of(world)
    asked = options.robots or len(options.starts) // 3 or None
    if without_starts(options) and (asked or 1) > 1:
        raise UserError(f"--robots {asked}: a map says no starts; give --starts X Y DEGREES for each robot")
    names = choose_robots(asked, [name for name, _ in poses], world)
    if options.topology == "centralized" and BASE in names:
        raise UserError(f"{world} has a robot named {BASE}, which is the name of the base station")
    check_start(world, len(names))
    warning = warning_of(options.world, world)
    if warning:
        print(f"team: warning: {warning}", file=sys.stderr)
    notice = start_notice(options, poses[0][1])
    if notice:
        print(f"team: {notice}", file=sys.stderr)
    programs = find_programs(options.slam, options.navigation)
    kind, reason = isolation.choose(options.isolation, os.geteuid())
    if kind == isolation.HUB:
        if options.isolation == "namespaces":
            raise UserError(f"network namespaces are not allowed here: {reason}")
        print(f"team: no network namespaces ({reason}): one port per master, radio over Unix sockets", file=sys.stderr)
    hosts = [*names, *([BASE] if options.topology == "centralized" else [])]
    ports = free_ports(len(hosts)) if kind == isolation.HUB else [FIRST_PORT] * len(hosts)
    starts = {BASE: dict(poses)[names[0]], **dict(poses)}
    kinds, presets = presets_of(world, names)
    robots = [
        RobotPlan(name, index, ports[index], starts[name], kinds.get(name, kinds[names[0]]))
        for index, name in enumerate(hosts)
    ]
    base = robots.pop() if options.topology == "centralized" else None
    return Plan(options, world, robots, str(Path(options.out).absolute()), kind, programs, base=base, presets=presets)


def without_starts(options: Options) -> bool:
    """Whether the world is a map, and nobody says where robots stand in it."""
    return is_map(options.world) and not options.starts


def start_notice(options: Options, start: Pose) -> str:
    """What people should know of a start pose that nobody gave."""
    if not without_starts(options):
        return ""
    place = f"where there is most room, at {start[0]:.2f} {start[1]:.2f} {math.degrees(start[2]):.0f}"
    return f"{options.world}: one robot {place}; give --starts X Y DEGREES for each robot to have others"


def make_output_folder(plan: Plan) -> None:
    """The output folder, empty, and ``latest`` beside it when it stands in ``out``."""
    out = Path(plan.out)
    try:
        if out.exists() and (not out.is_dir() or any(out.iterdir())):
            raise UserError(f"--out {out} exists and is not an empty folder")
        for robot in plan.robots:
            plan.robot_folder(robot).mkdir(parents=True)
        for host in plan.hosts:
            plan.log_folder(host).mkdir(parents=True)
        for name, text in plan.presets.items():
            path = Path(plan.preset_file(name))
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
        if not plan.options.out.startswith("out/"):
            return
        latest = out.parent / "latest"
        if latest.is_symlink():
            latest.unlink()
        if not latest.exists():
            latest.symlink_to(out.name)
    except OSError as error:
        raise UserError(f"cannot write to the output folder {out}: {error.strerror}") from None


def note_begin(plan: Plan) -> None:
    """Writes the record of a mission that begins. Raises UserError."""
    try:
        write_begun(plan)
    except OSError as error:
        raise UserError(f"cannot write to the output folder {plan.out}: {error.strerror}") from None


def keep_plan(plan: Plan) -> None:
    """So that a mission can be exported and played back, however it ended."""
    path = Path(plan.out) / PLAN_FILE
    try:
        path.write_text(plan.to_json() + "\n", encoding="utf-8")
    except OSError as error:
        raise UserError(f"cannot write {path}: {error.strerror}") from None
