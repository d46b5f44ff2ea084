"""Conversion between what mission controls and robots tell one another and its messages."""

import re
from typing import Any, Sequence

from explorer import team_state
from explorer.answer import Answer
from explorer.limits import Limits
from explorer.mission_control import Member, summary_of
from explorer.msg import TeamMember, TeamOrder, TeamOverview, TeamState

ORDERS_TOPIC = "explorer/orders"  # at the robots
STATES_TOPIC = "explorer/team_states"  # at the mission controls
LONGEST_TEXT = 500


def order_to(order: team_state.TeamOrder) -> TeamOrder:
    return TeamOrder(order.sender, order.number, order.order, *order.limits)


def order_from(message: TeamOrder) -> team_state.TeamOrder:
    limits = Limits(message.time, message.distance)
    return team_state.TeamOrder(message.sender.strip("/"), int(message.number), message.order, limits)


def state_to(state: team_state.TeamState, merging: str = "") -> TeamState:
    """`merging`: what map_merger says, which the agent does not know."""
    sender, number = state.order or ("", 0)
    return TeamState(
        state.robot, state.state, state.text, merging or state.merging, state.ended_by, state.exploration_time,
        state.area, sender, number, state.answer.done, state.answer.text,
    )  # fmt: skip


def state_from(message: TeamState) -> team_state.TeamState:
    order = (message.order_sender, int(message.order_number)) if message.order_sender else None
    return team_state.TeamState(
        robot=message.robot_name.strip("/"),
        state=int(message.state),
        text=_line(message.text),
        merging=_line(message.merging),
        ended_by=_line(message.ended_by),
        exploration_time=message.exploration_time,
        area=message.area_known,
        order=order,
        answer=Answer(message.order_done, _line(message.order_answer)),
    )


def _line(text: str) -> str:
    """What another robot says, as one line without anything that moves a cursor."""
    return re.sub(r"[\x00-\x1f\x7f]+", " ", text)[:LONGEST_TEXT]


def overview_of(members: Sequence[Member]) -> TeamOverview:
    """Without a stamp."""
    return TeamOverview(text=summary_of(members), robots=[_member_to(member) for member in members])


def _member_to(member: Member) -> TeamMember:
    state: Any = TeamState(robot_name=member.robot) if member.state is None else state_to(member.state)
    return TeamMember(state, member.in_reach, member.age, member.order, member.answered)
