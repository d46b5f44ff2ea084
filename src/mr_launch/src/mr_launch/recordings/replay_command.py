"""``rosrun mr_launch replay``: options, what is cut out of the bags, and what remains afterwards."""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import shutil
import sys
import time
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, Iterator, Sequence

from mr_launch import isolation
from mr_launch.arguments import STRATEGY, check_folder, strategy_number
from mr_launch.errors import UserError
from mr_launch.exit_codes import BAD_CALL, FAILED, INTERRUPTED
from mr_launch.outside import run_inside
from mr_launch.plan import BASE, FIRST_PORT, PLAN_FILE, Plan, initial_poses
from mr_launch.programs import find_played, free_ports
from mr_launch.recordings.bags import SECOND, Span, opened, pause_between_clocks
from mr_launch.recordings.cut import cut, is_played
from mr_launch.recordings.drivers import driver_arguments, frame_arguments, scan_note
from mr_launch.recordings.recording import (
    WHAT_IS_FOUND,
    RecordedRobot,
    Recording,
    find_recording,
    with_bodies,
    with_messages,
)
from mr_launch.recordings.replay_plan import SAVE, PlayedRobot, ReplayPlan
from mr_launch.recordings.runs import run_of_merger
from mr_launch.recordings.survey import Survey, clock_shifts

COMPUTED = ("map_merger", "explorer")
FASTEST = 20.0


def make_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="replay",
        description="Plays a recorded mission back: every robot on a master of its own, with its time and frames. With "
        "--compute nodes run again on what was recorded, without robots.",
        epilog="Exit code: 0 played to the end, 1 a node failed, 2 bad options or bags, 130 interrupted.",
    )
    add = parser.add_argument
    add("mission", metavar="MISSION", type=Path, help=WHAT_IS_FOUND)
    add("--compute", nargs="+", choices=COMPUTED, default=[], metavar="NODE", help="map_merger, explorer: run "
        "them again; what they published then is not played")  # fmt: skip
    add("--rate", type=float, default=1.0, metavar="F", help="recorded over real seconds, with --compute the most: "
        "time waits for the nodes (default: %(default)s)")  # fmt: skip
    add("--from", dest="first", type=float, default=0.0, metavar="S", help="s of the recording at which to begin")
    add("--to", dest="last", type=float, default=math.inf, metavar="S", help="s of the recording at which to end")
    add("--strategy", metavar="N|NAME", help=f"of the explorer (default: that of the mission, else {STRATEGY})")
    add("--robot", default="", metavar="PRESET", help="what real robots are, as of robot.launch (default: pioneer)")
    add("--out", type=Path, metavar="DIR", help="folder for logs and for what is computed (default: out/replay_<time>)")
    add("--isolation", choices=("auto", "namespaces", "hub"), default="auto", help="as of the team runner")
    return parser


def main(arguments: Sequence[str]) -> int:
    options = make_parser().parse_args(arguments)
    out = options.out or Path("out") / time.strftime("replay_%Y-%m-%d_%H-%M-%S")
    try:
        check(options)
        check_folder(os.path.abspath(out))
        recording = find_recording(options.mission)
        programs = find_played(options.compute)
        with _output_folder(out):
            return _play(make_plan(recording, options, out.absolute(), programs), out)
    except UserError as error:
        print(f"replay: {error}", file=sys.stderr)
        return BAD_CALL
    except OSError as error:
        print(f"replay: cannot write to {error.filename or out}: {error.strerror}", file=sys.stderr)
        return BAD_CALL
    except KeyboardInterrupt:
        print("replay: interrupted, nothing was started", file=sys.stderr)
        return INTERRUPTED


def _play(plan: ReplayPlan, out: Path) -> int:
    names = ", ".join(robot.name for robot in plan.robots)
    print(f"replay: {names}, {plan.seconds:.0f} s; nodes come up", file=sys.stderr)
    code = run_inside(
        "mr_launch.recordings.inside", plan.isolation, lambda private: replace(plan, private=private).to_json()
    )
    if plan.compute and code != FAILED:
        print(f"replay: what {' and '.join(plan.compute)} made of it is in {out}")
    return code


def check(options: argparse.Namespace) -> None:
    if not (math.isfinite(options.rate) and 0.01 <= options.rate <= FASTEST):
        raise UserError(f"--rate {options.rate:g} is out of range: 0.01 to {FASTEST:g}")
    if not 0.0 <= options.first < math.inf:
        raise UserError(f"--from {options.first:g} is no time of a recording, which begins at 0")
    if not options.first < options.last:
        raise UserError(f"--from {options.first:g} --to {options.last:g}: nothing lies between")
    if options.strategy is not None:
        options.strategy = strategy_number(options.strategy)
    if options.robot:
        check_robot(options.robot)


def check_robot(preset: str) -> None:
    from mr_robot.platforms.platform import PlatformError
    from mr_robot.platforms.preset import load_platform

    try:
        load_platform(preset)
    except PlatformError as error:
        raise UserError(f"--robot {error}") from None


