"""Which way a robot drives: where its sensor looks. One that sees what is behind it and nothing ahead would drive
blindly, so it is taken for a robot that stands the other way round."""

import math
from dataclasses import replace
from typing import Optional

from mr_grid import Pose
from mr_robot.navigation.command import Command
from mr_robot.navigation.options import Scan
from mr_robot.platforms.platform import looks_back


class Facing:
    """Decided with the first scan, for the sensor does not move on its robot."""

    def __init__(self) -> None:
        self._back: Optional[bool] = None
        self._other_way = Pose(0.0, 0.0, math.pi)

    def see(self, scan: Scan) -> None:
        if self._back is None:
            self._back = looks_back(scan.middle, 2.0 * scan.half_view)

    @property
    def yaw(self) -> float:
        """rad from the robot's heading to where it drives."""
        return self._other_way.yaw if self._back else 0.0

    def pose(self, pose: Pose) -> Pose:
        return pose.compose(self._other_way) if self._back else pose

    def scan(self, scan: Scan) -> Scan:
        if not self._back:
            return scan
        return replace(scan, points=-scan.points, mount=self._other_way.between(scan.mount))

    def command(self, command: Command) -> Command:
        """For the robot as it stands."""
        return replace(command, linear=-command.linear) if self._back else command
