"""What was observed of the robots, each in its own frame: poses and tracks, and who was seen where."""

from mr_grid import OccupancyGrid, Pose

from .exchange import Exchange
from .graph.team import TeamGraph
from .map_sightings import MapSightings
from .meetings import Meetings
from .messages import Boot
from .options import Options
from .reference import Reference
from .sighting import LONGEST_MAP_LAG_S
from .whereabouts import Whereabouts


class Observations:
    """Owns what was observed. Maps are looked at for robots that are not placed yet."""

    def __init__(
        self, options: Options, boot: Boot, exchange: Exchange, reference: Reference, graph: TeamGraph
    ) -> None:
        """Reads the exchange, the reference and the graph anew each time."""
        self._exchange, self._reference, self._graph = exchange, reference, graph
        self._seen_version = reference.version
        self.whereabouts = Whereabouts()
        self.sightings = MapSightings()
        self.meetings = Meetings(options.robot_name, options.robot_size, boot)

    def on_own_pose(self, pose: Pose, now: float) -> None:
        """The own robot's pose in the own map frame."""
        self.whereabouts.on_own_pose(pose, now)
        self.meetings.on_own_pose(pose, now)

    def on_position(self, robot: str, pose: Pose, now: float) -> None:
        """A robot told its pose in its map frame."""
        self.whereabouts.on_position(robot, pose, now)
        self._look_for(robot, now)

    def look(self, now: float) -> None:
        """Looks for the other robots in the own map, if it has changed."""
        if self._reference.version == self._seen_version or self._reference.grid is None:
            return
        self._seen_version = self._reference.version
        self.meetings.on_map(self._reference.grid, now)
        self.sightings.on_map(self._reference.grid, now)
        for robot in self._exchange.robots():
            self._look_for(robot, now)

    def look_through(self, robot: str, grid: OccupancyGrid, version: int, now: float) -> None:
        """Looks for the own robot in another one's map."""
        if robot not in self._graph.placed():
            own_poses = self.whereabouts.own_poses(now, LONGEST_MAP_LAG_S)
            position = self.whereabouts.position(robot)
            self.sightings.look_through(robot, grid, version, position, own_poses, now)

    def forget(self, robot: str) -> None:
        """The robot's frame is a new one."""
        self.whereabouts.forget(robot)
        self.sightings.forget(robot)
        self.meetings.forget(robot)

    def forget_own(self) -> None:
        """The own frame is a new one."""
        self.sightings.forget_all()
        self.meetings.forget_own()

    def _look_for(self, robot: str, now: float) -> None:
        if robot not in self._graph.placed():
            base = self._reference.robot
            heard = None if base is None else self.whereabouts.position(base)
            viewer = self.whereabouts.own_pose if base is None else None if heard is None else heard.pose
            self.sightings.look_for(robot, self.whereabouts.position(robot), viewer, now)
