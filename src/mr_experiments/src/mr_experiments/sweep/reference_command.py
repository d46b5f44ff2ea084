"""Command line of ``rosrun mr_experiments reference``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Sequence

from mr_experiments.common.command_line import BAD_CALL, CallError, Parser
from mr_experiments.sweep.map_reference import TOLERANCE, deviation, make_reference
from mr_experiments.sweep.sweep import default_jobs
from mr_experiments.trial.trial import TrialError
from mr_measures.reference import MINIMUM_MISSIONS, MapReferenceError, load_reference, write_reference
from mr_sim.worlds import WorldNotFoundError, find_world


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="reference",
        description="Runs missions of one robot in virtual time and stores how much they explore as "
        "WORLD.reference.json beside the world file: what the map error e of later missions is measured against.",
        epilog="Exit code: 0 done, 1 a mission did not finish or (--check) came out otherwise, 2 bad call.",
    )
    add = parser.add_argument
    add("worlds", nargs="+", metavar="WORLD", help="name or file of a world")
    add("--check", action="store_true", help="store nothing; repeat the first stored mission of each world")
    add("--missions", type=int, default=12, metavar="N", help=f"at least {MINIMUM_MISSIONS} (default: %(default)s)")
    add("--first-seed", type=int, default=900001, metavar="N", help="outside all that is measured (default: "
        "%(default)s)")  # fmt: skip
    add("--limit", type=float, default=1800.0, metavar="S", help="give up after this virtual time, in s (default: "
        "%(default)g; an office of 60 m x 60 m takes an hour)")  # fmt: skip
    add("--jobs", type=int, default=default_jobs(), metavar="N", help="missions at a time (default: %(default)s)")
    return parser


def main(arguments: Sequence[str]) -> int:
    try:
        options = make_parser().parse_args(arguments)
        if options.missions < MINIMUM_MISSIONS:
            raise CallError(f"--missions {options.missions} must be at least {MINIMUM_MISSIONS}")
        if options.jobs < 1 or options.first_seed < 0:
            raise CallError("--jobs must be at least 1 and --first-seed at least 0")
        worlds = [find_world(name) for name in options.worlds]
        kept = [_check(world, options) if options.check else _store(world, options) for world in worlds]
    except (CallError, WorldNotFoundError, MapReferenceError, OSError) as error:
        print(f"reference: {error}", file=sys.stderr)
        return BAD_CALL
    except TrialError as error:
        print(f"reference: {error}", file=sys.stderr)
        return 1
    return 0 if all(kept) else 1


def _store(world: Path, options: argparse.Namespace) -> bool:
    def progress(seed: int, cells: int, time: float) -> None:
        print(f"{world.stem}, seed {seed}: {time:.0f} s, {cells} free cells", flush=True)

    seeds = range(options.first_seed, options.first_seed + options.missions)
    reference = make_reference(str(world), seeds, options.limit, options.jobs, progress)
    print(f"{world.stem}: {_before(world)}median {reference.median:.0f} in {write_reference(world, reference)}")
    return True


def _before(world: Path) -> str:
    try:
        reference = load_reference(world)
    except MapReferenceError as error:
        return f"({error}) "
    return "" if reference is None else f"median {reference.median:.0f} before, "


def _check(world: Path, options: argparse.Namespace) -> bool:
    by = deviation(world, options.limit)
    holds = abs(by) <= TOLERANCE
    told = "as stored" if holds else "store it anew"
    print(f"{world.stem}: the first mission explores {by:+.3f} % (at most {TOLERANCE:g} %): {told}", flush=True)
    return holds