def make_plan(recording: Recording, options: argparse.Namespace, out: Path, programs: dict[str, str]) -> ReplayPlan:
    """Cuts the bags, too. Raises UserError and OSError."""
    recording = with_bodies(with_messages(recording))
    for note in recording.notes:
        print(f"replay: {note}", file=sys.stderr)
    kind, _ = isolation.choose(options.isolation, os.geteuid())
    if kind == isolation.HUB and options.isolation == "namespaces":
        raise UserError("network namespaces are not allowed here; --isolation hub does without")
    names = [robot.name for robot in recording.robots]
    ports = free_ports(len(names)) if kind == isolation.HUB else [FIRST_PORT] * len(names)
    spans = played_spans(recording, options.first, options.last)
    seconds = (spans[names[0]].end - spans[names[0]].start) / SECOND
    copy = replace(recording.plan, out=str(out)) if recording.plan else None
    robots = []
    for robot, port in zip(recording.robots, ports):
        bag = cuts_folder(out) / f"{robot.name}.bag"
        with opened(robot.bags) as reader:
            cut(reader, bag, spans[robot.name], is_played(options.compute))
            arguments = computing_arguments(copy, robot.name, options, reader) if options.compute else {}
            if SAVE in options.compute:
                arguments["run"] = run_of_merger(reader, spans[robot.name])
        robots.append(PlayedRobot(robot.name, port, str(bag), spans[robot.name].end / SECOND, arguments))
    if options.compute:
        _prepare_results(recording, copy, out)
    return ReplayPlan(robots, str(out), kind, programs, seconds, options.rate, list(options.compute))


def _prepare_results(recording: Recording, copy: Plan | None, out: Path) -> None:
    """What is computed can be exported and played back like the mission itself. `copy`: its plan, moved to `out`."""
    for robot in recording.robots:
        (out / robot.name).mkdir()
    if copy:
        (out / PLAN_FILE).write_text(copy.to_json() + "\n", encoding="utf-8")
        for name, text in copy.presets.items():
            path = Path(copy.preset_file(name))
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")


def played_spans(recording: Recording, first: float, last: float) -> dict[str, Span]:
    """What is played of each robot, on its own clock. `first`, `last`: s from the beginning of the recording, which is
    the first message of any robot. Clocks that nothing ties together begin with their robot's bags."""
    surveys = {}
    for robot in recording.robots:
        with opened(robot.bags) as reader:
            surveys[robot.name] = Survey(reader)
    names, moves = list(surveys), clock_shifts(surveys)
    starts = {name: surveys[name].span.start + moves[name] for name in moves}
    for name in names:
        moves.setdefault(name, min(starts.values()) - surveys[name].span.start)
    start = min(starts.values())
    end = max(survey.span.end + moves[name] for name, survey in surveys.items())
    length = (end - start) / SECOND
    if first >= length:
        raise UserError(f"--from {first:g}: the recording has {length:.1f} s")
    begin = start + round(first * SECOND)
    until = min(end, start + round(min(last, length) * SECOND))
    for robot in recording.robots:
        own = Span(begin - moves[robot.name], until - moves[robot.name])
        _check_clocks(robot, own, start - moves[robot.name])
    return {name: Span(begin - moves[name], until - moves[name]) for name in names}


def _check_clocks(robot: RecordedRobot, span: Span, start: int) -> None:
    """`start`: of the recording, ns. Raises UserError where the bags have the times of two clocks."""
    with opened(robot.bags) as reader:
        pause = pause_between_clocks(reader, span)
    if pause is not None:
        last, first = math.ceil((pause.start - start) / SECOND), math.floor((pause.end - start) / SECOND)
        raise UserError(
            f"{robot.name}: nothing was recorded from second {last} to {first}, so its times are those of two clocks, "
            f"simulated and real: --to {last} plays what lies before, --from {first} what lies behind"
        )


def computing_arguments(plan: Plan | None, name: str, options: argparse.Namespace, reader: Any) -> dict[str, str]:
    """Of replayed_robot.launch: what the nodes have to know, from the mission's plan or from options and bags."""
    strategy = options.strategy if options.strategy is not None else plan.options.strategy if plan else STRATEGY
    if plan is None:
        robot = options.robot or "pioneer"
        return {"robot": robot, "frontier_selection": str(strategy), **_driver_arguments(name, robot, reader)}
    preset = {robot.name: robot.preset for robot in plan.robots}[name]
    return {
        "robot": options.robot or plan.preset_file(preset),
        "team": plan.team,
        "simulated": "true",
        "frontier_selection": str(strategy),
        "initial_poses": initial_poses(plan) if plan.options.initial_poses else json.dumps({}),
        "topology": plan.options.topology,
        "base_station": BASE if plan.base else "",
        "seed": str(plan.options.seed + next(robot.index for robot in plan.robots if robot.name == name)),
    }


def _driver_arguments(name: str, preset: str, reader: Any) -> dict[str, str]:
    """Topics and frames that robot.launch was told, as far as the bags tell."""
    from mr_robot.platforms.preset import load_platform

    platform = load_platform(preset)
    topics = asdict(platform.topics)
    note = scan_note(name, reader.connections, topics)
    if note:
        print(f"replay: {note}", file=sys.stderr)
    told = driver_arguments(reader.connections, topics)
    return {**told, **frame_arguments(reader, told.get("odometry_topic", topics["odometry"]), asdict(platform.frames))}


def cuts_folder(out: Path) -> Path:
    return out / "played"


@contextlib.contextmanager
def _output_folder(out: Path) -> Iterator[None]:
    """The folder, empty; what was cut out for the player goes afterwards, and the folder if there is nothing else."""
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise UserError(f"--out {out} exists and is not an empty folder")
    cuts_folder(out).mkdir(parents=True)
    try:
        yield
    finally:
        shutil.rmtree(cuts_folder(out), ignore_errors=True)
        with contextlib.suppress(OSError):
            out.rmdir()
