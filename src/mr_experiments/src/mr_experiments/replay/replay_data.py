"""What a replay shows of a record besides its maps: motion, goals, links, merges and events, placed in the world frame.

Lengths in metres, angles in radians, times in seconds of virtual time since the mission started. Series come out as
plain lists with rounded numbers; what was not recorded comes out as None or as an empty list.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from mr_grid import Pose
from mr_measures.record.mission_record import MissionRecord, Note
from mr_measures.record.robot_record import Merge, Offer, RobotRecord
from mr_measures.record.series import RobotSeries, TeamSeries
from mr_page.watch import REFUSED

STATES = ("starting", "exploring", "waiting", "returning", "finished")  # of explorer/ExplorationState, by number

# Digits kept of each series; those that were not recorded are left out.
POSE_DIGITS = {"x": 3, "y": 3, "yaw": 3}
ROBOT_DIGITS = {**POSE_DIGITS, "explored": 1, "own": 1, "distance": 1, "bytes": 0, "state": 0}
TEAM_DIGITS = {"explored": 1, "coverage": 4}
TIME_DIGITS = 2
SAME_WARNING = 20.0  # s

Robots = Mapping[str, RobotRecord]


class ReplayError(ValueError):
    """A record that cannot be replayed; the text names the culprit and the remedy."""


def _round(value: float, digits: int) -> float | int:
    """Whole numbers as int."""
    short = round(float(value), digits)
    return int(short) if short == int(short) else short


def _moment(time: float | None) -> float | int | None:
    return None if time is None else _round(time, TIME_DIGITS)


def series_of(series: RobotSeries | TeamSeries, digits: Mapping[str, int]) -> dict[str, list]:
    """The columns named in `digits` that were recorded, beside their "time"; {} without times."""
    if not series.time:
        return {}
    wanted = {"time": TIME_DIGITS, **digits}
    columns = {name: getattr(series, name) for name in wanted}
    return {name: [_round(value, wanted[name]) for value in column] for name, column in columns.items() if column}


def robot_series(series: RobotSeries) -> dict[str, list]:
    """Of ROBOT_DIGITS; poses are there only if x, y and yaw all are."""
    result = series_of(series, ROBOT_DIGITS)
    whole = POSE_DIGITS.keys() <= result.keys()
    return {name: column for name, column in result.items() if whole or name not in POSE_DIGITS}


def goals(robot: RobotRecord) -> list[dict[str, Any]]:
    """Goals of a robot with x, y in the world frame; the record has them in the robot's map frame."""
    placed = [(goal, robot.start.apply_point(goal.x, goal.y)) for goal in robot.goals]
    return [
        {
            "set": _moment(goal.set),
            "end": _moment(goal.end),
            "x": _round(x, 3),
            "y": _round(y, 3),
            "outcome": goal.outcome,
            "text": goal.text,
        }
        for goal, (x, y) in placed
    ]


def auctions(robot: RobotRecord) -> list[dict[str, Any]]:
    """Auctions that a robot opened: time "at", "id" and number of "clusters"; what came of them as "offers" (x, y in
    the world frame, {robot: bid}, robot that explored it or empty) with bids in "unit"; when others' bids came as
    "answered" ({robot: time}), and when it was "decided" (None: not recorded)."""
    return [
        {
            "at": _moment(one.at),
            "id": one.id,
            "clusters": one.clusters,
            "unit": one.unit,
            "offers": [_offer(offer, robot.start) for offer in one.offers],
            "answered": {name: _moment(at) for name, at in one.answered.items()},
            "decided": _moment(one.decided),
        }
        for one in robot.auctions
    ]


def _offer(offer: Offer, start: Pose) -> list[Any]:
    x, y = start.apply_point(offer.x, offer.y)
    bids = {name: _round(bid, 2) for name, bid in offer.bids.items()}
    return [_round(x, 2), _round(y, 2), bids, offer.explored_by]


def merges(robots: Robots) -> list[dict[str, Any]]:
    """All merges in the order of time: "at", "by", "with" (numbers of robots, None for one that is not in the record),
    "kind" ("right", "wrong", "revoked" or "unknown"), whether it is one "again" without having been revoked, and the
    errors "offset" (m) and "turn" (rad)."""
    numbers = {name: index for index, name in enumerate(robots)}
    result = []
    for name, robot in robots.items():
        merged: dict[str, bool] = {}
        for merge in robot.merges or ():
            result.append(
                {
                    "at": _moment(merge.at),
                    "by": numbers[name],
                    "with": numbers.get(merge.partner),
                    "name": merge.partner,
                    "kind": merge_kind(merge),
                    "again": merged.get(merge.partner, False),
                    "offset": None if merge.offset is None else _round(merge.offset, 3),
                    "turn": None if merge.turn is None else _round(merge.turn, 4),
                }
            )
            merged[merge.partner] = merge.accepted
    return sorted(result, key=lambda merge: merge["at"])


def merge_kind(merge: Merge) -> str:
    """ "right" or "wrong" against the truth, "revoked" when the transform was given up, "unknown" when not judged."""
    if not merge.accepted:
        return "revoked"
    return "unknown" if merge.right is None else "right" if merge.right else "wrong"


def links(robots: Robots, end: float) -> list[list]:
    """Spans in which robots were radio neighbours: [begin, end, first, second, both], first < second by their numbers.

    `both` tells whether each had the other as a neighbour, otherwise only one of them had. A sample counts until the
    next one, the last of a robot until `end`.
    """
    numbers = {name: index for index, name in enumerate(robots)}
    changes: dict[tuple[int, int], list[tuple[float, int, bool]]] = {}
    for name, robot in robots.items():
        heard: set[int] = set()
        for at, now in _neighbors(robot, numbers):
            for other in (heard ^ now) - {numbers[name]}:
                pair = min(numbers[name], other), max(numbers[name], other)
                changes.setdefault(pair, []).append((at, numbers[name], other in now))
            heard = now
    return sorted(span for pair, list_ in changes.items() for span in _spans(pair, sorted(list_), end))


