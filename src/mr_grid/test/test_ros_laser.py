"""How lasers are mounted, from tf."""

import math

import pytest
from geometry_msgs.msg import Quaternion, TransformStamped
from sensor_msgs.msg import LaserScan

from mr_grid import GridError
from mr_grid.ros_laser import mount_value


def mounted(roll=0.0, pitch=0.0, yaw=0.0):
    """As tf tells it: turned by roll, then pitch, then yaw, about the axes of the robot."""
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id = "base", "laser"
    message.transform.translation.x, message.transform.translation.z = 0.2, 1.0
    (sr, cr), (sp, cp), (sy, cy) = [(math.sin(a / 2.0), math.cos(a / 2.0)) for a in (roll, pitch, yaw)]
    message.transform.rotation = Quaternion(
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )
    return message


@pytest.mark.parametrize(
    ("message", "yaw", "upside_down"),
    [
        (mounted(), 0.0, False),
        (mounted(roll=0.2, yaw=0.5), 0.5, False),
        (mounted(pitch=0.2, yaw=-2.0), -2.0, False),
        (mounted(roll=math.pi), 0.0, True),
        (mounted(roll=math.pi - 0.2, yaw=1.0), 1.0, True),
        (mounted(pitch=math.pi), math.pi, True),
    ],
)
def test_a_laser_is_level_or_upside_down(message, yaw, upside_down):
    mount = mount_value(message)
    assert mount.pose[:2] == (0.2, 0.0) and abs(math.remainder(mount.pose.yaw - yaw, 2.0 * math.pi)) < 1e-9
    assert mount.upside_down == upside_down
    scan = LaserScan(angle_min=-1.0, angle_increment=0.5)
    assert mount.beams(scan) == ((1.0, -0.5) if upside_down else (-1.0, 0.5))


@pytest.mark.parametrize(
    ("message", "tilt"),
    [(mounted(roll=math.pi / 2.0), 90), (mounted(pitch=math.radians(20.0)), 20), (mounted(roll=2.8), 160)],
)
def test_a_laser_that_is_tilted_is_refused_with_its_frame_and_tilt(message, tilt):
    with pytest.raises(GridError, match=f"laser laser is tilted by {tilt} degrees.*its transform from base"):
        mount_value(message)
