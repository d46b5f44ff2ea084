"""Replays a decision that a robot has recorded: what each cluster costs this robot and the others, which one is chosen,
and whether that is what was chosen then."""

import argparse
import json
import math
from typing import Any, Dict, List, Optional, Type

import numpy as np

from explorer import scene_file
from explorer.decision import Decision, replayed
from explorer.errors import SceneError
from explorer.strategies import strategy_of
from explorer.strategies.strategy import FrontierStrategy, Strategy


def run(given: argparse.Namespace) -> int:
    """Prints the answer and draws it if that is wanted."""
    decision = scene_file.read(given.scene)
    kind = _strategy(decision.strategy if given.strategy is None else given.strategy)
    found = answer(decision, kind)
    print(json.dumps(found) if given.json else text(decision, found))
    if given.plot:
        from explorer.command_line.plot import draw_decision

        draw_decision(given.plot, decision, found["choice"], issubclass(kind, FrontierStrategy), headline(found))
    return 0


def _strategy(name: str) -> Type[Strategy]:
    try:
        return strategy_of(int(name) if name.isdecimal() else name)
    except KeyError as error:
        raise SceneError(str(error.args[0])) from error


def answer(decision: Decision, kind: Type[Strategy]) -> Dict[str, Any]:
    """As JSON object. `choice`: number of a cluster, or of a frontier point where the strategy has no clusters."""
    choice = replayed(decision, kind)
    return {
        "robot": decision.robot,
        "time": decision.scene.now,
        "strategy": kind.name,
        "unit": "frontier" if issubclass(kind, FrontierStrategy) else "cluster",
        "choice": choice,
        "as_recorded": choice == decision.choice if kind.name == decision.strategy else None,
        "clusters": _clusters(decision, kind(np.random.default_rng(0))),
    }


def _clusters(decision: Decision, strategy: Strategy) -> List[Dict[str, Any]]:
    scene = decision.scene
    ready = {cluster.number for cluster in scene.open}
    return [
        {
            "number": cluster.number,
            "place": list(cluster.place),
            "way": cluster.cost if math.isfinite(cluster.cost) else None,
            "bid": _finite(strategy.bid(scene, cluster)) if cluster.number in ready else None,
            "bids": {robot: bids[cluster.number] for robot, bids in decision.bids.items() if cluster.number in bids},
            "claimed_by": scene.claimed.get(cluster.number, decision.robot if cluster.number == scene.own else None),
            "reason": None if cluster.number in ready else _reason(decision, cluster.numbers),
        }
        for cluster in scene.clusters
    ]


def _finite(bid: float) -> Optional[float]:
    return bid if math.isfinite(bid) else None


def _reason(decision: Decision, members: Any) -> str:
    """Why nothing of a cluster can be tried now."""
    told = [decision.reasons[number] for number in sorted(members) if number in decision.reasons]
    return max(sorted(set(told)), key=told.count) if told else "to be tried later"


def headline(found: Dict[str, Any]) -> str:
    chosen = "nothing" if found["choice"] is None else f"{found['unit']} {found['choice']}"
    verdict = {True: ", as recorded", False: ", not as recorded", None: ""}[found["as_recorded"]]
    return f"{found['robot']} at {found['time']:.1f} s, strategy {found['strategy']}: {chosen}{verdict}"


def text(decision: Decision, found: Dict[str, Any]) -> str:
    """A line with the choice and a table of the clusters, bids of the other robots last."""
    robots = sorted(decision.bids)
    lines = [headline(found), "", "  cluster  place [m]          way [m]      bid  claimed by  " + "  ".join(robots)]
    for row in found["clusters"]:
        x, y = row["place"]
        bids = "  ".join(f"{_number(row['bids'].get(robot)):>{len(robot)}}" for robot in robots)
        mark = "*" if found["unit"] == "cluster" and row["number"] == found["choice"] else " "
        line = f"{mark} {row['number']:7d}  ({x:7.2f}, {y:7.2f})  {_number(row['way']):>7} {_number(row['bid']):>8}"
        lines.append(f"{line}  {row['claimed_by'] or '-':10s}  {bids}  {row['reason'] or ''}".rstrip())
    return "\n".join(lines)


def _number(value: Optional[float]) -> str:
    return "-" if value is None else f"{value:.2f}"
