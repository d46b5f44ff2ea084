"""What the host, services and people ask about the team."""

from typing import Dict, Optional, Tuple

from mr_grid import FARTHEST, OccupancyGrid, Pose

from .believed import BelievedTransforms
from .driving import driving
from .exchange import Exchange
from .graph.team import Placement
from .hearing import Hearing
from .markers import RobotMarker, marker_of, outline_of
from .merged_map import MergedMap
from .options import Options
from .reference import Reference
from .registrar import Registrar
from .report import LogFigures, figures_of, placement_of
from .sighting import nowhere
from .status import MergerStatus, RobotPlacement
from .topology import topology_of
from .whereabouts import Whereabouts

MEETING_WANTED_S = 60.0
"""A robot that was in hearing for so long without being placed should be met."""


class NoTransform(LookupError):
    """A point cannot be transformed; the text says why."""


class TeamView:
    """Answers from what the owners of state hold now; changes nothing."""

    def __init__(
        self,
        options: Options,
        exchange: Exchange,
        reference: Reference,
        whereabouts: Whereabouts,
        registrar: Registrar,
        believed: BelievedTransforms,
        merged: MergedMap,
        hearing: Hearing,
    ) -> None:
        self._options, self._topology = options, topology_of(options)
        self._exchange, self._reference, self._whereabouts = exchange, reference, whereabouts
        self._registrar, self._believed = registrar, believed
        self._merged, self._hearing = merged, hearing

    @property
    def local_map(self) -> Optional[OccupancyGrid]:
        """The local map, on a base station that of the adopted robot."""
        return self._reference.grid

    @property
    def global_map(self) -> Optional[OccupancyGrid]:
        """The global map as published last."""
        return self._merged.grid

    def placements(self) -> Dict[str, Placement]:
        """Where the frames of the other robots lie in the own one, as far as that is believed."""
        return self._believed.placements()

    def transforms(self) -> Dict[str, Pose]:
        """Believed transforms of the others' map frames to the own one."""
        return self._believed.transforms()

    def verdict(self, robot: str) -> str:
        """Why there is (no) transform to the robot."""
        if robot not in self._exchange.robots():
            return "robot not known"
        return self._placement(robot, 0.0).why

    def transform_point(self, robot: str, x: float, y: float) -> Tuple[float, float]:
        """A point of the robot's map frame in the own one, metres. NoTransform while the transform is not known."""
        if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST):
            raise NoTransform(f"point ({x:g}, {y:g}) is not finite or farther than {FARTHEST:g} m away")
        if robot == self._options.robot_name:
            return x, y
        if robot not in self._exchange.robots():
            raise NoTransform(f"no transform to {robot or 'the empty name'}: this robot is not known")
        placement = self.placements().get(robot)
        if placement is None:
            raise NoTransform(f"no transform to {robot} yet: {self.verdict(robot)}")
        return placement.transform.apply_point(x, y)

    def log_figures(self) -> LogFigures:
        """Figures for the log."""
        pose, transforms = self._whereabouts.own_pose, len(self.transforms())
        return figures_of(self.global_map, self.local_map, pose, self._exchange.updates, transforms)

    def status(self, now: float) -> MergerStatus:
        """Who is placed, and why the others are not."""
        robots = tuple(
            self._placement(robot, now) for robot in self._exchange.robots() if robot != self._reference.robot
        )
        placed = self.placements()
        missed = tuple(
            robot
            for robot in driving(self._topology, self._exchange, self._whereabouts)
            if robot not in placed and self._hearing.known_for(robot, now) >= MEETING_WANTED_S
        )
        options = self._options
        return MergerStatus(options.robot_name, options.topology, options.base_station, robots, missed, self._awaited())

    def _awaited(self) -> str:
        if self._reference.grid is not None:
            return ""
        if self._options.has_local_map:
            return f"the robot's own map on {self._options.local_map_topic}"
        return "the first map of a robot"

    def markers(self) -> Tuple[RobotMarker, ...]:
        """The placed robots and the outlines of their maps, for people; takes some milliseconds."""
        places = [(self._options.robot_name, Pose(), self._whereabouts.own_pose, self._reference.grid)]
        for robot, transform in self.transforms().items():
            heard = self._whereabouts.position(robot)
            pose = None if heard is None else heard.pose
            places.append((robot, transform, pose, self._exchange.map_of(robot)))
        return tuple(
            marker_of(robot, pose, nowhere() if grid is None else outline_of(grid), transform)
            for robot, transform, pose, grid in places
        )

    def _placement(self, robot: str, now: float) -> RobotPlacement:
        return placement_of(
            robot,
            self.placements().get(robot),
            self._registrar.alignment(robot),
            self._why_not_placed(robot),
            self._hearing.age(robot, now),
            self._hearing.octets(robot),
        )

    def _why_not_placed(self, robot: str) -> str:
        base = self._topology.relies_on
        if base is None:
            return self._registrar.why(robot)
        return self._topology.why_not_placed(robot, self._exchange.present(base), base in self.placements())
