"""Options of the engines for a robot, from its description.

`team`: the kinds of robots in the team, with the robot's own. `given`: options in place of those that follow from it.
"""

from dataclasses import MISSING, fields
from typing import Any, Dict, Sequence, Type, Union

from mr_robot.navigation.options import NavigationOptions
from mr_robot.platforms.parameters import Parameters, navigation_parameters, slam_parameters
from mr_robot.platforms.platform import Platform
from mr_robot.platforms.preset import load_platform
from mr_robot.slam.options import SlamOptions

USUAL = "pioneer"
"""The preset of the robot that a node takes where no parameter tells of another one."""

_PARAMETERS = {SlamOptions: slam_parameters, NavigationOptions: navigation_parameters}


def slam_options(platform: Platform, team: Sequence[Platform], **given: Any) -> SlamOptions:
    """Raises SlamError."""
    return SlamOptions(**{**_of(SlamOptions, slam_parameters(platform, team)), **given})


def navigation_options(platform: Platform, team: Sequence[Platform], **given: Any) -> NavigationOptions:
    """Raises NavigationError."""
    return NavigationOptions(**{**_of(NavigationOptions, navigation_parameters(platform, team)), **given})


def defaults_of(options: Union[Type[SlamOptions], Type[NavigationOptions]]) -> Dict[str, Any]:
    """Of a node's parameters: the defaults of the options, and for those without one what follows from the usual
    robot. Raises PlatformError."""
    usual = load_platform(USUAL)
    follows = _PARAMETERS[options](usual, (usual,))
    return {field.name: follows[field.name] if field.default is MISSING else field.default for field in fields(options)}


def _of(options: type, parameters: Parameters) -> Parameters:
    names = {field.name for field in fields(options)}
    return {name: value for name, value in parameters.items() if name in names}
