"""When the global map is drawn anew, and from what."""

from typing import Mapping, Optional, Set, Tuple

import numpy as np

from mr_grid import OccupancyGrid, Pose

from .exchange import Exchange
from .global_map import GlobalMap, Policy, Update
from .options import Options
from .reference import Reference
from .timer import Timer
from .topology import topology_of
from .whereabouts import Whereabouts

SHORTEST_PUBLISH_S = 1.0
"""New local maps are passed on at once, but not more often than this."""


class MergedMap:
    """Owns the global map and the periods in which it is renewed."""

    def __init__(self, options: Options) -> None:
        self._name, self._policy = options.robot_name, Policy(options.local_priority)
        self._topology = topology_of(options)
        self._foreign_timer = Timer(options.seconds_pub_timer, options.seconds_pub_timer)
        self._local_timer = Timer(SHORTEST_PUBLISH_S)
        self._size = options.robot_size
        self._map = GlobalMap(self._name, self._size, self._policy)
        self._drawn: Set[str] = set()
        self._placed: Set[str] = set()  # of whose ways obstacles are erased
        self._version = -1
        self._left_out: Set[str] = set()
        self.grid: Optional[OccupancyGrid] = None
        """The global map as it was drawn last."""

    def forget(self) -> None:
        """The own frame is a new one."""
        self._map = GlobalMap(self._name, self._size, self._policy)
        self._drawn, self._placed, self._version, self.grid = set(), set(), -1, None

    def step(
        self,
        reference: Reference,
        exchange: Exchange,
        transforms: Mapping[str, Pose],
        whereabouts: Whereabouts,
        now: float,
    ) -> Optional[Update]:
        """The global map if it is time and it changed. transforms: others' frames -> own frame."""
        if reference.grid is None:
            return None
        foreign_due = self._foreign_timer.fires(now)
        local_due = reference.version != self._version and self._local_timer.fires(now)
        if not (foreign_due or local_due):
            return None
        self._version = reference.version
        self._map.set_local(reference.grid)
        if foreign_due:
            others = {
                name: transform
                for name, transform in transforms.items()
                if name != reference.robot and self._topology.exchanges_maps_with(name)
            }
            self._draw(others, exchange)
            self._place(transforms, whereabouts)
        update = self._map.render()
        if update is not None:
            self.grid = update.grid
        return update

    def news(self) -> Tuple[str, ...]:
        """The robots whose maps are left out of the global map since the last call, because it would be too large."""
        left_out = set(self._map.left_out)
        news, self._left_out = left_out - self._left_out, left_out
        return tuple(sorted(news))

    def _draw(self, transforms: Mapping[str, Pose], exchange: Exchange) -> None:
        for name in sorted(self._drawn - transforms.keys()):
            self._map.remove_layer(name)
        self._drawn.intersection_update(transforms)
        for name, transform in transforms.items():
            grid = exchange.map_of(name)
            if grid is not None:
                version = (exchange.run_of(name), exchange.version_of(name))
                self._map.set_layer(name, grid, version, transform)
                self._drawn.add(name)

    def _place(self, transforms: Mapping[str, Pose], whereabouts: Whereabouts) -> None:
        own = whereabouts.own_track.points()
        if len(own):
            self._map.set_places(self._name, own)
        for name in sorted(self._placed - transforms.keys()):
            self._map.set_places(name, np.empty((0, 2)))
        self._placed.intersection_update(transforms)
        for name, transform in transforms.items():
            points = whereabouts.track(name).points()
            if len(points):
                self._map.set_places(name, transform.apply(points))
                self._placed.add(name)
