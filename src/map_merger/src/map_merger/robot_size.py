"""How large the robots of a team are, and what follows for what lasers and maps show of them."""

from dataclasses import dataclass

LARGEST_PERSON_M = 0.9
"""That maps show of somebody who stands there, or of two who stand together."""


@dataclass(frozen=True)
class RobotSize:
    """body_radius: m, half the depth of a robot's body. largest_radius: m, from the centre of the largest robot of the
    team to its farthest corner."""

    body_radius: float
    largest_radius: float

    @property
    def inner(self) -> float:
        """Metres around the track of a robot, which may be off, that were under its body."""
        return 0.5 * self.body_radius

    @property
    def visible(self) -> float:
        """Metres from a robot's centre within which its visible sides are."""
        return self._reach(0.01)

    @property
    def touching(self) -> float:
        """Metres from a robot's centre that its body can reach, and hides from lasers."""
        return self._reach(0.06)

    @property
    def clearance(self) -> float:
        """Metres from a robot's centre to a wall from which on the two are told from one another."""
        return self._reach(0.11)

    @property
    def near(self) -> float:
        """Metres from a robot's centre within which an obstacle by itself is taken for the robot."""
        return self._reach(0.16)

    @property
    def widest(self) -> float:
        """Metres across that a laser sees of a robot at most."""
        return self._extent(0.07)

    @property
    def left(self) -> float:
        """Metres from a place from which on a robot has left it."""
        return self._extent(0.12)

    @property
    def largest(self) -> float:
        """Largest extent in metres of an obstacle that is taken for a robot."""
        return self._extent(0.22)

    @property
    def mover(self) -> float:
        """Metres across that an obstacle may have to be a robot or a person; what is larger belongs to the building."""
        return max(LARGEST_PERSON_M, self._extent(0.32))

    def _reach(self, more: float) -> float:
        return round(self.largest_radius + more, 3)

    def _extent(self, more: float) -> float:
        return round(2.0 * self.largest_radius + more, 3)


USUAL_SIZE = RobotSize(body_radius=0.2, largest_radius=0.29)
"""What the node takes where its parameters do not tell, and who reads maps of robots that nobody described."""
