"""Conversion between statements and their messages, which travel as this package's own types."""

from typing import Optional

from explorer.messages import SendStatement
from explorer.msg import TeamLeftover, TeamVerdict, TeamVerdicts
from explorer.statement import MOST_LEFT, MOST_VERDICTS, Decided, Kind, LeftPlace, Stage, Statement

SERVICE = "send_message"  # of adhoc_communication, for messages of any type
TOPIC = "explorer/verdicts"  # at the others
KINDS, STAGES = frozenset(map(int, Kind)), frozenset(map(int, Stage))


def verdicts_to(effect: SendStatement) -> TeamVerdicts:
    said = effect.statement
    return TeamVerdicts(
        said.robot,
        said.mission,
        said.number,
        int(said.stage),
        said.area,
        [TeamVerdict(each.x, each.y, int(each.kind), each.known) for each in said.verdicts],
        [TeamLeftover(*place) for place in said.left],
    )


def statement_from(message: TeamVerdicts) -> Optional[Statement]:
    """None for a stage that there is not; verdicts of kinds that there are not, and more than there may be, are left
    out."""
    if message.stage not in STAGES:
        return None
    return Statement(
        message.robot_name.strip("/"),
        int(message.mission),
        int(message.number),
        Stage(message.stage),
        message.area,
        tuple(
            Decided(each.x, each.y, Kind(each.kind), each.known)
            for each in message.verdicts[:MOST_VERDICTS]
            if each.kind in KINDS
        ),
        tuple(LeftPlace(each.x, each.y, each.area, each.reason) for each in message.left[:MOST_LEFT]),
    )
