"""Puts together what the robot knows now."""

from typing import Dict, List, Optional, Tuple

from explorer.claim import OwnClaim
from explorer.clusters import Cluster
from explorer.foreign import ForeignFrontiers
from explorer.perception import Perception
from explorer.recognition import Listed, listed
from explorer.scene import Scene
from explorer.senses import Senses
from explorer.team import Claim, Team
from explorer.verdicts import Verdicts


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
        self._seen: List[int] = []
        self._scene: Optional[Scene] = None

    def scene(self, now: float) -> Scene:
        assert self._senses.pose is not None and self._perception.ways is not None
        clusters, home = self._perception.clusters, self._senses.home or self._senses.pose
        scene = Scene(
            now=now,
            pose=self._senses.pose,
            ways=self._perception.ways,
            clusters=clusters,
            ready=frozenset(self._verdicts.ready(self._seen_in(clusters), now)),
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

    def _seen_in(self, clusters: Tuple[Cluster, ...]) -> List[int]:
        """Numbers of the points in sight of a reachable place."""
        if self._clusters is not clusters:
            self._clusters = clusters
            self._seen = [number for cluster in clusters for number in cluster.views]
        return self._seen

    def _placed(self, claims: Dict[str, Claim]) -> Dict[str, Listed]:
        """The claims as this robot sees them; computed anew when they or the points of other robots have changed."""
        known = (self._foreign.revision, claims)
        if known != self._known:
            self._known = known
            self._listed = {r: listed(claim.elements, self._foreign, self._name) for r, claim in claims.items()}
        return self._listed
