"""Command line of the world process."""

import argparse
import contextlib
import json
import math
import sys

from mr_sim.radio_control import RadioControl
from mr_sim.trace import TraceWriter
from mr_sim.world import BIAS, ODOMETRY_MODELS, World, WorldError
from mr_sim.world_file import WorldFileError
from mr_sim.world_model import load_world
from mr_sim.world_server import ServerError, WorldServer, listen
from mr_sim.worlds import WorldNotFoundError, find_world, starts_of, warning_of, with_starts


def argument_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="world", description="Holds the truth of a Stage world and serves it to robots over a Unix socket."
    )
    parser.add_argument(
        "--world", required=True, help="a .world file, a map's .yaml file, or the name of one of the project's worlds"
    )
    parser.add_argument("--socket", required=True, help="path of the Unix socket to listen on")
    parser.add_argument("--robots", type=int, help="take the first N robots of the world (default: all)")
    parser.add_argument(
        "--starts",
        type=float,
        nargs="+",
        default=[],
        metavar="X Y DEGREES",
        help="start poses of the robots in the world frame, m and degrees, instead of the world's own",
    )
    parser.add_argument(
        "--rtf", type=float, help="real-time factor, 0 = as fast as the robots read (default: the speedup of the world)"
    )
    parser.add_argument("--seed", type=int, default=0, help="of range noise and odometry error (default: 0)")
    parser.add_argument(
        "--odometry", choices=ODOMETRY_MODELS, default=BIAS, help="how it errs, see the README (default: %(default)s)"
    )
    parser.add_argument("--duration", type=float, help="simulated seconds to run (default: until stopped)")
    parser.add_argument("--radio-control", help="control socket of the radio daemon, told where the robots are")
    parser.add_argument("--trace", help="file to write the truth trace to")
    return parser


def _say(line: str) -> None:
    with contextlib.suppress(OSError):  # the disk with the log is full
        print(f"world: {line}", flush=True)


def _make_server(arguments: argparse.Namespace) -> WorldServer:
    if arguments.seed < 0:
        raise WorldError(f"--seed must not be negative, not {arguments.seed}")
    for option in ("rtf", "duration"):
        value = getattr(arguments, option)
        if value is not None and not (math.isfinite(value) and value >= 0.0):
            raise WorldError(f"--{option} must be a number >= 0, not {value:g}")
    description = load_world(find_world(arguments.world))
    if arguments.starts:
        description = with_starts(description, starts_of(arguments.starts))
    warning = warning_of(arguments.world, description)
    if warning:
        _say(f"warning: {warning}")
    world = World(description, arguments.robots, arguments.seed, odometry=arguments.odometry)
    factor = description.speedup if arguments.rtf is None else arguments.rtf
    trace = None
    if arguments.trace:
        trace = TraceWriter(arguments.trace, str(description.path), arguments.seed, factor, _say)
    return WorldServer(
        world,
        listen(arguments.socket),
        factor,
        description.quit_time if arguments.duration is None else arguments.duration,
        trace,
        RadioControl(arguments.radio_control, _say) if arguments.radio_control else None,
        _say,
    )


def main(argv: list[str] | None = None) -> int:
    """Run the world process; returns its exit code."""
    # roslaunch appends remappings (__name:=...) to what it starts.
    words = [word for word in (sys.argv[1:] if argv is None else argv) if ":=" not in word]
    arguments = argument_parser().parse_args(words)
    try:
        server = _make_server(arguments)
    except (WorldFileError, WorldNotFoundError, WorldError, ServerError, ValueError) as error:
        print(f"world: {error}", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"world: {error.filename}: {error.strerror}", file=sys.stderr)
        return 1
    server.stop_on_signals()
    _say(f"ready on {arguments.socket}, waiting for {', '.join(server.world.names)}")
    server.run()
    summary = {
        "simulated": round(server.world.time, 3),
        "wall": round(server.wall, 3),
        "real_time_factor": round(server.achieved_factor, 4),
    }
    print(json.dumps(summary), flush=True)
    return 0
