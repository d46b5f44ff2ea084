"""The own frame of a base station is that of a robot whose map it has adopted."""

from typing import List

from .believed import BelievedTransforms
from .effects import Effect, Note
from .exchange import Exchange
from .merged_map import MergedMap
from .messages import Boot, run_after
from .observations import Observations
from .own_transforms import OwnTransforms
from .reference import Reference
from .topology import Topology


class BaseFrame:
    """Owns which frame that is, and the runs that it names."""

    def __init__(
        self,
        topology: Topology,
        boot: Boot,
        exchange: Exchange,
        reference: Reference,
        observations: Observations,
        own_transforms: OwnTransforms,
        believed: BelievedTransforms,
        merged: MergedMap,
    ) -> None:
        """`boot` names the run of the station. All but the believed transforms begin anew with another frame."""
        self._is_base, self._boot = topology.is_base, boot
        self._exchange, self._reference, self._observations = exchange, reference, observations
        self._own_transforms, self._believed, self._merged = own_transforms, believed, merged
        self._frame = reference.frame

    def follow(self, now: float) -> List[Effect]:
        """Takes the robot's present map for the own one."""
        notes = self._reference.follow(self._exchange, len(self._believed.transforms()) > 1, now)
        effects: List[Effect] = [Note(text) for text in notes]
        if self._reference.frame != self._frame:
            self._frame = self._reference.frame
            effects += self._begin()
        self._observations.look(now)
        return effects

    def _begin(self) -> List[Effect]:
        self._merged.forget()
        self._observations.forget_own()
        if self._is_base:
            boot = run_after(self._boot, self._frame)
            self._exchange.begin_run(boot)
            self._own_transforms.begin_run(boot)
        for robot in self._exchange.robots():
            self._own_transforms.forget(robot)
        return self._own_transforms.renew()
