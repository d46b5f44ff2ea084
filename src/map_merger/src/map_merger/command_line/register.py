"""Finds the transform of map B into A's frame, or says why there is none (exit code 3)."""

import argparse
import json
import math
from typing import Any, Dict, Optional

from mr_grid import Pose
from mr_grid.map_files import read_map

from ..one_shot import confidence_in, criteria_for, decide, doubt_of, sure
from ..reasons import reason_of
from ..registration import Registration, Verdict
from ..search import Prior
from ..surface import landmarks_of

NOT_PLACED = 3


def run(options: argparse.Namespace) -> int:
    """Registers the two maps and prints the answer."""
    target, source = landmarks_of(read_map(options.target)), landmarks_of(read_map(options.source))
    prior: Optional[Prior] = None if options.prior is None else Prior(Pose(*options.prior))
    result = decide(target, source, prior)
    reason = reason_of(result, criteria_for(prior))
    if options.sure and result.accepted and not sure(result):
        result, reason = result._replace(verdict=Verdict.AMBIGUOUS), f"may be a copy: {doubt_of(result)}"
    print(json.dumps(answer(result, reason)) if options.json else text(options, result, reason))
    if options.plot:
        from .plot import draw

        draw(options.plot, target, source, result, reason)
    return 0 if result.accepted else NOT_PLACED


def answer(result: Registration, reason: str) -> Dict[str, Any]:
    """The answer as JSON object; x, y (m) and yaw (rad) only for a transform that was accepted."""
    found: Dict[str, Any] = {"accepted": result.accepted}
    if result.accepted and result.transform is not None:
        found.update(zip(("x", "y", "yaw"), result.transform))
    return {
        **found,
        "confidence": confidence_in(result),
        "sure": sure(result),
        "shared_wall_m": result.evidence.matched,
        "reason": reason,
    }


def text(options: argparse.Namespace, result: Registration, reason: str) -> str:
    """The answer as one line for people."""
    if not result.accepted or result.transform is None:
        return f"{options.source} is not placed in the frame of {options.target}: {reason}"
    x, y, yaw = result.transform
    return (
        f"{options.source} in the frame of {options.target}: x {x:.3f} m, y {y:.3f} m, yaw {yaw:.4f} rad "
        f"({math.degrees(yaw):.1f} deg), confidence {confidence_in(result):.2f}, shared wall "
        f"{result.evidence.matched:.1f} m"
    )
