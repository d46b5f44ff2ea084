"""Methods of registration by name, and those of the user's own by their place."""

from typing import Callable, Dict, List, Optional

from mr_grid import OccupancyGrid, Pose
from mr_grid.by_place import object_at

from . import registration
from .registration import DEFAULT_CRITERIA, UNLIMITED, Criteria, Limits, Registration, choose
from .search import Prior
from .surface import Landmarks

Method = Callable[..., Registration]
"""As `registration.register`."""

METHODS = ("correlation", "features")
_BY_PLACE: Dict[str, Method] = {}

Candidates = Callable[[OccupancyGrid, OccupancyGrid], List[Pose]]
"""What a method of one's own is: target and source -> transforms source -> target that may be right. They are refined,
verified and decided on like those of the search."""


def method_of(name: str) -> Method:
    """By name, or by place (`module:function`, `path/file.py:function`). Raises PlaceError."""
    if name == "correlation":
        return registration.register
    if name == "features":
        from . import features  # here: cv2, which only this method needs, is large

        return features.register
    if name not in _BY_PLACE:
        _BY_PLACE[name] = _verified(object_at(name))
    return _BY_PLACE[name]


def _verified(candidates: Candidates) -> Method:
    def register(
        target: Landmarks,
        source: Landmarks,
        criteria: Criteria = DEFAULT_CRITERIA,
        limits: Limits = UNLIMITED,
        prior: Optional[Prior] = None,
    ) -> Registration:
        found = [Pose(*each) for each in candidates(target.grid, source.grid)]
        return choose(target, source, found, (criteria,), limits, prior)

    return register
