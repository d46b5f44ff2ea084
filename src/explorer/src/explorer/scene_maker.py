"""Puts together what the robot knows now."""

from typing import Dict, FrozenSet, Optional, Tuple

from explorer.claim import OwnClaim
from explorer.clusters import Cluster
from explorer.foreign import ForeignFrontiers
from explorer.perception import Perception
from explorer.recognition import Listed, listed
from explorer.scene import Scene
from explorer.senses import Senses
from explorer.team import Claim, Team
from explorer.verdicts import Ready, Verdicts


class SceneMaker:
    """Reads the owners of what is known; they must have perceived a map."""

    def __init__(
        self,
        name: str,
        senses: Senses,
        perception: Perception,
        verdicts: Verdicts,
        team: Team,
        foreign: ForeignFrontiers,
        claim: OwnClaim,
    ) -> None:
        self._name, self._senses, self._perception = name, senses, perception
        self._verdicts, self._team, self._foreign, self._claim = verdicts, team, foreign, claim
        self._known: Tuple[int, Dict[str, Claim]] = (-1, {})
        self._listed: Dict[str, Listed] = {}
        self._clusters: Tuple[Cluster, ...] = ()
        self._ready: Optional[Ready] = None
        self._scene: Optional[Scene] = None

    def scene(self, now: float) -> Scene:
        assert self._senses.pose is not None and self._perception.ways is not None
        clusters, home = self._perception.clusters, self._senses.home or self._senses.pose
        scene = Scene(
            now=now,
            pose=self._senses.pose,
            ways=self._perception.ways,
            clusters=clusters,
            ready=self._ready_in(clusters, now),
            awaits_map=self._verdicts.awaits_map(now),
            own=self._claim.number,
            positions=self._team.positions(now),
            competitors=tuple(self._team.competitors(now)),
            claims=self._placed(self._team.claims(now)),
            name=self._name,
            team=tuple(self._team.known()),
            start=(home.x, home.y),
        )
        if self._scene is not None:
            scene.take_over(self._scene)
        self._scene = scene
        return scene

    def _ready_in(self, clusters: Tuple[Cluster, ...], now: float) -> FrozenSet[int]:
        """Numbers of the points in sight of a reachable place that can be tried."""
        if self._ready is None or self._clusters is not clusters or not self._ready.holds(self._verdicts, now):
            self._clusters = clusters
            numbers = (number for cluster in clusters for number in cluster.views)
            self._ready = self._verdicts.ready(numbers, now)
        return self._ready.numbers

    def _placed(self, claims: Dict[str, Claim]) -> Dict[str, Listed]:
        """The claims as this robot sees them; computed anew when they or the points of other robots have changed."""
        known = (self._foreign.revision, claims)
        if known != self._known:
            self._known = known
            self._listed = {r: listed(claim.elements, self._foreign, self._name) for r, claim in claims.items()}
        return self._listed
