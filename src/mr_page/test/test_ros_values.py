"""Messages with numbers that are none: what is told of them is JSON."""

import json
import math

import pytest

from mr_page.ros_values import decision_values, exploration_values, merger_values, network_values, team_values


def messages(odd):
    from adhoc_communication.msg import NetworkLink, NetworkRoute, NetworkState
    from explorer.msg import (
        ExplorationBid,
        ExplorationLeftover,
        ExplorationOffer,
        ExplorationShare,
        ExplorationState,
        ExplorationStatus,
        TeamMember,
        TeamOverview,
        TeamState,
    )  # fmt: skip
    from geometry_msgs.msg import Point
    from map_merger.msg import MergerStatus, RobotPlacement

    place = Point(1.0, odd, 0.0)
    return {
        exploration_values: ExplorationState(exploration_time=odd),
        decision_values: ExplorationStatus(
            has_goal=True, goal=place, bids=[ExplorationBid("a", odd)], area_known=odd, expected_rest=odd,
            time_limit=odd, distance=odd,
            auction=[
                ExplorationOffer(place, [], ""), ExplorationOffer(Point(1, 2, 0), [ExplorationBid("b", odd)], "b"),
            ],
            assignment=[ExplorationShare("a", place)], left=[ExplorationLeftover(place=place, size=odd)],
        ),
        team_values: TeamOverview(robots=[TeamMember(state=TeamState(robot_name="a", area_known=odd), age=odd)]),
        merger_values: MergerStatus(
            robots=[RobotPlacement(robot="a", x=odd), RobotPlacement(robot="b", shared_wall_m=odd, age_s=odd)]
        ),
        network_values: NetworkState(
            links=[NetworkLink(robot="a", loss=odd)], routes=[NetworkRoute(destination="a", valid=True, cost=odd)]
        ),
    }  # fmt: skip


@pytest.mark.parametrize("odd", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_none_are_told_as_none_or_not_at_all(odd):
    told = {values.__name__: values(message) for values, message in messages(odd).items()}
    json.dumps(told, allow_nan=False)
    assert told["decision_values"]["goal"] is None and told["decision_values"]["area"] is None
    assert told["decision_values"]["auction"] == [[1, 2, {"b": None}, "b"]]
    assert [robot["robot"] for robot in told["merger_values"]["robots"]] == ["b"]
