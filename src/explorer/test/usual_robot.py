"""Options of the usual robot, for tests that are about no robot in particular."""

from typing import Any

from explorer.options import DEFAULTS, Options

LARGEST: float = DEFAULTS["largest_robot_radius"]
_OF_THE_ROBOT = ("inflation_radius", "largest_robot_radius", "view_distance", "field_of_view")


def options_with(**given: Any) -> Options:
    return Options(**{**{name: DEFAULTS[name] for name in _OF_THE_ROBOT}, **given})
