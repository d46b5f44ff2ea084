"""What a robot is comes from its description alone, whoever runs its engines."""

from dataclasses import MISSING, fields

import pytest

import explorer.options
import map_merger.options
from explorer.options import Options as ExplorerOptions
from map_merger.options import Options as MergerOptions
from map_merger.robot_size import RobotSize
from mr_robot.navigation.options import NavigationOptions
from mr_robot.platforms.parameters import (
    explorer_parameters,
    merger_parameters,
    navigation_parameters,
    slam_parameters,
)
from mr_robot.platforms.platform import Drive, Footprint, Platform, RangeSensor
from mr_robot.platforms.preset import load_platform
from mr_robot.slam.options import SlamOptions

FOLLOWS = {
    SlamOptions: slam_parameters,
    NavigationOptions: navigation_parameters,
    ExplorerOptions: explorer_parameters,
    MergerOptions: merger_parameters,
}
LIMITS = {"free_range", "yaw_goal_tolerance"}  # of our own, which some robots narrow
GIANT = Platform(Footprint.box(1.1, 0.9), RangeSensor(0.1, 30.0, 6.2, 0.05), Drive(1.3, 0.7, 0.4, 0.9))
DWARF = Platform(Footprint.disc(0.1), RangeSensor(0.1, 1.0, 0.5, 0.001), Drive(0.1, 2.9, 3.0, 7.0))


def without_default(options):
    return {field.name for field in fields(options) if field.default is MISSING and field.default_factory is MISSING}


@pytest.mark.parametrize("options", FOLLOWS, ids=lambda options: options.__module__)
def test_no_engine_has_a_default_for_what_follows_from_the_robot(options):
    """Two robots that differ in everything show what does. With defaults a host that forgot to ask drove a Pioneer."""
    giant, dwarf = (FOLLOWS[options](robot, (robot,)) for robot in (GIANT, DWARF))
    follows = {name for name in giant if giant[name] != dwarf.get(name)} - LIMITS
    assert len(follows) >= 2 and follows <= without_default(options)


def test_sizes_of_robots_in_maps_have_none_either():
    assert without_default(RobotSize) == {field.name for field in fields(RobotSize)}


def test_nodes_that_are_told_nothing_take_a_pioneer():
    """Those of this package's engines that know no presets say what theirs is: it has to be that of the preset."""
    pioneer = load_platform("pioneer")
    explored, merged = explorer_parameters(pioneer, (pioneer,)), merger_parameters(pioneer, (pioneer,))
    told = explorer.options.load({}, 1, "host"), map_merger.options.options_of({}, "host")
    for parameters, options, names in (
        (explored, told[0], {"inflation_radius", "largest_robot_radius", "view_distance", "field_of_view"}),
        (merged, told[1], {"body_radius", "largest_robot_radius"}),
    ):
        assert {name: getattr(options, name) for name in names} == {name: parameters[name] for name in names}
