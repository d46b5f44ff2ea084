"""What the robot tells of itself: its state in numbers, and what it knows of frontiers, to be drawn."""

from explorer.exploration import Exploration
from explorer.foreign import ForeignFrontiers
from explorer.perception import Perception
from explorer.status import Picture, Status
from explorer.verdicts import Verdicts


def picture_of(perception: Perception, verdicts: Verdicts, foreign: ForeignFrontiers) -> Picture:
    points = [(verdicts.of(f.number).visited, (f.x, f.y)) for f in perception.frontiers.ordered()]
    return Picture(
        own=tuple(place for visited, place in points if not visited),
        visited=tuple(place for visited, place in points if visited),
        others={robot: tuple(foreign.places(robot)) for robot in foreign.robots()},
        clusters={c.number: tuple((f.x, f.y) for f in c.members) for c in perception.clusters},
    )


def status_of(robot: str, mission: Exploration, perception: Perception, now: float) -> Status:
    goal = mission.driver.goal
    return Status(
        robot=robot,
        state=mission.state,
        text=mission.text,
        finished=mission.finished_at is not None,
        exploration_time=mission.exploration_time(now),
        goal=None if goal is None else goal.pose,
        frontiers=len(perception.frontiers.frontiers),
        clusters=len(perception.clusters),
        unreachable=mission.unreachable_count(),
        counters=mission.counters,
    )
