"""Logs that SLAM is judged by: scans and odometry of missions of one robot, of several kinds."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mr_experiments.common.bounded import Bounds, NoResult, Result, bounded
from mr_experiments.host.mission import Mission
from mr_experiments.host.parameters import Member, slam_options
from mr_experiments.trial.scenario import load_scenario
from mr_experiments.trial.trial import Trial
from mr_experiments.trial.trial_world import platforms_of, world_of
from mr_grid import Pose
from mr_measures.truth import Truth
from mr_robot.slam.engine import Slam
from mr_sim.scan_log import ScanLog, with_random_walk
from mr_sim.true_world import true_world_of
from mr_sim.worlds import label_of

STRATEGY = 7
LIMIT = 900.0  # s of a mission
FIRST_SEED = 73001
MISSION_TIME = 1800.0  # s of processor time, at most, to record one
LOG_TIME = (60.0, 0.2)  # s of processor time, at most, for a log and for each of its scans: fifty times the bar
MOST_MEMORY = min(4 << 30, os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // 2)  # octets, of one log


@dataclass(frozen=True)
class Kind:
    """`logs`: of which the table is made. `walls`: bars of wrong walls in %, mean and worst. `world`: from a seed;
    empty is the scenario's own. `odometry_error`: standard deviations of a random walk after 1 m and 1 rad, the bounds
    of Stage's bias in the worlds. `loops`: judged also where its loops end, with the random walk alone, whose errors
    grow with the way. `found`: bar of the share, %, of robots that find themselves when they are carried away, 0 where
    places look alike and staying lost is right; None: they are not carried."""

    logs: int
    walls: tuple[float, float]
    world: str = ""
    scenario: str = "paper"
    odometry_error: tuple[float, float] = (0.03, 0.05)
    loops: bool = False
    found: float | None = None


KINDS = {
    "pioneers": Kind(20, (0.5, 3.0), found=80.0),
    "turtlebots": Kind(20, (3.0, 8.0), scenario="turtlebot", odometry_error=(0.03, 0.01)),
    "halls": Kind(10, (5.0, 5.0), "generated:hall:{}:48x20"),
    "loops": Kind(10, (5.0, 5.0), "generated:loop:{}:45x40"),
    "equal rooms": Kind(10, (0.5, 3.0), "equalrooms26x15", found=0.0),
    # Slanted walls among square ones, and far ends where the least turn shows.
    "large floor": Kind(6, (0.5, 3.0), "large60x60"),
    "large loops": Kind(12, (0.5, 3.0), "generated:loop:{}:60x60", loops=True),
}
"""How many logs there are of each is settled here, before any of them is seen: a row over as many as it takes to pass
says nothing."""


@dataclass(frozen=True)
class Drive:
    """One log, called as its file, with odometry as it was recorded, and with one whose errors wander."""

    name: str
    biased: ScanLog
    walking: ScanLog


def drives(kind: Kind, first_seed: int, most: int | None, folder: Path) -> tuple[list[Drive], list[str]]:
    """All of the kind, or the first ones; and those that could not be recorded, in words."""
    found, failed = [], []
    for trial in trials(kind, first_seed, most):
        try:
            log = recorded(trial, folder)
        except NoResult as error:
            failed.append(f"{name_of(trial)}, recorded: {error}")
        else:
            found.append(Drive(name_of(trial), log, with_random_walk(log, *kind.odometry_error, trial.seed)))
    return found, failed


def trials(kind: Kind, first_seed: int, most: int | None = None) -> list[Trial]:
    count = kind.logs if most is None else min(most, kind.logs)
    scenario = load_scenario(kind.scenario)
    return [
        scenario.trial(1, STRATEGY, seed, kind.world.format(seed)) for seed in range(first_seed, first_seed + count)
    ]


def recorded(trial: Trial, folder: Path) -> ScanLog:
    """The log of the trial's first robot, recorded unless it is there. Raises NoResult where its mission does not
    end."""
    path = folder / f"{name_of(trial)}.npz"
    if path.is_file():
        return ScanLog.load(path)
    folder.mkdir(parents=True, exist_ok=True)
    log = bounded(lambda: record(trial), Bounds(MISSION_TIME, MOST_MEMORY))
    log.save(path)
    return log


def name_of(trial: Trial) -> str:
    return f"{label_of(trial.world)}-s{trial.seed}"


def record(trial: Trial) -> ScanLog:
    """Runs the mission."""
    mission = Mission(trial)
    robot, rows = mission.robots[0], []
    handle = robot.on_scan

    def on_scan(ranges: np.ndarray, odometry: Pose) -> None:
        rows.append((mission.world.time, ranges.copy(), odometry, mission.world.pose(0)))
        handle(ranges, odometry)

    robot.on_scan = on_scan  # type: ignore[method-assign]
    mission.run(LIMIT)
    description = mission.world.robots[0]
    ranger = description.rangers[description.main_ranger]
    geometry = (ranger.angle_min, ranger.angle_increment, ranger.range_min, ranger.range_max, *ranger.mount)
    times, ranges, odometry, truth = (np.array(column) for column in zip(*rows))
    return ScanLog(trial.world, np.array(geometry), times, ranges.astype(np.float32), odometry, truth)


def within_bounds(log: ScanLog, task: Callable[[ScanLog], Result]) -> Result:
    """What the task returns for the log. Raises NoResult."""
    return bounded(lambda: task(log), Bounds(LOG_TIME[0] + LOG_TIME[1] * len(log.times), MOST_MEMORY))


def results_of(
    logs: Mapping[str, ScanLog], what: str, task: Callable[[ScanLog], Result], failed: list[str]
) -> Iterator[tuple[str, Result]]:
    """What the task returns for each of the logs by name, in a process of its own. `what`: that is done. `failed` gets
    the logs without a result, in words."""
    for name, log in logs.items():
        try:
            result = within_bounds(log, task)
        except NoResult as error:
            failed.append(f"{name}, {what}: {error}")
            print(f"FAILED {failed[-1]}", flush=True)
            continue
        yield name, result


def slam_of(log: ScanLog) -> Slam:
    """With the options that the robot of the log runs it with."""
    (platform,) = platforms_of(world_of(Trial(log.world, 1, 0)))
    return Slam(slam_options(Member(platform, (platform,))))


def truth_of(log: ScanLog) -> Truth:
    return Truth.of_world(true_world_of(world_of(Trial(log.world, 1, 0))))
