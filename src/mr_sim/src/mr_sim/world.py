"""The world engine: truth about walls and robots, advanced step by step.

Pure: time moves only by `step`, randomness comes from the seed, nothing is read or written. The same seed and the same
commands at the same steps give the same bits.
"""

import functools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mr_grid import Pose
from mr_sim import _world
from mr_sim.raster import Grid, closed_plan, intensities_of, rasterise
from mr_sim.world_description import Obstacle, RobotDescription, WorldDescription

COMMAND_TIMEOUT = 0.5  # s of simulated time without a fresh command after which a robot stops

BIAS, RANDOM_WALK = ODOMETRY_MODELS = ("bias", "random_walk")
"""How odometry errs: by one share for the whole run, as in Stage, or anew at each step."""

NO_CONTACT, CONTACT_WITH_WALL, CONTACT_WITH_ROBOT = 0, 1, 2
_FAULTS = {CONTACT_WITH_WALL: "inside a wall", CONTACT_WITH_ROBOT: "inside another robot"}  # of a start pose


class WorldError(ValueError):
    """A world that cannot be simulated as asked."""


@dataclass(frozen=True)
class Scan:
    """One sweep: `ranges` float32 (samples,), metres, counter-clockwise from the ranger's `angle_min`. `intensities`,
    if the world tells them: as many, the `ranger_return` of what each beam meets, 0 where it meets nothing."""

    robot: int
    ranger: int
    ranges: np.ndarray
    intensities: np.ndarray | None = None


def _steps(interval: float, step: float) -> int:
    """Simulation steps between updates; as in Stage an update falls on the first step at or after its time."""
    return max(1, math.ceil(interval / step - 1e-6))


