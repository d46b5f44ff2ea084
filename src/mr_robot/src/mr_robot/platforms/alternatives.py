"""Which SLAM and which navigation a robot may run, in which simulator, and which package each comes from."""

import os
from typing import Callable, Dict, Optional

from mr_robot.platforms.platform import PlatformError

OURS, NONE = "ours", "none"
SLAM = {"gmapping": "gmapping", "slam_toolbox": "slam_toolbox", "hector": "hector_mapping"}
NAVIGATION = {"move_base": "move_base", "move_base_flex": "mbf_costmap_nav"}
ALTERNATIVES: Dict[str, Dict[str, str]] = {"slam": SLAM, "navigation": NAVIGATION}
"""Of a robot, {argument: {value beside ours and none: package}}."""
SIMULATORS = {"stage": "stage_ros"}
"""{value beside ours: package}."""
OWN = ".launch"
"""How the path of a launch file of one's own ends, which takes the place of a value."""


def check_alternative(argument: str, value: str, find: Callable[[str], Optional[str]]) -> None:
    """Raises PlatformError for a value that is unknown, or whose package or file is not there. `find` gives the folder
    of a package, None if there is none."""
    packages = ALTERNATIVES[argument]
    if value == NONE:
        return
    if value.endswith(OWN):
        if not os.path.isfile(value):
            raise PlatformError(f"{argument}:={value}: there is no such file")
        return
    _check_package(argument, value, packages, f"{NONE}, and launch files of your own (FILE{OWN})", find)


def check_simulator(value: str, find: Callable[[str], Optional[str]]) -> None:
    """Of simulation_2.launch and the like. Raises PlatformError as `check_alternative`."""
    _check_package("simulator", value, SIMULATORS, "", find)


def _check_package(
    argument: str, value: str, packages: Dict[str, str], besides: str, find: Callable[[str], Optional[str]]
) -> None:
    if value == OURS:
        return
    if value not in packages:
        there = ", ".join(filter(None, [OURS, *packages, besides]))
        raise PlatformError(f"{argument}:={value} is unknown; there are {there}")
    package = packages[value]
    if find(package) is None:
        raise PlatformError(
            f"{argument}:={value} needs the package {package}, which is not installed: install it and source its "
            f"workspace, or leave {argument} at {OURS}"
        )


def find_package(name: str) -> Optional[str]:
    """Folder of a ROS package; None where there is none, or no ROS."""
    try:
        import rospkg  # of ROS, and needed only for the packages of others
    except ImportError:
        return None
    try:
        return str(rospkg.RosPack().get_path(name))
    except rospkg.ResourceNotFound:
        return None
