"""Engines of the usual robot, for tests that are about no robot in particular."""

from typing import Any

from mr_robot.navigation.options import NavigationOptions
from mr_robot.platforms.engines import defaults_of
from mr_robot.slam.engine import Slam
from mr_robot.slam.options import SlamOptions


def slam_with(**given: Any) -> Slam:
    return Slam(SlamOptions(**{**defaults_of(SlamOptions), **given}))


def navigation_with(**given: Any) -> NavigationOptions:
    return NavigationOptions(**{**defaults_of(NavigationOptions), **given})
