"""All topic, service and action names of the node, in one place (contract 3.2). README.md repeats them."""

from dataclasses import dataclass
from typing import Dict

from explorer.options import Options

CLUSTER_GRIDS = 20


@dataclass(frozen=True)
class Names:
    """Names for one robot. On a real robot they are relative, so a group namespace works too; in simulation what
    belongs to the radio and the map merger is absolute under the robot's prefix."""

    subscribed: Dict[str, str]
    published: Dict[str, str]
    called: Dict[str, str]
    offered: Dict[str, str]
    action: str


def names_for(options: Options) -> Names:
    prefix = f"{options.robot_prefix}/" if options.simulation else ""
    published = {
        "state": "~state",
        "status": "~status",
        "auctions": "~sent_auctions",
        "frontiers": "frontierPoints",
        "visited": "visitedfrontierPoints",
        "goal": "goalPoint/goalPoint",
        "home": "homePoint/homePoint",
        "goal_unused": "goalPoint",
    }
    published.update({f"cluster_{index}": f"cluster_grid_{index}" for index in range(CLUSTER_GRIDS)})
    return Names(
        subscribed={
            "frontiers": f"{prefix}frontiers",
            "visited_frontiers": f"{prefix}visited_frontiers",
            "negotiation_list": f"{prefix}negotiation_list",
            "auction": f"{prefix}auction",
            "verdicts": f"{prefix}explorer/verdicts",
            "orders": f"{prefix}explorer/orders",
            "merger_status": f"{prefix}map_merger/status",
            "all_positions": f"{prefix}all_positions",
            "map": _placed(prefix, options.map_topic),
            "map_metadata": _placed(prefix, options.local_map_metadata_topic),
            "status": f"{prefix}adhoc_communication/status",
            "new_robot": f"{prefix}adhoc_communication/new_robot",
            "remove_robot": f"{prefix}adhoc_communication/remove_robot",
        },
        published=published,
        called={
            "send_frontier": f"{prefix}adhoc_communication/send_frontier",
            "send_auction": f"{prefix}adhoc_communication/send_auction",
            "send_message": f"{prefix}adhoc_communication/send_message",
            "transform_point": f"{prefix}map_merger/transformPoint",
            "log_output": f"{prefix}map_merger/logOutput",
        },
        offered={
            name: f"~{name}"
            for name in ("start", "pause", "resume", "return_now", "stop", "go_home", "set_limits", "catch_up")
        },
        action="move_base",
    )


def _placed(prefix: str, topic: str) -> str:
    return topic if topic.startswith("/") else prefix + topic
