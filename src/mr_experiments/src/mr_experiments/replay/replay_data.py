"""What a replay shows of a record besides its maps: motion, goals, links, merges and events, placed in the world frame.

Lengths in metres, angles in radians, times in seconds of virtual time since the mission started. Series come out as
plain lists with rounded numbers; what a record lacks comes out as None or as an empty list.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any

from mr_grid import Pose

STATES = ("starting", "exploring", "waiting", "returning", "finished")  # of explorer/ExplorationState, by number

# Digits kept of each series of a robot; all but the first three may be missing.
POSE_DIGITS = {"x": 3, "y": 3, "yaw": 3}
SERIES_DIGITS = {"explored": 1, "own": 1, "distance": 1, "bytes": 0, "state": 0}
TIME_DIGITS = 2

Record = Mapping[str, Any]


class ReplayError(ValueError):
    """A record that cannot be replayed; the text names the culprit and the remedy."""


def section(entry: Mapping[str, Any], key: str, where: str = "") -> Record:
    """The object `entry[key]`, empty when it is missing or null. Raises ReplayError for anything else."""
    value = entry.get(key)
    if value is None:
        return {}
    if not isinstance(value, Mapping):
        raise ReplayError(f'"{_path(where, key)}" is not an object: the record is damaged, run the trial again')
    return value


def entries(entry: Mapping[str, Any], key: str, where: str) -> list[Record]:
    """The list of objects `entry[key]`, empty when it is missing or null. Raises ReplayError for anything else."""
    value = entry.get(key)
    if value is None:
        return []
    if not isinstance(value, list) or not all(isinstance(item, Mapping) for item in value):
        raise ReplayError(f'"{_path(where, key)}" is not a list of objects: the record is damaged, run the trial again')
    return value


def number(entry: Mapping[str, Any], key: str, where: str) -> float:
    """The finite number `entry[key]`. Raises ReplayError when there is none."""
    value = optional_number(entry, key, where)
    if value is None:
        raise ReplayError(f'"{_path(where, key)}" is missing: the record is damaged, run the trial again')
    return value


def optional_number(entry: Mapping[str, Any], key: str, where: str) -> float | None:
    """The number `entry[key]`, None when it is missing, null or not finite. Raises ReplayError for anything else."""
    value = entry.get(key)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ReplayError(f'"{_path(where, key)}" is not a number: the record is damaged, run the trial again')
    return float(value) if math.isfinite(value) else None


def _path(where: str, key: str) -> str:
    return f"{where}.{key}" if where else key


def pose_of(value: Any, where: str) -> Pose:
    """A pose from a list [x, y, yaw]. Raises ReplayError for anything else."""
    numbers = value if isinstance(value, list) and len(value) == 3 else [None]
    if not all(isinstance(v, (int, float)) and math.isfinite(v) for v in numbers):
        raise ReplayError(f'"{where}" is not a pose [x, y, yaw]: the record is damaged, run the trial again')
    return Pose(float(value[0]), float(value[1]), float(value[2]))


def rounded(values: Iterable[Any], digits: int) -> list[float | int | None]:
    """The numbers with at most so many digits, whole ones as int; None for what is no finite number."""
    return [_round(value, digits) for value in values]


def _round(value: Any, digits: int) -> float | int | None:
    if not isinstance(value, (int, float)) or not math.isfinite(value):
        return None
    short = round(float(value), digits)
    return int(short) if short == int(short) else short


def series_of(entry: Record, digits: Mapping[str, int], where: str) -> dict[str, list]:
    """The series of `entry` named in `digits` that are there, beside their "time"; {} without times.

    Raises ReplayError for series of different lengths.
    """
    source = section(entry, "series", where)
    if not source.get("time"):
        return {}
    times = rounded(_values(source, "time", where), TIME_DIGITS)
    result = {"time": times}
    if None in times or any(b < a for a, b in pairwise(t for t in times if t is not None)):
        raise ReplayError(f'"{where}.series.time" does not rise: the record is damaged, run the trial again')
    for name, places in digits.items():
        if source.get(name) is not None:
            result[name] = rounded(_values(source, name, where), places)
            check_length(result[name], result["time"], f"{where}.series.{name}")
    return result


def _values(source: Record, name: str, where: str) -> list:
    if not isinstance(source[name], list):
        raise ReplayError(f'"{where}.series.{name}" is not a list: the record is damaged, run the trial again')
    return source[name]


def check_length(values: Sequence, times: Sequence, where: str) -> None:
    """Raises ReplayError unless there are as many values as times."""
    if len(values) != len(times):
        raise ReplayError(
            f'"{where}" has {len(values)} values for {len(times)} times: the record is damaged, run the trial again'
        )


def start_pose(robot: Record, where: str) -> Pose | None:
    """True start pose in the world frame: as recorded, else the first pose of the series, else None."""
    if robot.get("start") is not None:
        return pose_of(robot["start"], f"{where}.start")
    poses = robot_series(robot, where)
    return Pose(poses["x"][0], poses["y"][0], poses["yaw"][0]) if "x" in poses else None


def robot_series(robot: Record, where: str) -> dict[str, list]:
    """Series of a robot (see `POSE_DIGITS`, `SERIES_DIGITS`); poses are there only if x, y and yaw all are, finite."""
    result = series_of(robot, {**POSE_DIGITS, **SERIES_DIGITS}, where)
    if not all(name in result and None not in result[name] for name in POSE_DIGITS):
        for name in POSE_DIGITS:
            result.pop(name, None)
    return result


def goals(robot: Record, start: Pose | None, where: str) -> list[dict[str, Any]]:
    """Goals of a robot with x, y in the world frame; the record has them in the robot's map frame.

    Without a start pose they cannot be placed, so there are none.
    """
    if start is None:
        return []
    result = []
    for index, goal in enumerate(entries(robot, "goals", where)):
        place = f"{where}.goals[{index}]"
        x, y, _ = start.compose(Pose(number(goal, "x", place), number(goal, "y", place), 0.0))
        result.append(
            {
                "set": _round(number(goal, "set", place), TIME_DIGITS),
                "end": _round(optional_number(goal, "end", place), TIME_DIGITS),
                "x": _round(x, 3),
                "y": _round(y, 3),
                "outcome": str(goal.get("outcome") or ""),
                "text": str(goal.get("text") or ""),
            }
        )
    return result


def auctions(robot: Record, where: str) -> list[dict[str, Any]]:
    """Auctions that a robot opened: time "at", "id" and number of "clusters" (0 when not recorded)."""
    result = []
    for index, auction in enumerate(entries(robot, "auctions", where)):
        place = f"{where}.auctions[{index}]"
        result.append(
            {
                "at": _round(number(auction, "at", place), TIME_DIGITS),
                "id": auction.get("id"),
                "clusters": int(optional_number(auction, "clusters", place) or 0),
            }
        )
    return result


def merges(robots: Mapping[str, Record]) -> list[dict[str, Any]]:
    """All merges in the order of time: "at", "by", "with" (numbers of robots, None for one that is not in the record),
    "kind" ("right", "wrong", "revoked" or "unknown"), whether it is one "again" without having been revoked, and the
    errors "offset" (m) and "turn" (rad)."""
    numbers = {name: index for index, name in enumerate(robots)}
    result = []
    for name, robot in robots.items():
        merged: dict[str, bool] = {}
        for index, merge in enumerate(entries(robot, "merges", f"robots.{name}")):
            place, other, kind = f"robots.{name}.merges[{index}]", str(merge.get("with") or "?"), merge_kind(merge)
            result.append(
                {
                    "at": _round(number(merge, "at", place), TIME_DIGITS),
                    "by": numbers[name],
                    "with": numbers.get(other),
                    "name": other,
                    "kind": kind,
                    "again": merged.get(other, False),
                    "offset": _round(optional_number(merge, "offset", place), 3),
                    "turn": _round(optional_number(merge, "turn", place), 4),
                }
            )
            merged[other] = kind != "revoked"
    return sorted(result, key=lambda merge: merge["at"])


def merge_kind(merge: Record) -> str:
    """ "right" or "wrong" against the truth, "revoked" when the transform was given up, "unknown" when not judged."""
    if "transform" in merge and merge["transform"] is None:
        return "revoked"
    right = merge.get("right")
    return "unknown" if right is None else "right" if right else "wrong"


def links(robots: Mapping[str, Record], end: float) -> list[list]:
    """Spans in which robots were radio neighbours: [begin, end, first, second, both], first < second by their numbers.

    `both` tells whether each had the other as a neighbour, otherwise only one of them had. A sample counts until the
    next one, the last of a robot until `end`.
    """
    numbers = {name: index for index, name in enumerate(robots)}
    changes: dict[tuple[int, int], list[tuple[float, int, bool]]] = {}
    for name, robot in robots.items():
        heard: set[int] = set()
        for at, now in _neighbors(robot, numbers, f"robots.{name}"):
            for other in (heard ^ now) - {numbers[name]}:
                pair = min(numbers[name], other), max(numbers[name], other)
                changes.setdefault(pair, []).append((at, numbers[name], other in now))
            heard = now
    return sorted(span for pair, list_ in changes.items() for span in _spans(pair, sorted(list_), end))


def _neighbors(robot: Record, numbers: Mapping[str, int], where: str) -> list[tuple[float, set[int]]]:
    """Times and the robots that were neighbours from then on."""
    source = section(robot, "series", where)
    times, samples = source.get("time"), source.get("neighbors")
    if not times or not isinstance(samples, list):
        return []
    check_length(samples, times, f"{where}.series.neighbors")
    return [(at, {numbers[n] for n in names or () if n in numbers}) for at, names in zip(times, samples, strict=True)]


def _spans(pair: tuple[int, int], changes: Sequence[tuple[float, int, bool]], end: float) -> list[list]:
    """Spans of one pair from the moments at which one of the two gained or lost the other."""
    result: list[list] = []
    hearing: set[int] = set()
    begin = 0.0
    for at, robot, hears in [*changes, (end, -1, False)]:
        if hearing and at > begin:
            result.append([_round(begin, TIME_DIGITS), _round(at, TIME_DIGITS), *pair, len(hearing) == 2])
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


def end_of(record: Record) -> float:
    """The last moment that the record knows."""
    last = [optional_number(section(record, "outcome"), "time", "outcome") or 0.0]
    holders = {"team": section(record, "team")}
    holders.update({f"robots.{name}": robot for name, robot in section(record, "robots").items()})
    for where, holder in holders.items():
        times = series_of(holder, {}, where).get("time")
        if times:
            last.append(times[-1])
    return max(last)


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


def warnings(record: Record, end: float) -> list[dict]:
    """Warnings of the robots' programs as events of kind "warning", in the order of time."""
    numbers = {name: index for index, name in enumerate(section(record, "robots"))}
    result = []
    for index, note in enumerate(entries(record, "notes", "")):
        name, at = str(note.get("robot") or ""), _round(number(note, "at", f"notes[{index}]"), TIME_DIGITS)
        if note.get("warning") and name in numbers and at is not None and at <= end:
            text = f"{name}: {note.get('text') or ''}"
            result.append({"at": at, "robot": numbers[name], "kind": "warning", "text": text})
    return sorted(result, key=lambda event: event["at"])


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


def robots_of(record: Record) -> list[dict[str, Any]]:
    """Per robot: "name", "start" (world frame), "joined", "died", "finished" (times or None), "series", "goals" (world
    frame) and "auctions"."""
    result = []
    joins = section(section(record, "trial"), "joins", "trial")  # by number of the robot
    for index, (name, robot) in enumerate(section(record, "robots").items()):
        where = f"robots.{name}"
        if not isinstance(robot, Mapping):
            raise ReplayError(f'"{where}" is not an object: the record is damaged, run the trial again')
        start = start_pose(robot, where)
        result.append(
            {
                "name": name,
                "start": None if start is None else rounded(start, 4),
                "joined": _round(optional_number(joins, str(index), "trial.joins"), TIME_DIGITS),
                "died": _round(optional_number(robot, "died_at", where), TIME_DIGITS),
                "finished": _round(optional_number(robot, "finished_at", where), TIME_DIGITS),
                "series": robot_series(robot, where),
                "goals": goals(robot, start, where),
                "auctions": auctions(robot, where),
            }
        )
    return result
