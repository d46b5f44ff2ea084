"""The description of a robot as URDF, for robot_state_publisher and rviz."""

from typing import Tuple
from xml.etree import ElementTree

from mr_robot.platforms.platform import Footprint, Platform

BASE_LINK = "base_link"
SENSOR_SIZE = 0.06  # m, of the box that is drawn for the sensor
LEAST_HEIGHT = 0.05  # m, of the body

Place = Tuple[float, float, float]


def urdf_of(platform: Platform, name: str = "robot") -> str:
    """Body and sensor, all joints fixed: from the frame of the base over base_link to that of the sensor. The body is
    as high as the sensor stands."""
    robot = ElementTree.Element("robot", name=name)
    base, mount = platform.frames.base, platform.mount
    below = base.rpartition("/")[0]
    link = f"{below}/{BASE_LINK}" if below else BASE_LINK
    height = max(mount.z, LEAST_HEIGHT)
    if base != link:
        ElementTree.SubElement(robot, "link", name=base)
        _join(robot, base, link, (0.0, 0.0, 0.0), 0.0)
    body = ElementTree.SubElement(robot, "link", name=link)
    for part in ("visual", "collision"):
        _shape(ElementTree.SubElement(body, part), platform.footprint, height)
    frame = f"{below}/{mount.frame}" if below else mount.frame
    sensor = ElementTree.SubElement(ElementTree.SubElement(robot, "link", name=frame), "visual")
    size = f"{SENSOR_SIZE} {SENSOR_SIZE} {SENSOR_SIZE}"
    ElementTree.SubElement(ElementTree.SubElement(sensor, "geometry"), "box", size=size)
    _join(robot, link, frame, (mount.x, mount.y, mount.z), mount.yaw)
    ElementTree.indent(robot)
    return ElementTree.tostring(robot, encoding="unicode") + "\n"


def _join(robot: ElementTree.Element, parent: str, child: str, place: Place, yaw: float) -> None:
    joint = ElementTree.SubElement(robot, "joint", name=f"{parent}_to_{child}".replace("/", "_"), type="fixed")
    ElementTree.SubElement(joint, "parent", link=parent)
    ElementTree.SubElement(joint, "child", link=child)
    ElementTree.SubElement(joint, "origin", xyz="{:g} {:g} {:g}".format(*place), rpy=f"0 0 {yaw:g}")


def _shape(part: ElementTree.Element, footprint: Footprint, height: float) -> None:
    ElementTree.SubElement(part, "origin", xyz=f"0 0 {height / 2.0:g}", rpy="0 0 0")
    geometry = ElementTree.SubElement(part, "geometry")
    if footprint == Footprint.disc(footprint.length):
        ElementTree.SubElement(geometry, "cylinder", radius=f"{footprint.radius:g}", length=f"{height:g}")
    else:
        size = f"{footprint.length:g} {footprint.width:g} {height:g}"
        ElementTree.SubElement(geometry, "box", size=size)