class World:
    """Robots of a world description in its walls.

    Args:
        description: from `world_model.load_world`.
        robots: how many of the robots take part, in file order; all when None. The others are absent.
        seed: of range noise and odometry error; each robot has streams of its own, so one more robot changes nothing
            for the others.
        odometry: one of ODOMETRY_MODELS. Under a random walk `odom_error` is the standard deviation, in m and rad, of
            what the odometry has erred after 1 m ahead, 1 m aside and 1 rad of turn; it grows with the square root.
        intensities: whether scans have them.
    """

    def __init__(
        self,
        description: WorldDescription,
        robots: int | None = None,
        seed: int = 0,
        command_timeout: float = COMMAND_TIMEOUT,
        odometry: str = BIAS,
        intensities: bool = False,
    ) -> None:
        if odometry not in ODOMETRY_MODELS:
            raise WorldError(f'odometry must be {" or ".join(ODOMETRY_MODELS)}, not "{odometry}"')
        count = len(description.robots) if robots is None else robots
        if count < 1 or count > len(description.robots):
            there = len(description.robots)
            asked = "" if robots is None else f"; asked for {count}"
            raise WorldError(
                f"{description.path} defines {there} robot{'s' * (there != 1)}{asked}: "
                "ask for others with --robots, give start poses or add position models to the world"
            )
        self.description = description
        self.robots: tuple[RobotDescription, ...] = description.robots[:count]
        self.names: tuple[str, ...] = tuple(robot.name for robot in self.robots)
        self.interval = description.interval
        self.odometry = odometry
        solid = tuple(obstacle for obstacle in description.obstacles if obstacle.solid)
        visible = tuple(obstacle for obstacle in description.obstacles if obstacle.visible)
        self.obstacles = _raster_of(solid, description.resolution)
        self.visible = _raster_of(visible, description.resolution)
        self.core = _world.World(
            _core_raster(self.obstacles),
            _core_raster(self.visible, intensities_of(visible, description.resolution) if intensities else None),
            description.interval,
        )
        self._intensities = intensities
        # Per robot: shares by which the way ahead, the way to the left and the turn count wrong in the whole run.
        self.odometry_bias: list[tuple[float, float, float]] = []
        for index, robot in enumerate(self.robots):
            self._add_robot(index, robot, seed, command_timeout)
        self._check_starts()
        self._scan_steps = [[_steps(r.update_interval, self.interval) for r in robot.rangers] for robot in self.robots]

    def _add_robot(self, index: int, robot: RobotDescription, seed: int, command_timeout: float) -> None:
        sequence = np.random.SeedSequence([seed, index])
        generator = np.random.Generator(np.random.PCG64(sequence))
        forward, aside, _, turn = robot.odom_error
        linear, angular = float(generator.uniform(-forward, forward)), float(generator.uniform(-turn, turn))
        noise_seed = int(generator.integers(0, 2**63))
        # Drawn last, so that robots that cannot drive aside have the streams they always had.
        lateral = float(generator.uniform(-aside, aside))
        walk_seed = int(generator.integers(0, 2**63))
        walks = self.odometry == RANDOM_WALK
        bias = (0.0, 0.0, 0.0) if walks else (linear, lateral, angular)
        self.odometry_bias.append((0.0, 0.0, 0.0) if robot.exact_localization else bias)
        omnidirectional = robot.lateral_bounds != (0.0, 0.0)
        walk = (forward, aside if omnidirectional else 0.0, turn) if walks else (0.0, 0.0, 0.0)
        self.core.add_robot(
            start=robot.start,
            footprint=robot.footprint,
            seen=robot.seen,
            intensities=robot.ranger_returns,
            linear_bounds=robot.linear_bounds,
            lateral_bounds=robot.lateral_bounds,
            angular_bounds=robot.angular_bounds,
            localization_origin=robot.localization_origin,
            exact_localization=robot.exact_localization,
            bias=bias,
            walk=walk,
            walk_seed=walk_seed,
            base_steps=_steps(robot.update_interval, self.interval),
            command_timeout=command_timeout,
            solid=robot.solid,
            noise_seed=noise_seed,
            rangers=[
                _world.Ranger(
                    r.mount, r.range_max, r.field_of_view, r.samples, r.noise_variance, r.noise_share, r.noise_bearing
                )
                for r in robot.rangers
            ],
        )

    def _check_starts(self) -> None:
        plan = _plan_of(self.description.obstacles)
        for index, robot in enumerate(self.robots):
            fault = _FAULTS.get(self.core.contact_at(index, robot.start), "")
            if plan is not None and not plan.spans(*robot.start[:2]):
                fault = "outside the walls"
            if fault:
                raise WorldError(
                    f"{self.description.path}: {robot.name} starts {fault} at "
                    f"({robot.start[0]:g}, {robot.start[1]:g}): move its pose{self._extent() if plan else ''}"
                )

    def _extent(self) -> str:
        (x, y), (rows, columns) = self.obstacles.origin, self.obstacles.cells.shape
        width, depth = columns * self.obstacles.resolution, rows * self.obstacles.resolution
        return (
            " to free floor (what a map does not know is wall); the walls go "
            f"from x {x:.2f} to {x + width:.2f} m and from y {y:.2f} to {y + depth:.2f} m"
        )

    @property
    def time(self) -> float:
        """Simulated seconds since the start."""
        return self.core.time

    @property
    def steps(self) -> int:
        return self.core.steps

    def next_deadline(self) -> float:
        """Simulated time of the next step."""
        return (self.core.steps + 1) * self.interval

    def index(self, name: str) -> int:
        """Place of a robot in `names`; raises WorldError for a robot that does not take part."""
        try:
            return self.names.index(name)
        except ValueError:
            raise WorldError(f'no robot "{name}" in this world; there are {", ".join(self.names)}') from None

    def command(self, robot: int, linear: float, angular: float, lateral: float = 0.0) -> None:
        """Velocity wanted from now on, m/s, rad/s and, for an omnidirectional drive, m/s to the left; takes effect with
        the robot's next base update.

        Raises ValueError unless all are finite.
        """
        self.core.command(robot, linear, lateral, angular)

    def reset_positions(self) -> None:
        """Put all robots back to their start poses. As in Stage their commands go on, and so does odometry, unless it
        is exact."""
        self.core.reset_positions()

    def step(self) -> None:
        """Advance by one interval."""
        self.core.step()

    def states(self) -> np.ndarray:
        """One record per robot: odometry_x/y/yaw, linear, lateral, angular, x/y/yaw, velocity_x/y/yaw, stalled, contact
        (see `RobotState` of the core)."""
        return self.core.states()

    def base_due(self, robot: int) -> bool:
        """Whether the present step is a base update of the robot."""
        return self.steps % _steps(self.robots[robot].update_interval, self.interval) == 0

    def due_scans(self) -> Iterator[Scan]:
        """Sweeps of the rangers whose update falls on the present step. Consumes noise: once per step."""
        for robot, intervals in enumerate(self._scan_steps):
            for ranger, interval in enumerate(intervals):
                if self.steps % interval == 0:
                    yield self._scan(robot, ranger)

    def _scan(self, robot: int, ranger: int) -> Scan:
        if self._intensities:
            return Scan(robot, ranger, *self.core.scan_with_intensities(robot, ranger))
        return Scan(robot, ranger, self.core.scan(robot, ranger))

    def pose(self, robot: int) -> Pose:
        """True pose in the world frame."""
        state = self.core.states()[robot]
        return Pose(float(state["x"]), float(state["y"]), float(state["yaw"]))


@functools.lru_cache(maxsize=4)
def _raster_of(obstacles: tuple[Obstacle, ...], resolution: float) -> Grid:
    """Read-only. Kept, because hundreds of missions are run in one world."""
    grid = rasterise(obstacles, resolution)
    grid.cells.flags.writeable = False
    return grid


@functools.lru_cache(maxsize=4)
def _plan_of(obstacles: tuple[Obstacle, ...]) -> Obstacle | None:
    return closed_plan(obstacles)


def _core_raster(grid: Grid, intensities: np.ndarray | None = None) -> _world.Raster:
    return _world.Raster(grid.cells, grid.resolution, grid.origin, intensities)
