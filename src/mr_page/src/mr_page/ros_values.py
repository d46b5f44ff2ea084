"""Messages of a robot as plain values for its page. Knows message fields only, by their names."""

from __future__ import annotations

import math
from typing import Any

STAGES = ("starting", "exploring", "waiting", "returning", "finished")  # of explorer/ExplorationState
LEVELS = {4: "warning", 8: "error", 16: "fatal"}  # of rosgraph_msgs/Log; what is below is no news
MOST = 64  # links, routes, groups, leftovers that are shown


def exploration_values(message: Any) -> dict[str, Any]:
    """explorer/ExplorationState."""
    counters = ("frontiers", "clusters", "unreachable", "goals_reached", "auctions_completed", "auctions_uncompleted")
    return {
        "state": stage_name(message.state),
        "text": message.text,
        "finished": message.exploration_finished,
        "time": round(message.exploration_time),
        **{name: getattr(message, name) for name in counters},
    }


def decision_values(message: Any) -> dict[str, Any]:
    """explorer/ExplorationStatus."""
    return {
        "paused": message.paused,
        "ended_by": message.ended_by,
        "goal": [round(message.goal.x, 2), round(message.goal.y, 2)] if message.has_goal else None,
        "reason": message.goal_reason,
        "strategy": message.strategy,
        "bids": {bid.robot_name: number(bid.bid, 2) for bid in message.bids[:MOST]},
        "unit": message.bid_unit,
        "shares": {
            share.robot_name: [round(share.place.x, 2), round(share.place.y, 2)] for share in message.assignment[:MOST]
        },
        "area": number(message.area_known, 1),
        "rest": number(message.expected_rest, 0),
        "left": [
            [round(left.place.x, 2), round(left.place.y, 2), round(left.size, 1), left.reason]
            for left in message.left[:MOST]
        ],
        "team_finished": list(message.team_finished),
    }


def team_values(message: Any) -> dict[str, Any]:
    """explorer/TeamOverview. Ages in tens of seconds, so that they are no news all the time."""
    robots = {}
    for member in message.robots[:MOST]:
        told = member.state
        robots[told.robot_name] = {
            "state": stage_name(told.state) if member.age >= 0.0 else "",
            "text": told.text,
            "merging": told.merging,
            "area": number(told.area_known, 0),
            "in_reach": member.in_reach,
            "age": number(10.0 * math.floor(member.age / 10.0), 0) if member.age >= 0.0 else None,
            "order": member.order,
            "answered": member.answered,
            "answer": told.order_answer,
            "number": told.order_number,
        }
    return {"text": message.text, "robots": robots}


def stage_name(state: int) -> str:
    return STAGES[state] if state < len(STAGES) else str(state)


def merger_values(message: Any) -> dict[str, Any]:
    """map_merger/MergerStatus. Ages in tens of seconds, so that they are no news all the time."""
    return {
        "topology": message.topology,
        "base_station": message.base_station,
        "robots": [
            {
                "robot": other.robot,
                "placed": other.placed,
                "why": other.why,
                "via": other.via,
                "pose": [round(other.x, 3), round(other.y, 3), round(other.yaw, 4)],
                "confidence": round(other.confidence, 2),
                "shared_wall": round(other.shared_wall_m, 1),
                "age": number(10.0 * math.floor(other.age_s / 10.0), 0) if other.age_s >= 0.0 else None,
                "bytes": other.bytes_received,
            }
            for other in message.robots[:MOST]
        ],
        "wants_to_meet": list(message.wants_to_meet),
    }


def network_values(message: Any) -> dict[str, Any]:
    """adhoc_communication/NetworkState."""
    counters = ("frames_sent", "bytes_sent", "frames_received", "bytes_received", "packets_sent", "packets_failed")
    doubted = ("malformed", "unsealed", "without_key", "forged", "replayed", "reflected", "unproven")
    return {
        "interface": message.interface,
        "up": message.interface_up,
        "sealed": message.sealed,
        "robots": list(message.robots),
        "links": [
            {"robot": link.robot, "two_way": link.two_way, "loss": round(link.loss, 2), "waiting": link.waiting}
            for link in message.links[:MOST]
        ],
        "routes": [
            {"to": route.destination, "via": route.next_hop, "hops": route.hops, "cost": round(route.cost, 1)}
            for route in message.routes[:MOST]
            if route.valid
        ],
        "groups": [
            {
                "group": group.group,
                "root": group.root,
                "member": group.member,
                "connected": group.connected,
                "uplink": group.uplink,
                "downlinks": list(group.downlinks),
            }
            for group in message.groups[:MOST]
        ],
        "relays": len(message.relays),
        "waiting": message.packets_waiting,
        "doubted": sum(getattr(message, f"frames_{reason}") for reason in doubted),
        "hops": list(message.packets_received_by_hops),
        **{name: getattr(message, name) for name in counters},
    }


def number(value: float, digits: int) -> float | None:
    """Rounded; None for what is no number, because JSON has none of these."""
    if not math.isfinite(value):
        return None
    return round(value, digits) if digits else round(value)
