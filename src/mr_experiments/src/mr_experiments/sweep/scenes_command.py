"""The command ``rosrun mr_experiments scenes``: the decisions of one mission, to be replayed one by one."""

import argparse
import math
import sys
from collections.abc import Sequence
from pathlib import Path

from explorer.errors import ExplorerError
from explorer.scene_folder import MOST_FILES
from mr_experiments.common.command_line import BAD_CALL, INTERRUPTED, CallError, Parser, strategy_number
from mr_experiments.host.mission import Mission
from mr_experiments.trial.scenario import DEFAULT, known_scenarios, load_scenario
from mr_experiments.trial.trial import Trial, TrialError
from mr_experiments.trial.trial_world import most_robots

ROBOTS = 3


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="scenes",
        description="Runs one mission in virtual time and writes what each decision of its robots depended on, as "
        f"DIR/ROBOT/decision_NUMBER.json, the newest {MOST_FILES} of a robot. The mission is the one that `run` makes "
        "of the same scenario, robots, strategy and seed.",
        epilog="Then: python3 -m explorer decide DIR/ROBOT/decision_NUMBER.json --plot OUT.png. "
        "Exit code: 0 written, 2 bad options, 130 interrupted.",
    )
    add = parser.add_argument
    add("--scenario", default=DEFAULT, metavar="NAME|FILE", help="as of run: " + ", ".join(known_scenarios())
        + ", or a .yaml file (default: %(default)s)")  # fmt: skip
    add("--world", default="", metavar="NAME|FILE", help="instead of the scenario's world")
    add("--robots", type=int, metavar="R", help=f"team size (default: {ROBOTS}, or all if the world has less)")
    add("--strategy", type=strategy_number, default=7, metavar="N|NAME", help="strategy (default: %(default)s)")
    add("--seed", type=int, default=1, metavar="N", help="of the mission (default: %(default)s)")
    add("--until", type=float, default=math.inf, metavar="S", help="s of the mission (default: to its end)")
    add("--out", default="out/scenes", metavar="DIR", help="folder for the decisions (default: %(default)s)")
    return parser


def main(arguments: Sequence[str]) -> int:
    """Runs the mission; returns the exit code."""
    try:
        given = make_parser().parse_args(arguments)
        trial = _trial_of(given)
        mission = Mission(trial, scene_path=given.out)
        mission.run(given.until)
    except (CallError, TrialError, ExplorerError, OSError) as error:
        print(f"scenes: {error}", file=sys.stderr)
        return BAD_CALL
    except KeyboardInterrupt:
        print("scenes: interrupted", file=sys.stderr)
        return INTERRUPTED
    count = len(list(Path(given.out).glob("*/decision_*.json")))
    print(f"{count} decisions of {mission.since_start:.1f} s are in {given.out}")
    return 0


def _trial_of(given: argparse.Namespace) -> Trial:
    scenario = load_scenario(given.scenario)
    robots = given.robots
    if robots is None:
        robots = min(ROBOTS, most_robots(scenario.trial(ROBOTS, given.strategy, given.seed, given.world)))
    return scenario.trial(robots, given.strategy, given.seed, given.world)
