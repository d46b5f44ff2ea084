"""What the outcome of a goal means for its frontier."""

from explorer.claim import OwnClaim
from explorer.driver import Goal, GoalEvent
from explorer.geometry import distance
from explorer.messages import REACHED, Emit, Note
from explorer.perception import Perception
from explorer.team import Team
from explorer.verdicts import Verdicts
from mr_grid import Pose

BLOCKING_DISTANCE = 1.5  # m, a robot this near to where the way ended may be what makes a goal fail


class Outcomes:
    """Turns the events of goals into verdicts. `limit`: failed goals that give a cluster up."""

    def __init__(
        self, limit: int, perception: Perception, verdicts: Verdicts, team: Team, claim: OwnClaim, emit: Emit
    ) -> None:
        self._limit = limit
        self._perception, self._verdicts, self._team, self._claim = perception, verdicts, team, claim
        self._emit = emit

    def take(self, event: GoalEvent, here: Pose, now: float) -> None:
        if event.outcome == REACHED:
            self._verdicts.look(
                event.goal.frontier,
                lambda verdict: self._perception.in_view(here, (verdict.x, verdict.y)),
                self._perception.known_area_near,
                now,
            )
        else:
            self._fail(event.goal, event.text, here, now)

    def _fail(self, goal: Goal, text: str, here: Pose, now: float) -> None:
        blocked = self._robot_in_the_way(goal, here, now)
        place = f"({goal.pose.x:.2f}, {goal.pose.y:.2f})"
        self._emit(Note(f"goal {place} failed{' behind a robot' if blocked else ''}: {text}"))
        if goal.frontier is None or goal.frontier not in self._perception.frontiers.frontiers:
            return
        behind = self._perception.behind_block(goal.nearest, goal.pose)
        self._verdicts.fail(goal.frontier, behind, blocked, self._perception.known_near, now)
        if not blocked and goal.cluster is not None:
            cluster = next((c for c in self._perception.clusters if c.number == goal.cluster), None)
            members = () if cluster is None else cluster.numbers
            self._verdicts.fail_cluster(goal.cluster, members, self._limit, self._perception.known_near)
        self._claim.release()

    def _robot_in_the_way(self, goal: Goal, here: Pose, now: float) -> bool:
        return any(
            distance(position, (place.x, place.y)) < BLOCKING_DISTANCE
            for position in self._team.positions(now).values()
            for place in (here, goal.pose)
        )
