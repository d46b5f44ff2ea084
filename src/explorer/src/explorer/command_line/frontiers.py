"""Lists the frontiers of a map and their clusters, as a robot that starts to explore there sees them: place, length,
way from the robot, unknown area behind, and the reason where one is no goal."""

import argparse
import json
import math
from typing import Any, Dict, List

from explorer.clusters import Cluster
from explorer.command_line import map_file
from explorer.options import DEFAULTS, Options
from explorer.survey import Stretch, Survey, survey


def run(given: argparse.Namespace) -> int:
    """Prints the answer and draws it if that is wanted."""
    options = Options(
        inflation_radius=given.radius,
        largest_robot_radius=DEFAULTS["largest_robot_radius"],
        view_distance=given.view_distance,
        field_of_view=DEFAULTS["field_of_view"],
        minimal_frontier_length=given.shortest,
    )
    seen = survey(map_file.read(given.map), options, None if given.at is None else (given.at[0], given.at[1]))
    print(json.dumps(answer(seen)) if given.json else text(seen))
    if given.plot:
        from explorer.command_line.plot import draw_survey

        draw_survey(given.plot, seen, given.map)
    return 0


def answer(seen: Survey) -> Dict[str, Any]:
    """As JSON object; lengths in m, areas in m^2. A frontier that is a goal has the reason null."""
    return {
        "start": list(seen.start),
        "frontiers": [
            {
                "place": list(stretch.place),
                "length": stretch.length,
                "clusters": list(stretch.clusters),
                "reason": stretch.reason or None,
            }
            for stretch in seen.stretches
        ],
        "clusters": [
            {
                "number": cluster.number,
                "place": list(cluster.place),
                "points": len(cluster.members),
                "goals": len(cluster.views),
                "way": cluster.cost if math.isfinite(cluster.cost) else None,
                "gain": cluster.gain,
            }
            for cluster in seen.clusters
        ],
    }


def text(seen: Survey) -> str:
    """Two tables for people."""
    goals = sum(not stretch.reason for stretch in seen.stretches)
    lines = [f"{len(seen.stretches)} frontiers, {goals} of them goals, from ({seen.start[0]:.2f}, {seen.start[1]:.2f})"]
    lines += ["", "  place [m]          length [m]  clusters", *map(_stretch_line, seen.stretches)]
    lines += ["", f"{len(seen.clusters)} clusters"]
    lines += [
        "",
        "  number  place [m]          points  goals  way [m]  unknown [m^2]",
        *map(_cluster_line, seen.clusters),
    ]
    return "\n".join(lines)


def _stretch_line(stretch: Stretch) -> str:
    numbers: List[str] = [str(number) for number in stretch.clusters]
    line = f"  ({stretch.place[0]:7.2f}, {stretch.place[1]:7.2f}) {stretch.length:10.2f}  {', '.join(numbers):8s}"
    return f"{line}  {stretch.reason and 'no goal: ' + stretch.reason}".rstrip()


def _cluster_line(cluster: Cluster) -> str:
    way = f"{cluster.cost:7.2f}" if cluster.reachable else "no way "
    x, y = cluster.place
    return (
        f"  {cluster.number:6d}  ({x:7.2f}, {y:7.2f})  {len(cluster.members):6d}  {len(cluster.views):5d}  {way}"
        f"  {cluster.gain:13.2f}"
    )
