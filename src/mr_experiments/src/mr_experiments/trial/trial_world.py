"""The simulated world of a trial."""

from __future__ import annotations

import functools

from mr_experiments.trial.trial import Trial, TrialError
from mr_robot.platforms.platform import Platform, PlatformError
from mr_sim import worlds
from mr_sim.simulated_platform import platform_of
from mr_sim.world import World, WorldError
from mr_sim.world_description import RobotDescription, WorldDescription
from mr_sim.world_file import WorldFileError
from mr_sim.world_model import load_world
from mr_sim.worlds import WorldNotFoundError, find_world


@functools.lru_cache(maxsize=8)
def description_of(world: str) -> WorldDescription:
    """Raises TrialError for a world that is not there or cannot be read."""
    try:
        return load_world(find_world(world))
    except (WorldNotFoundError, WorldFileError, OSError) as error:
        raise TrialError(str(error)) from None


def warning_of(world: str) -> str:
    """One line on what the world says without effect, empty if there is nothing. Raises TrialError."""
    return worlds.warning_of(world, description_of(world))


def most_robots(trial: Trial) -> int:
    """How many robots the trial's world has a start for. Raises TrialError."""
    return len(trial.starts or description_of(trial.world).robots)


def world_of(trial: Trial) -> World:
    """The simulated world with the robots of the trial. Raises TrialError."""
    description = description_of(trial.world)
    if 0 < len(trial.starts) < trial.robots:
        raise TrialError(starts_fault("the scenario", len(trial.starts), trial.robots))
    try:
        if trial.starts:
            description = worlds.with_starts(description, trial.starts)
        world = World(description, trial.robots, trial.seed, odometry=trial.odometry)
    except (WorldError, worlds.StartsError) as error:
        raise TrialError(str(error)) from None
    platforms_of(world)
    return world


def starts_fault(who: str, starts: int, robots: int) -> str:
    """What to say of too few start poses."""
    return f"{who} gives {starts} start pose{'s' * (starts != 1)}; {robots} robots are asked for"


def platforms_of(world: World) -> tuple[Platform, ...]:
    """What each robot is, as its model says. Raises TrialError."""
    return tuple(_platform_of(robot, world.description.path.stem) for robot in world.robots)


def _platform_of(robot: RobotDescription, world: str) -> Platform:
    try:
        return platform_of(robot)
    except PlatformError as error:
        raise TrialError(f"{robot.name} of {world}: {error}") from None
