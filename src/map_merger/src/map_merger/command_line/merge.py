"""Merges maps into the frame of the first one; exit code 3 if a map could not be placed."""

import argparse
import math
import sys

from mr_grid.map_files import MapFileError, read_map, write_map

from ..placement import Placed, merged, place
from .register import NOT_PLACED

MOST_MAPS = 64
"""As many as robots in a team; every pair may have to be registered."""


def run(options: argparse.Namespace) -> int:
    """Places all maps, writes the merged one and says what became of each."""
    if len(options.maps) > MOST_MAPS:
        raise MapFileError(f"at most {MOST_MAPS} maps are merged at once, not {len(options.maps)}")
    maps = [read_map(path) for path in options.maps]
    placement = place(maps)
    for number in sorted(placement.placed):
        print(line(options.maps, number, placement.placed[number]))
    picture, text = write_map(options.out, merged(maps, placement.placed))
    print(f"{1 + len(placement.placed)} of {len(maps)} maps in {picture} and {text}")
    for number, reason in sorted(placement.declined.items()):
        print(f"map_merger: {options.maps[number]} is not placed: {reason}", file=sys.stderr)
    return NOT_PLACED if placement.declined else 0


def line(names: list, number: int, placed: Placed) -> str:
    """Where a map was placed."""
    x, y, yaw = placed.transform
    through = f" through {names[placed.via]}" if placed.via else ""
    return (
        f"{names[number]}: x {x:.3f} m, y {y:.3f} m, yaw {yaw:.4f} rad ({math.degrees(yaw):.1f} deg){through}, "
        f"confidence {placed.confidence:.2f}, shared wall {placed.shared_wall:.1f} m"
    )
