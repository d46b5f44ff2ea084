"""Conversions between ROS messages and the values of this package."""

from __future__ import annotations

import math
from typing import Any

import actionlib

from mr_measures.record.logs import CANCELLED, REACHED

OUTCOMES = {
    actionlib.GoalStatus.SUCCEEDED: REACHED,
    actionlib.GoalStatus.PREEMPTED: CANCELLED,
    actionlib.GoalStatus.RECALLED: CANCELLED,
}  # of a goal that no other has replaced


def state_values(message: Any) -> dict[str, Any]:
    """explorer/ExplorationState to fields of RobotReport."""
    return {
        "state": message.state,
        "text": message.text,
        "exploration_finished": message.exploration_finished,
        "exploration_time": message.exploration_time,
        "goal": [message.goal.x, message.goal.y] if message.has_goal else None,
        "frontiers": message.frontiers,
        "unreachable": message.unreachable,
        "goals": message.goals,
        "goals_reached": message.goals_reached,
        "goals_failed": message.goals_failed,
        "auctions": message.auctions_completed,
        "auctions_uncompleted": message.auctions_uncompleted,
    }


def offers_of(message: Any) -> list[dict[str, Any]]:
    """explorer/ExplorationStatus: all bids of the last auction, as `mr_measures.record.robot_record.Offer`."""
    return [
        {
            "x": round(offer.place.x, 3),
            "y": round(offer.place.y, 3),
            "bids": {bid.robot_name: round(bid.bid, 2) for bid in offer.bids if math.isfinite(bid.bid)},
            "explored_by": offer.explored_by,
        }
        for offer in message.auction
    ]


def radio_values(message: Any) -> dict[str, Any]:
    """adhoc_communication/Status to fields of RobotReport."""
    counters = ("frames_sent", "bytes_sent", "frames_received", "bytes_received", "packets_sent", "packets_failed")
    radio = {name: getattr(message, name) for name in counters}
    radio["packets_received_by_hops"] = list(message.packets_received_by_hops)
    return {"neighbors": list(message.neighbors), "radio": radio}
