"""Which topics of a bag an export takes."""

from __future__ import annotations

from typing import Any, Callable, Sequence

from mr_launch.errors import UserError
from mr_launch.recordings.bags import topic_of

SHOWN = {  # types that viewers draw or plot
    "tf2_msgs/msg/TFMessage",
    "sensor_msgs/msg/LaserScan",
    "nav_msgs/msg/Odometry",
    "nav_msgs/msg/OccupancyGrid",
    "geometry_msgs/msg/Twist",
    "geometry_msgs/msg/PointStamped",
    "visualization_msgs/msg/MarkerArray",
    "adhoc_communication/msg/MmListOfPoints",
    "explorer/msg/ExplorationState",
    "explorer/msg/ExplorationStatus",
    "map_merger/msg/MergerStatus",
}
ON_THE_AIR = ("map_meta_other", "explorer/verdicts")  # of these types, but told by others in their own frames
NEVER = ("clock",)  # an export has one time, that of its messages


def selection(topics: Sequence[str], everything: bool, known: set[str]) -> Callable[[Any], bool]:
    """Says of a connection whether it is wanted. `topics`: by name, as the robots have them; none: what viewers show.
    Raises UserError for a name that no robot has (`known`)."""
    wanted = {topic.strip("/") for topic in topics}
    unknown = sorted(wanted - known)
    if unknown:
        raise UserError(f"no robot has recorded {', '.join(unknown)}; there are {', '.join(sorted(known))}")

    def is_wanted(connection: Any) -> bool:
        topic = topic_of(connection)
        if topic in NEVER:
            return False
        if wanted:
            return topic in wanted
        return everything or (connection.msgtype in SHOWN and topic not in ON_THE_AIR)

    return is_wanted
