"""Tells when a robot last came nearer to where it goes."""

import math

from mr_robot.navigation.options import PROGRESS


class Nearing:
    def __init__(self, since: float = -math.inf) -> None:
        """`since`: s, what counts until the first way is seen."""
        self.least = math.inf  # m, way left, when that last became less by what counts as progress
        self.at = since  # s, when that was

    def see(self, left: float, now: float) -> bool:
        """Once per step, with the way left, m. Whether it is less by `PROGRESS` than when it was so last."""
        nearer = left < self.least - PROGRESS
        if nearer:
            self.least, self.at = left, now
        return nearer
