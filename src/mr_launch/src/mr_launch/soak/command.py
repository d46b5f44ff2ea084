"""``rosrun mr_launch soak``: options, the course of it, its table."""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Sequence

from mr_launch.arguments import LIMITS, choose_robots
from mr_launch.errors import UserError
from mr_launch.exit_codes import BAD_CALL, FAILED, INTERRUPTED, OK
from mr_launch.soak.faults import disturbed, full_disk
from mr_launch.soak.missions import ROBOTS, Outcome, SoakMission
from mr_launch.soak.rows import LEAST_HOLD_S, alone_rows, rows_of
from mr_launch.world import check_start, find_world, robots_of

HOLD_SHARE = 0.25  # of the whole time
MOST_MISSIONS = 10000  # each has a seed of its own
SHORTEST, LONGEST = 10.0, 1440.0  # min: one mission of each kind, and the rest
LEAST_FOR_MEMORY = 30.0  # min, below which there is no verdict on memory


def make_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="soak",
        description="Three robots, mission after mission, with partitions, killed nodes, masters that restart, a full "
        "disk and clocks that jump. In the first one nothing is killed, and the robots stand for a quarter of the "
        f"time, {LEAST_HOLD_S / 60.0:g} min at least, to look at their memory; of less than {LEAST_FOR_MEMORY:g} min "
        "in all they stand for a quarter, and there is no verdict on memory. Needs root, for disks and namespaces of "
        "its own.",
        epilog="Exit code: 0 all was survived and nothing left, 1 not, 2 bad options, 130 interrupted.",
    )
    add = parser.add_argument
    add(
        "--minutes",
        type=float,
        default=120.0,
        metavar="M",
        help=f"{SHORTEST:g} to {LONGEST:g}; the last mission ends later (default: %(default)s)",
    )
    add("--alone", action="store_true", help="no soak: one mission of one robot, to look at the memory it needs alone")
    add("--world", default="office26x15", metavar="NAME", help="as of the team runner (default: %(default)s)")
    add("--seed", type=int, default=1, metavar="N", help="of the first mission (default: %(default)s)")
    add("--out", type=Path, metavar="FILE", help="JSON file for the rows")
    add("--keep", type=Path, metavar="DIR", help="keep the output of the missions there")
    return parser


def main(arguments: Sequence[str]) -> int:
    parser = make_parser()
    options = parser.parse_args(arguments)
    if not SHORTEST <= options.minutes <= LONGEST:
        parser.error(f"--minutes {options.minutes:g} is out of range: {SHORTEST:g} to {LONGEST:g}")
    if os.geteuid() != 0:
        parser.error("a soak needs root, for disks and namespaces of its own")
    try:
        check(options.world, options.seed)
        if options.out:
            if options.out.is_dir():
                raise UserError(f"--out {options.out} is a folder; give a file")
            options.out.parent.mkdir(parents=True, exist_ok=True)
            options.out.touch()
    except UserError as error:
        parser.error(str(error))
    except OSError as error:
        parser.error(f"--out {options.out} cannot be written: {error.strerror}")
    with tempfile.TemporaryDirectory(prefix="soak-") as name:
        folder = (options.keep or Path(name)).absolute()
        outcomes: list[Outcome] = []
        interrupted = False
        try:
            if options.alone:
                outcomes.append(_run(SoakMission("alone", folder, options.world, options.seed, robots=ROBOTS[:1])))
            else:
                soak(folder, options.world, options.seed, 60.0 * options.minutes, outcomes)
        except KeyboardInterrupt:
            interrupted = True
            print("soak: interrupted; the rows are those of the missions before", file=sys.stderr)
    if options.alone:
        rows = [entry for outcome in outcomes for entry in alone_rows(outcome)]
    else:
        rows = rows_of(outcomes, long=options.minutes >= LEAST_FOR_MEMORY)
    if options.out:
        options.out.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    if interrupted:
        return INTERRUPTED
    return OK if all(entry["holds"] for entry in rows) else FAILED


def check(world: str, seed: int) -> None:
    """What every mission would be refused for. Raises UserError."""
    lowest, highest, _ = LIMITS["seed"]
    highest -= MOST_MISSIONS
    if not lowest <= seed <= highest:
        raise UserError(f"--seed {seed} is out of range: {lowest:.0f} to {highest:.0f}")
    path = find_world(world)
    names = choose_robots(len(ROBOTS), [name for name, _ in robots_of(path)], path)
    if names != ROBOTS:
        raise UserError(f"--world {world}: the first robots are {', '.join(names)}; a soak is of {', '.join(ROBOTS)}")
    check_start(path, len(ROBOTS))


def soak(folder: Path, world: str, seed: int, seconds: float, outcomes: list[Outcome]) -> None:
    """One mission at rest, then disturbed ones and such on a full disk in turns, at least one of each; adds to
    `outcomes`. Ends with a call that the team runner refuses."""
    end = time.monotonic() + seconds
    rest = SoakMission("rest", folder / "0_rest", world, seed, page=True)
    hold = HOLD_SHARE * seconds
    outcomes.append(_run(rest, hold=max(hold, LEAST_HOLD_S) if seconds >= 60.0 * LEAST_FOR_MEMORY else hold))
    turn = 0
    while outcomes[-1].code != BAD_CALL and (turn < 2 or time.monotonic() < end):
        number = seed + turn + 1
        if turn % 2 == 0:
            mission = SoakMission(f"disturbed {turn}", folder / f"{turn + 1}_disturbed", world, number, page=True)
            outcomes.append(_run(mission, disturbed(ROBOTS, turn)))
        else:
            mission = SoakMission(f"full disk {turn}", folder / f"{turn + 1}_full_disk", world, number, small_disk=True)
            outcomes.append(_run(mission, full_disk(ROBOTS, turn)))
        turn += 1


def _run(mission: SoakMission, faults: Sequence = (), hold: float = 0.0) -> Outcome:
    begin = time.monotonic()
    rest = f"; once the world is explored, its robots are watched for {hold / 60.0:.0f} min" if hold else ""
    print(f"soak: {mission.name}: begins{rest}", file=sys.stderr, flush=True)
    outcome = mission.run(faults, hold)
    verdict = (
        "survived" if outcome.survived else f"exit code {outcome.code}, stuck: {outcome.stuck}, left: {outcome.left}"
    )
    print(f"soak: {mission.name}: {verdict}, {time.monotonic() - begin:.0f} s", file=sys.stderr, flush=True)
    if not outcome.survived:
        print("\n".join(f"    {line}" for line in outcome.output.splitlines()[-12:]), file=sys.stderr, flush=True)
    return outcome
