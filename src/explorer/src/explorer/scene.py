"""What the robot knows at one moment: everything that a decision depends on, as one frozen value."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Dict, FrozenSet, List, Mapping, Optional, Tuple

from explorer.clusters import Cluster, View
from explorer.frontiers import Frontier
from explorer.geometry import Position
from explorer.recognition import Listed, Recognition
from explorer.ways import Ways
from mr_grid import Pose


@dataclass(frozen=True)
class Scene:
    """`clusters`: the own ones, as seen on the map of `ways`. `ready`: numbers of the frontier points that can be tried
    now. `own`: number of the cluster that this robot explores. Of the other robots: `positions` in metres in the own
    frame, `claims` on clusters, `competitors`, which may take one, and `team`, the names of all that are heard.
    `name`: the own one. `awaits_map`: what was looked at is not in the map yet. `start`: place of the robot when
    the mission began."""

    now: float
    pose: Pose
    ways: Ways
    clusters: Tuple[Cluster, ...]
    ready: FrozenSet[int]
    awaits_map: bool = False
    own: Optional[int] = None
    positions: Mapping[str, Position] = field(default_factory=dict)
    competitors: Tuple[str, ...] = ()
    claims: Mapping[str, Listed] = field(default_factory=dict)
    name: str = ""
    team: Tuple[str, ...] = ()
    start: Position = (0.0, 0.0)

    def take_over(self, former: "Scene") -> None:
        """What was computed for a former scene, where it depends on nothing that has changed since."""
        if former.clusters is not self.clusters:
            return
        kept = ["candidates", "views"]
        if former.ready == self.ready:
            kept += ["open", "frontiers"]
            if former.claims is self.claims:
                kept.append("claimed")
        self.__dict__.update({name: former.__dict__[name] for name in kept if name in former.__dict__})

    @property
    def place(self) -> Position:
        return (self.pose.x, self.pose.y)

    @cached_property
    def candidates(self) -> List[Cluster]:
        """Clusters with a frontier that can still be explored, now or later."""
        return [cluster for cluster in self.clusters if cluster.reachable]

    @cached_property
    def open(self) -> List[Cluster]:
        """Those with a frontier that can be tried now."""
        return [cluster for cluster in self.candidates if not self.ready.isdisjoint(cluster.views)]

    @cached_property
    def frontiers(self) -> List[Frontier]:
        """Frontier points that can be tried now, by number."""
        members = [member for cluster in self.open for member in cluster.members if member.number in self.ready]
        return sorted(members, key=lambda member: member.number)

    @cached_property
    def views(self) -> Dict[int, View]:
        """{number: view} of all frontier points that are in sight of a reachable place."""
        return {number: view for cluster in self.clusters for number, view in cluster.views.items()}

    @cached_property
    def claimed(self) -> Dict[int, str]:
        """{cluster number: robot} of the open clusters that other robots have claimed."""
        result: Dict[int, str] = {}
        recognition = Recognition(self.open)
        for robot, claim in self.claims.items():
            cluster = recognition.match(claim)
            if cluster is not None:
                result.setdefault(cluster.number, robot)
        return result

    def cluster(self, number: Optional[int]) -> Optional[Cluster]:
        return next((cluster for cluster in self.clusters if cluster.number == number), None)

    @property
    def current(self) -> Optional[Cluster]:
        """The cluster that this robot explores, if it is open."""
        return next((cluster for cluster in self.open if cluster.number == self.own), None)
