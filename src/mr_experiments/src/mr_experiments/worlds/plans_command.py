"""Command line of ``rosrun mr_experiments plans``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Sequence

import cv2

from mr_experiments.common.command_line import BAD_CALL, CallError, Parser
from mr_experiments.worlds.plan_pictures import sheet
from mr_plans import WORLD_KINDS
from mr_plans.names import FORM, is_generated, parse_name


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="plans",
        description="Worlds that are drawn from a seed. Without --out: lists the kinds. With it: draws worlds to look "
        "at, starts in red.",
        epilog=f"Their names, {FORM} (sizes in m), stand wherever the name of a world does: "
        "rosrun mr_experiments run --world generated:office:7, rosrun mr_launch team --world generated:hall:3:40x25. "
        "Their files are written to out/worlds. Exit code: 0 done, 2 bad call.",
    )
    parser.add_argument(
        "worlds", nargs="*", metavar="WORLD", help=f"{FORM} or a stored world's name (default: one of every kind)"
    )
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of one of every kind (default: %(default)s)")
    parser.add_argument("--out", type=Path, metavar="FILE.png", help="picture to draw")
    return parser


def main(arguments: Sequence[str]) -> int:
    try:
        options = make_parser().parse_args(arguments)
        if options.out is None:
            if options.worlds:
                for name in filter(is_generated, options.worlds):
                    parse_name(name)
                raise CallError("--out FILE.png is missing: where to draw the worlds")
            _list()
        else:
            _draw(options)
    except (ValueError, OSError) as error:
        print(f"plans: {error}", file=sys.stderr)
        return BAD_CALL
    return 0


def _list() -> None:
    print(f"{FORM}, with these kinds and, unless given, sizes:")
    for name, kind in WORLD_KINDS.items():
        length, depth = kind.size
        print(f"  {name:<11} {f'{length:g}x{depth:g}':<6} {kind.what}")


def _draw(options: argparse.Namespace) -> None:
    if options.out.suffix.lower() != ".png":
        raise CallError(f"--out {options.out} must end in .png")
    names = options.worlds or [f"generated:{kind}:{options.seed}" for kind in WORLD_KINDS]
    done, data = cv2.imencode(".png", sheet(names), [cv2.IMWRITE_PNG_COMPRESSION, 9])
    if not done:
        raise CallError("the worlds are too large for one picture")
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_bytes(data.tobytes())
    print(options.out)