def _neighbors(robot: RobotRecord, numbers: Mapping[str, int]) -> list[tuple[float, set[int]]]:
    """Times and the robots that were neighbours from then on."""
    series = robot.series
    return [
        (at, {numbers[name] for name in names if name in numbers}) for at, names in zip(series.time, series.neighbors)
    ]


def _spans(pair: tuple[int, int], changes: Sequence[tuple[float, int, bool]], end: float) -> list[list]:
    """Spans of one pair from the moments at which one of the two gained or lost the other."""
    result: list[list] = []
    hearing: set[int] = set()
    begin = 0.0
    for at, robot, hears in [*changes, (end, -1, False)]:
        if hearing and at > begin:
            result.append([_moment(begin), _moment(at), *pair, len(hearing) == 2])
        begin = at
        if hears:
            hearing.add(robot)
        else:
            hearing.discard(robot)
    return _joined(result)


def _joined(spans: Sequence[list]) -> list[list]:
    """Spans that follow each other without gap or change as one."""
    result: list[list] = []
    for span in spans:
        if result and result[-1][1] == span[0] and result[-1][4] == span[4]:
            result[-1][1] = span[1]
        else:
            result.append(span)
    return result


def end_of(record: MissionRecord) -> float:
    """The last moment that the record knows."""
    columns = [record.team.series.time, *(robot.series.time for robot in record.robots.values())]
    return max([record.outcome.time, *(column[-1] for column in columns if column)])


STEPS_OF_LIFE = {  # kind of event: what it says
    "joined": "joined the team",
    "died": "died",
    "finished": "finished its exploration",
}


def events(robots: Sequence[Mapping[str, Any]], merged: Sequence[Mapping[str, Any]], end: float) -> list[dict]:
    """What people look for on the time line, in order: "at", "robot", "kind" and one line of "text".

    `robots`: as made by `robots_of`; `merged`: as made by `merges`; nothing after `end` is listed.
    """
    result = [_merge_event(merge, robots) for merge in merged]
    for index, robot in enumerate(robots):
        for kind, text in STEPS_OF_LIFE.items():
            if robot[kind] is not None:
                result.append({"at": robot[kind], "robot": index, "kind": kind, "text": f"{robot['name']} {text}"})
        for goal in robot["goals"]:
            if goal["outcome"] == "failed" and goal["end"] is not None:
                why = f": {goal['text']}" if goal["text"] else ""
                text = f"{robot['name']} failed to reach its goal{why}"
                result.append({"at": goal["end"], "robot": index, "kind": "failed", "text": text})
    return sorted((event for event in result if event["at"] <= end), key=lambda event: event["at"])


def warnings(record: MissionRecord, end: float) -> list[dict]:
    """Warnings of the robots' programs as events of kind "warning", in the order of time; one that comes again within
    SAME_WARNING after its first time is told once, with how many times."""
    numbers = {name: index for index, name in enumerate(record.robots)}
    notes = [note for note in record.notes if note.warning and note.robot in numbers and note.at <= end]
    told: list[list[Note]] = []
    newest: dict[tuple[str, str], list[Note]] = {}
    for note in sorted(notes, key=lambda note: note.at):
        group = newest.get((note.robot, note.text))
        if group is None or note.at - group[0].at >= SAME_WARNING:
            group = newest[note.robot, note.text] = []
            told.append(group)
        group.append(note)
    return [_warning(numbers[group[0].robot], group[0], len(group)) for group in told]


def _warning(robot: int, note: Note, times: int) -> dict:
    text = note.text.removeprefix(REFUSED)
    often = f" ({times} times)" if times > 1 else ""
    return {"at": _moment(note.at), "robot": robot, "kind": "warning", "text": f"{note.robot}: {text}{often}"}


def _merge_event(merge: Mapping[str, Any], robots: Sequence[Mapping[str, Any]]) -> dict:
    name, errors = robots[merge["by"]]["name"], []
    if merge["offset"] is not None:
        errors.append(f"{merge['offset']:.2f} m")
    if merge["turn"] is not None:
        errors.append(f"{math.degrees(merge['turn']):.1f}°")
    off = f" ({', '.join(errors)} off)" if errors else ""
    verb = "adjusted its merge with" if merge["again"] else "merged"
    text = {
        "right": f"{name} {verb} {merge['name']}: right{off}",
        "wrong": f"{name} {verb} {merge['name']}: WRONG{off}",
        "revoked": f"{name} gave up its merge with {merge['name']}",
        "unknown": f"{name} {verb} {merge['name']}",
    }[merge["kind"]]
    return {"at": merge["at"], "robot": merge["by"], "kind": merge["kind"], "text": text}


def robots_of(record: MissionRecord) -> list[dict[str, Any]]:
    """Per robot: "name", "start" (world frame), "joined", "died", "finished" (times or None), "series", "goals" (world
    frame) and "auctions"."""
    joins = record.asked.settings.get("joins") or {}  # by number of the robot
    return [
        {
            "name": name,
            "start": [_round(value, 4) for value in robot.start],
            "joined": _moment(joins.get(str(index))),
            "died": _moment(robot.died_at),
            "finished": _moment(robot.finished_at),
            "series": robot_series(robot.series),
            "goals": goals(robot),
            "auctions": auctions(robot),
        }
        for index, (name, robot) in enumerate(record.robots.items())
    ]
