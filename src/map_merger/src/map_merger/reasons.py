"""Why a registration gave a transform or none, in words with numbers."""

import math
from typing import Optional

from .registration import STRONG_CRITERIA, Criteria, Registration, Verdict, judge
from .transform import rotation_between


def reason_of(result: Registration, criteria: Criteria) -> str:
    """One line for people about a result that was judged by `criteria`."""
    evidence, verdict = result.evidence, result.verdict
    if verdict is Verdict.ACCEPTED:
        return f"shared wall {evidence.matched:.1f} m"
    if verdict is Verdict.NO_CANDIDATE and result.transform is None:
        return "no transform lays walls of one map on walls of the other"
    if verdict is Verdict.NO_CANDIDATE:
        return "the best transform is not near the one that was given"
    if verdict is Verdict.TOO_LITTLE_SHARED_WALL and result.transform is None:
        return f"one of the maps has less than the {criteria.matched:g} m of wall that both must share"
    if verdict is Verdict.TOO_LITTLE_SHARED_WALL:
        return f"shared wall {evidence.matched:.1f} m of {criteria.matched:g} m"
    if verdict is Verdict.ONE_DIRECTION_ONLY:
        return f"shared wall in the weaker direction {evidence.minor:.1f} m of {criteria.minor:g} m"
    if verdict is Verdict.CONTRADICTED:
        return (
            f"{evidence.against:.1f} m of wall in free space of the other map: {100 * evidence.conflict:.1f} % of the "
            f"walls, at most {100 * criteria.conflict:g} %"
        )
    if verdict is Verdict.UNEXPLAINED:
        return f"{100 * evidence.explained:.0f} % of the walls found in the other map of {100 * criteria.explained:g} %"
    if verdict is Verdict.AMBIGUOUS:
        return _rivalry(result)
    return verdict.value


def unconfirmed_reason(result: Registration) -> str:
    """Why an accepted result alone is not believed."""
    if result.prior:
        return f"{reason_of(result, STRONG_CRITERIA)} at the given pose; waits until more is shared"
    alone = judge(result.evidence, STRONG_CRITERIA)
    if alone is Verdict.ACCEPTED:
        return f"shared wall {result.evidence.matched:.1f} m, but parts of the building look alike"
    return reason_of(result._replace(verdict=alone), STRONG_CRITERIA)


def waiting_reason(robot: str, result: Optional[Registration], criteria: Criteria, sightings: str = "") -> str:
    """Why a robot is not placed: its last result (None: none yet), and what the sightings of it lack, if anything."""
    if result is None:
        reason = "no map to compare yet"
    elif not result.accepted:
        reason = reason_of(result, criteria)
    else:
        reason = unconfirmed_reason(result)
        sightings = sightings or f"waits to see {robot} move" * (not result.prior)
    return f"{reason}; {sightings}" if sightings else reason


def _rivalry(result: Registration) -> str:
    """Two solutions: how different they are, and what each has."""
    if result.rival is None or result.transform is None:
        return result.verdict.value
    turn = math.degrees(rotation_between(result.transform, result.rival.transform))
    turned = f" and {turn:.0f} deg" if turn >= 1.0 else ""
    return (
        f"two solutions {result.rival.apart:.1f} m{turned} apart, with {result.evidence.matched:.1f} m and "
        f"{result.rival.evidence.matched:.1f} m of shared wall"
    )
