"""What one trial is: everything that its record depends on."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Any, Mapping

from explorer.options import STRATEGIES
from explorer.strategies.outside import VARIABLE
from mr_experiments.trial.radio_options import RadioOptions
from mr_grid import Pose
from mr_sim.world import BIAS, ODOMETRY_MODELS
from mr_sim.worlds import WorldNotFoundError, label_of

DISTRIBUTED, CENTRALIZED = TOPOLOGIES = ("distributed", "centralized")


class TrialError(ValueError):
    """A trial that cannot be run as asked."""


def known_strategies() -> str:
    return f"{', '.join(map(str, STRATEGIES))}, and those that {VARIABLE}=FILE.py:Class names"


@dataclass(frozen=True)
class Trial:
    """One mission. Equal trials give equal records, bit for bit."""

    world: str  # name or file
    robots: int
    seed: int
    scenario: str = "paper"
    strategy: int = 7
    limit: float = 1800.0  # s from the start of the mission
    fast: bool = False  # perfect local maps, merging and radio
    radio: RadioOptions = field(default_factory=RadioOptions)
    known_poses: bool = False  # the robots are told each other's start poses
    starts: tuple[Pose, ...] = ()  # instead of the world file's, world frame
    joins: Mapping[int, float] = field(default_factory=dict)  # robot -> s after the start of the others
    deaths: Mapping[int, float] = field(default_factory=dict)  # robot -> s after the start
    topology: str = DISTRIBUTED
    partition: tuple[float, float] | None = None  # from, to: s after the start; halves do not hear each other meanwhile
    base: tuple[float, float] | None = None  # where the base of a centralized team stands, m, world frame
    odometry: str = BIAS  # how it errs, one of ODOMETRY_MODELS

    def __post_init__(self) -> None:
        try:
            label_of(self.world)
        except WorldNotFoundError as error:
            raise TrialError(str(error)) from None
        if self.robots < 1:
            raise TrialError(f"a team has at least one robot, not {self.robots}")
        if self.strategy not in STRATEGIES:
            raise TrialError(f"strategy {self.strategy} is unknown; there are {known_strategies()}")
        if self.odometry not in ODOMETRY_MODELS:
            raise TrialError(f"odometry {self.odometry!r} is unknown; there are {', '.join(ODOMETRY_MODELS)}")
        self._check_topology()
        self._check_partition()
        if not (math.isfinite(self.limit) and self.limit > 0.0):
            raise TrialError(f"the limit of a mission must be a positive number of seconds, not {self.limit!r}")
        for what, robots in (("joins", self.joins), ("deaths", self.deaths)):
            for robot in robots:
                if not 0 <= robot < self.robots:
                    raise TrialError(f"{what}: there is no robot {robot} in a team of {self.robots}")

        for robot in self.joins.keys() & self.deaths.keys():
            if self.joins[robot] >= self.deaths[robot]:
                raise TrialError(f"robot {robot} would die before it joins")

    def _check_topology(self) -> None:
        if self.topology not in TOPOLOGIES:
            raise TrialError(f"topology {self.topology!r} is unknown; there are {', '.join(TOPOLOGIES)}")
        if (self.topology == CENTRALIZED) != (self.base is not None):
            raise TrialError("a base is given if, and only if, topology is centralized")
        if self.topology == CENTRALIZED and self.fast:
            raise TrialError("perfect maps (fast) need no base: topology must be distributed")

    def _check_partition(self) -> None:
        if self.partition is None:
            return
        begin, end = self.partition
        if not 0.0 <= begin < end < math.inf:
            raise TrialError(f"a partition lasts from a time to a later one, not from {begin:g} s to {end:g} s")
        if self.fast or self.radio.wall_attenuation > 0.0:
            raise TrialError("a partition needs a radio, one that walls do not weaken: no fast, no wall_attenuation")

    @property
    def key(self) -> str:
        """Names the trial among others, fit for a file name."""
        return f"{label_of(self.world)}-r{self.robots}-{self.scenario}-{self.strategy}-s{self.seed}"

    def to_json(self) -> dict[str, Any]:
        """Plain values; an infinite radio range becomes None."""
        values = asdict(self)
        if math.isinf(self.radio.range):
            values["radio"]["range"] = None
        for name in ("joins", "deaths"):
            values[name] = {str(robot): time for robot, time in values[name].items()}
        if self.partition is None:
            del values["partition"]  # as in records that are older than partitions, so that their runs go on
        else:
            values["partition"] = list(self.partition)
        if self.odometry == BIAS:
            del values["odometry"]  # as in records that are older than the other model
        values["base"] = None if self.base is None else list(self.base)
        values["starts"] = [list(start) for start in self.starts]
        return values
