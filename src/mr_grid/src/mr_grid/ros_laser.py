"""How a laser is mounted, as tf says. Only nodes and the modules that convert messages for them import this."""

import math
from typing import Any, NamedTuple, Tuple

from geometry_msgs.msg import Pose as PoseMessage
from geometry_msgs.msg import TransformStamped

from mr_grid.grid import GridError
from mr_grid.pose import Pose
from mr_grid.ros import pose_value

MOST_TILT = 15.0  # degrees by which a laser may be out of the level: with more, its ranges are no distances on a plan


class Mount(NamedTuple):
    """`pose`: of the laser in the robot's frame. `upside_down`: seen from above its beams run the other way round."""

    pose: Pose = Pose()
    upside_down: bool = False

    def beams(self, scan: Any) -> Tuple[float, float]:
        """angle_min and angle_increment of a sensor_msgs/LaserScan in the plane of the robot, rad."""
        sign = -1.0 if self.upside_down else 1.0
        return sign * scan.angle_min, sign * scan.angle_increment


def mount_value(message: TransformStamped) -> Mount:
    """From the laser to the robot. GridError for a laser that is neither level nor upside down."""
    pose = pose_value(PoseMessage(message.transform.translation, message.transform.rotation))
    q = message.transform.rotation
    upright = max(-1.0, min(1.0, 1.0 - 2.0 * (q.x * q.x + q.y * q.y)))
    tilt = math.degrees(math.acos(upright))
    if MOST_TILT < tilt < 180.0 - MOST_TILT:
        raise GridError(
            f"laser {message.child_frame_id} is tilted by {tilt:.0f} degrees, not level or upside down: "
            f"correct its transform from {message.header.frame_id}, or use another laser"
        )
    return Mount(pose, upright < 0.0)
