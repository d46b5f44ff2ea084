"""When nothing is left to explore."""

import math
from typing import Dict, List, Optional, Tuple

from explorer.claim import OwnClaim
from explorer.clusters import Cluster
from explorer.driver import Driver
from explorer.geometry import distance
from explorer.messages import Emit, Note
from explorer.perception import Perception
from explorer.scene import Scene
from explorer.statement import Decided, Kind
from explorer.verdicts import Verdicts
from mr_grid import Pose

WORTH_A_LOOK = 4  # frontier points without a viewpoint that are worth a closer look before the end
CLOSER_LOOKS = 20  # such looks in a mission
LOOKS_AT_A_SPOT = 2  # of all robots
TEAM_PATIENCE = 30.0  # s that a robot with nothing left stays in the mission for others that explore
LOOK_DISTANCE = 1.0  # m, a look of another robot this near is one at the same spot


class Ending:
    """Never ends on one empty list: nothing must be left for `delay` seconds, on maps younger than the last motion,
    after last tries and closer looks."""

    def __init__(
        self, delay: float, perception: Perception, verdicts: Verdicts, driver: Driver, claim: OwnClaim, emit: Emit
    ) -> None:
        self._delay = delay
        self._perception, self._verdicts, self._driver, self._claim = perception, verdicts, driver, claim
        self._emit = emit
        self._empty_since: Optional[float] = None
        self.closer_looks: Dict[Tuple[int, int], int] = {}  # {place in whole metres: looks}

    @property
    def nothing_left(self) -> bool:
        """Nothing was left when it was last asked for."""
        return self._empty_since is not None

    def looked(self) -> Tuple[Decided, ...]:
        """The closer looks, as the others are told; the place is that of the frontiers."""
        return tuple(
            Decided(float(x), float(y), Kind.LOOKED, 0.0)
            for (x, y), looks in self.closer_looks.items()
            for _ in range(looks)
        )

    def look_again(self) -> None:
        """Something has been done that may bring new frontiers."""
        self._empty_since = None

    def reached(self, scene: Scene, fresh: bool) -> bool:
        """True if this is the end. `fresh`: the maps are younger than the last motion."""
        field = self._perception.field
        assert field is not None
        # What a robot in reach says that it has explored need not be waited for: it says, too, what it leaves.
        awaited = not self._verdicts.heard.vouched(self._perception.worth.told)
        if scene.candidates or awaited or not field.reachable.any():
            self._empty_since = None
            return False
        if self._driver.goal is not None and self._driver.goal.frontier is None:
            # On the way to a closer look.
            return False
        if self._empty_since is None:
            self._empty_since = scene.now
            self._driver.drop()
            self._claim.release()
        if scene.now - self._empty_since < self._delay or not fresh:
            return False
        return not (self._try_given_up_again() or self._look_closer(scene) or self._may_be_needed(scene.now))

    def _may_be_needed(self, now: float) -> bool:
        """Others still explore: what they find is shared out while this robot is there. It does not wait for long."""
        assert self._empty_since is not None
        return bool(self._verdicts.heard.explorers) and now - self._empty_since < TEAM_PATIENCE

    def _try_given_up_again(self) -> bool:
        again = self._verdicts.revive_once()
        if again:
            self._perception.touch()
        return again

    def _look_closer(self, scene: Scene) -> bool:
        """The robot goes as near as it can to frontiers that no reachable place sees, and faces them: what blocks the
        way may be the trace of a robot that has left. True if it is on its way."""
        for cluster in self._hopeless(scene):
            spot = (round(cluster.centre[0]), round(cluster.centre[1]))
            tries = self.closer_looks.get(spot, 0)
            others = self._verdicts.heard.looks_near(*spot, LOOK_DISTANCE)
            if tries + others >= LOOKS_AT_A_SPOT or sum(self.closer_looks.values()) >= CLOSER_LOOKS:
                continue
            self.closer_looks[spot] = tries + 1
            self._emit(Note(f"takes a closer look at unreachable frontiers near ({spot[0]}, {spot[1]})"))
            place = self._place_to_look(cluster, tries)
            self._driver.send(place, scene.pose, scene.now, self._perception.way(scene.pose, place))
            return True
        return False

    def _hopeless(self, scene: Scene) -> List[Cluster]:
        """Clusters that no reachable place sees, nearest first."""
        hopeless = [
            cluster
            for cluster in scene.clusters
            if not cluster.reachable and len(cluster.numbers & self._perception.worth.goals.keys()) >= WORTH_A_LOOK
        ]
        return sorted(hopeless, key=lambda cluster: (distance(scene.place, cluster.centre), cluster.number))

    def _place_to_look(self, cluster: Cluster, tries: int) -> Pose:
        assert self._perception.field is not None
        x, y = self._perception.field.nearest_place(*cluster.centre)
        # A turn shows the laser, and with it the map, what is there now; the second look turns further.
        yaw = math.atan2(cluster.centre[1] - y, cluster.centre[0] - x) + (1.0 if tries else 0.0)
        return Pose(x, y, yaw)
