"""Values as robots tell them, for tests."""

DECISION = {
    "paused": False, "ended_by": "", "goal": [3.0, 4.0], "reason": "bid 7.2 m, the lowest of 4 clusters",
    "strategy": "tours", "bids": {"robot_0": 7.2}, "unit": 7, "auction_id": 0, "auction": [], "shares": {},
    "area": 12.5, "rest": None, "left": [], "team_finished": [],
}  # fmt: skip
EXPLORATION = {"state": "exploring", "text": "drives", "finished": False, "time": 3, "frontiers": 1, "clusters": 1}


def decision(**changes):
    return {**DECISION, **changes}


def exploration(state):
    return {**EXPLORATION, "state": state}


def merger(**placed):
    """{robot: whether it is placed}."""
    return {
        "topology": "distributed",
        "base_station": "",
        "robots": [
            {"robot": name, "placed": known, "why": f"because of {name}", "via": "", "pose": [1.0, 2.0, 0.5],
             "confidence": 0.9, "shared_wall": 3.0, "age": 0, "bytes": 7}
            for name, known in placed.items()
        ],
        "wants_to_meet": [],
    }  # fmt: skip


def network(sent=0, received=0, links=()):
    return {
        "bytes_sent": sent,
        "bytes_received": received,
        "links": [{"robot": name, "two_way": True, "loss": 0.1, "waiting": 0} for name in links],
    }
