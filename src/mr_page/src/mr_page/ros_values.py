"""Messages of a robot as plain values for its page. Knows message fields only, by their names."""

from __future__ import annotations

from typing import Any

from mr_page.numbers import is_finite, number

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
        "time": number(message.exploration_time, 0),
        **{name: getattr(message, name) for name in counters},
    }


def decision_values(message: Any) -> dict[str, Any]:
    """explorer/ExplorationStatus."""
    return {
        "paused": message.paused,
        "ended_by": message.ended_by,
        "goal": _place(message.goal) if message.has_goal and _is_place(message.goal) else None,
        "reason": message.goal_reason,
        "strategy": message.strategy,
        "bids": _bids(message.bids),
        "unit": message.bid_unit,
        "auction_id": message.auction_id,
        "auction": [
            [*_place(offer.place), _bids(offer.bids), offer.explored_by]
            for offer in message.auction[:MOST]
            if _is_place(offer.place)
        ],
        "shares": {
            share.robot_name: _place(share.place) for share in message.assignment[:MOST] if _is_place(share.place)
        },
        "area": number(message.area_known, 1),
        "rest": number(message.expected_rest, 0),
        "left": [
            [*_place(left.place), number(left.size, 1), left.reason]
            for left in message.left[:MOST]
            if _is_place(left.place)
        ],
        "team_finished": list(message.team_finished),
        "limits": [number(message.time_limit, 1), number(message.distance_limit, 1)],
        "way": number(message.distance, 0),
    }


def team_values(message: Any) -> dict[str, Any]:
    """explorer/TeamOverview."""
    robots = {}
    for member in message.robots[:MOST]:
        told = member.state
        robots[told.robot_name] = {
            "state": stage_name(told.state) if member.age >= 0.0 else "",
            "text": told.text,
            "merging": told.merging,
            "area": number(told.area_known, 0),
            "in_reach": member.in_reach,
            "age": _age(member.age),
            "order": member.order,
            "answered": member.answered,
            "answer": told.order_answer,
            "number": told.order_number,
        }
    return {"text": message.text, "robots": robots}


def stage_name(state: int) -> str:
    return STAGES[state] if state < len(STAGES) else str(state)


def merger_values(message: Any) -> dict[str, Any]:
    """map_merger/MergerStatus."""
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
                "shared_wall": number(other.shared_wall_m, 1),
                "age": _age(other.age_s),
                "bytes": other.bytes_received,
            }
            for other in message.robots[:MOST]
            if is_finite(other.x, other.y, other.yaw, other.confidence)
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
            {"robot": link.robot, "two_way": link.two_way, "loss": number(link.loss, 2), "waiting": link.waiting}
            for link in message.links[:MOST]
        ],
        "routes": [
            {"to": route.destination, "via": route.next_hop, "hops": route.hops, "cost": round(route.cost, 1)}
            for route in message.routes[:MOST]
            if route.valid and is_finite(route.cost)
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


def _is_place(point: Any) -> bool:
    return is_finite(point.x, point.y)


def _place(point: Any) -> list[float]:
    return [round(point.x, 2), round(point.y, 2)]


def _bids(bids: Any) -> dict[str, float | None]:
    return {bid.robot_name: number(bid.bid, 2) for bid in bids[:MOST]}


def _age(seconds: float) -> float | None:
    """In tens of seconds, so that it is no news all the time; None if there is none."""
    return number(10.0 * (seconds // 10.0), 0) if seconds >= 0.0 else None
