"""How a robot drives towards a point: within the speeds and accelerations of its drive, as navigation drives it."""

from __future__ import annotations

import math

from mr_robot.navigation.options import NavigationOptions


class Wheels:
    """Owns the velocity of one robot."""

    def __init__(self, options: NavigationOptions) -> None:
        self._options = options
        self.velocity = (0.0, 0.0)  # m/s, rad/s

    def towards(self, off: float, seconds: float) -> None:
        """Towards a point `off` rad off the robot's heading: it turns while it drives, and drives no way back."""
        self._approach(self._options.max_linear_velocity * max(0.0, math.cos(off)), self._rate(off, seconds), seconds)

    def turn(self, off: float, seconds: float, most: float = math.inf) -> None:
        """On the spot, by `off` rad, at `most` rad/s."""
        self._approach(0.0, max(-most, min(most, self._rate(off, seconds))), seconds)

    def brake(self, seconds: float) -> None:
        self._approach(0.0, 0.0, seconds)

    def _rate(self, off: float, seconds: float) -> float:
        """rad/s that come to rest when the turn is made."""
        options = self._options
        stoppable = math.sqrt(2.0 * options.angular_acceleration * abs(off))
        return math.copysign(min(options.max_angular_velocity, abs(off) / seconds, stoppable), off)

    def _approach(self, linear: float, angular: float, seconds: float) -> None:
        options = self._options
        self.velocity = (
            _approached(self.velocity[0], linear, options.linear_acceleration * seconds),
            _approached(self.velocity[1], angular, options.angular_acceleration * seconds),
        )


def _approached(value: float, target: float, change: float) -> float:
    return value + min(max(target - value, -change), change)
