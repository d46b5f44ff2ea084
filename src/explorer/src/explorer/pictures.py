"""What the robot knows of frontiers, to be drawn."""

from explorer.foreign import ForeignFrontiers
from explorer.perception import Perception
from explorer.status import Picture
from explorer.verdicts import Verdicts


def picture_of(perception: Perception, verdicts: Verdicts, foreign: ForeignFrontiers) -> Picture:
    points = [(verdicts.of(f.number).visited, (f.x, f.y)) for f in perception.frontiers.ordered()]
    return Picture(
        own=tuple(place for visited, place in points if not visited),
        visited=tuple(place for visited, place in points if visited),
        others={robot: tuple(foreign.places(robot)) for robot in foreign.robots()},
        clusters={c.number: tuple((f.x, f.y) for f in c.members) for c in perception.clusters},
    )
