"""What was recorded of a mission: the bags of each robot, and what the team runner knew of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Callable

from mr_launch.errors import UserError
from mr_launch.plan import PLAN_FILE, Plan, bag_name
from mr_launch.recordings.bags import decoded, messages, opened, topic_of
from mr_launch.recordings.drivers import topics_of_kind

WHAT_IS_FOUND = (
    "output folder of the team runner; of a real robot its folder of bags or one bag; a folder with several of these"
)
ROBOTS_OWN = "topics_"  # with what robot.launch begins the names of its bags
MAP = "map"  # of a robot's own SLAM
MERGER = "map_merger/status"  # says the name of its robot


@dataclass(frozen=True)
class RecordedRobot:
    name: str
    bags: tuple[Path, ...]


@dataclass(frozen=True)
class Recording:
    """`plan`: of a mission of the team runner; None for real robots. `missing`: its robots without a bag; `silent`:
    those whose bags hold no message; `bodiless`: base stations, where these are left out."""

    folder: Path
    robots: tuple[RecordedRobot, ...]
    plan: Plan | None = None
    missing: tuple[str, ...] = ()
    silent: tuple[str, ...] = ()
    bodiless: tuple[str, ...] = ()

    @property
    def notes(self) -> list[str]:
        """What people should know of the robots that are left out."""
        missing = [f"there is no bag of {name}; the others go without" for name in self.missing]
        silent = [f"the bags of {name} hold no message; the others go without" for name in self.silent]
        return missing + silent + [f"{name} has no body; it is not played" for name in self.bodiless]


def find_recording(path: Path) -> Recording:
    """A mission folder of the team runner, the folder or a bag of a real robot, or a folder with several of such
    folders. Raises UserError."""
    try:
        return _found(path.resolve())
    except OSError as error:
        raise UserError(f"{error.filename or path} cannot be read: {error.strerror}") from None


def _found(path: Path) -> Recording:
    if path.is_file():
        return Recording(path.parent, _recorded([[path]]))
    if not path.is_dir():
        raise UserError(f"{path} does not exist")
    if (path / PLAN_FILE).is_file():
        return _of_team(path)
    own = _bags(path)
    folders = [path] if own else [folder for folder in sorted(path.iterdir()) if folder.is_dir() and _bags(folder)]
    robots = _recorded([_bags(folder) for folder in folders])
    if not robots:
        raise UserError(f"no bags in {path}: missions with --no-bag and robots without record:=true have none")
    names = [robot.name for robot in robots]
    doubles = sorted({name for name in names if names.count(name) > 1})
    if doubles:
        raise UserError(f"{path} has more than one robot {doubles[0]}; a folder is called as its robot")
    return Recording(path, robots)


def with_messages(recording: Recording) -> Recording:
    """Without the robots whose bags hold no message. Raises UserError if none is left."""
    heard, silent = _parted(recording, _has_messages, f"no message in any bag of {recording.folder}")
    return replace(recording, robots=heard, silent=silent)


def _has_messages(robot: RecordedRobot) -> bool:
    with opened(robot.bags) as reader:
        return bool(reader.message_count)


def with_bodies(recording: Recording) -> Recording:
    """Without base stations, whose bags have neither scans nor a map of their own. Raises UserError if none is left."""
    none = f"no scans and no own map in any bag of {recording.folder}; base stations are not played"
    there, bodiless = _parted(recording, _has_body, none)
    return replace(recording, robots=there, bodiless=bodiless)


def _parted(
    recording: Recording, is_played: Callable[[RecordedRobot], bool], none: str
) -> tuple[tuple[RecordedRobot, ...], tuple[str, ...]]:
    """The robots to be played, and the names of the others. Raises UserError(`none`) if there are none to be played."""
    played = tuple(robot for robot in recording.robots if is_played(robot))
    if not played:
        raise UserError(none)
    return played, tuple(robot.name for robot in recording.robots if robot not in played)


def _has_body(robot: RecordedRobot) -> bool:
    with opened(robot.bags) as reader:
        own_map = any(topic_of(connection) == MAP for connection in reader.connections)
        return own_map or bool(topics_of_kind(reader.connections, "scan"))


def _of_team(folder: Path) -> Recording:
    try:
        plan = Plan.from_json((folder / PLAN_FILE).read_text(encoding="utf-8"))
    except (ValueError, KeyError, TypeError) as error:
        raise UserError(f"{folder / PLAN_FILE} is of another version or damaged: {error}") from None
    plan = replace(plan, out=str(folder))  # it may have been moved
    found = {robot.name: _first_bags(folder / robot.name) for robot in plan.robots}
    robots = tuple(RecordedRobot(name, bags) for name, bags in found.items() if bags)
    if not robots:
        raise UserError(f"no bags in {folder}: the mission has --no-bag, or has not begun")
    return Recording(folder, robots, plan, tuple(name for name, bags in found.items() if not bags))


def _first_bags(folder: Path) -> tuple[Path, ...]:
    """Without those of a robot that was started again, which has another map frame and start."""
    return tuple(path for path in _bags(folder) if path.name.startswith(bag_name(folder.name)))


def _bags(folder: Path) -> list[Path]:
    """Also those that a recorder left open, which the reader refuses with a remedy; not what `rosbag reindex` kept."""
    found = (path for path in folder.glob("*.bag*") if path.suffix in (".bag", ".active"))
    return sorted(path for path in found if not path.stem.endswith(".orig"))


def _recorded(all_bags: list[list[Path]]) -> tuple[RecordedRobot, ...]:
    """Those of one robot and another: called as they called themselves, or by their folders where two say the same."""
    own = [_own_name(bags) for bags in all_bags]
    names = [name if name and own.count(name) == 1 else _name_of(bags) for name, bags in zip(own, all_bags)]
    return tuple(RecordedRobot(name, tuple(bags)) for name, bags in zip(names, all_bags))


def _own_name(bags: list[Path]) -> str:
    """As the robot called itself, empty if the bags do not tell. Without robot_name:= all folders are called robot."""
    with opened(bags) as reader:
        told = [connection for connection in reader.connections if topic_of(connection) == MERGER]
        for connection, _, octets in messages(reader, told):
            message = decoded(reader, connection, octets)
            if message is not None:
                return str(getattr(message, "robot", ""))
    return ""


def _name_of(bags: list[Path]) -> str:
    first = bags[0]
    name = first.name.split(".")[0]
    return first.parent.name if name.startswith(ROBOTS_OWN) or len(bags) > 1 else name
