"""Places any number of maps in the frame of the first one, through one another where needed."""

from typing import Dict, List, NamedTuple, Optional, Sequence, Set, Tuple

from mr_grid import OccupancyGrid, Pose

from .evidence import compare
from .global_map import GlobalMap
from .one_shot import confidence_in, criteria_for, decide
from .reasons import reason_of
from .registration import DEFAULT_CRITERIA, Registration
from .robot_size import USUAL_SIZE
from .surface import Landmarks, landmarks_of

CONTRADICTING_TEAM = 1.5 * DEFAULT_CRITERIA.conflict
"""Largest accepted share of a map's walls in free space of all maps placed so far."""


class Placed(NamedTuple):
    """A map's transform to the first one's frame, through which map it was found, and the evidence of that pair."""

    transform: Pose
    via: int
    confidence: float
    shared_wall: float


class Placement(NamedTuple):
    """All placed maps by number (the first map is not among them), and why each other one was not placed."""

    placed: Dict[int, Placed]
    declined: Dict[int, str]


def place(maps: Sequence[OccupancyGrid]) -> Placement:
    """Places the maps, those with the most shared wall first. Every pair is registered at most once."""
    search = _Search(maps)
    while search.advance():
        pass
    return Placement(search.placed, {each: search.reason_for(each) for each in search.open})


def merged(maps: Sequence[OccupancyGrid], placed: Dict[int, Placed]) -> OccupancyGrid:
    """The placed maps on the lattice of the first one."""
    whole = GlobalMap("0", USUAL_SIZE)
    whole.set_local(maps[0])
    for number in sorted(placed):
        whole.set_layer(str(number), maps[number], 0, placed[number].transform)
    update = whole.render()
    return maps[0] if update is None else update.grid


class _Search:
    """Placed and open maps, and the pairs that were registered: (placed, open) -> result."""

    def __init__(self, maps: Sequence[OccupancyGrid]) -> None:
        self._maps = maps
        self._landmarks: List[Landmarks] = [landmarks_of(each) for each in maps]
        self._pairs: Dict[Tuple[int, int], Registration] = {}
        self._refused: Set[Tuple[int, int]] = set()
        self.placed: Dict[int, Placed] = {}
        self.open = list(range(1, len(maps)))

    def advance(self) -> bool:
        """Places one more map; False if there is none to place."""
        for target in (0, *self.placed):
            for source in self.open:
                if (target, source) not in self._pairs:
                    self._pairs[target, source] = decide(self._landmarks[target], self._landmarks[source])
        while True:
            pair = self._best()
            if pair is None:
                return False
            if self._fits(pair):
                self._accept(pair)
                return True
            self._refused.add(pair)

    def reason_for(self, source: int) -> str:
        """Why an open map is not placed: of the pair with the most shared wall."""
        tried = [pair for pair in self._pairs if pair[1] == source]
        pair = max(tried, key=lambda each: (self._pairs[each].evidence.matched, -each[0]))
        if pair in self._refused:
            return "its walls are in free space of the maps placed before"
        return reason_of(self._pairs[pair], criteria_for(None))

    def _best(self) -> Optional[Tuple[int, int]]:
        scores = [
            (result.evidence.score, pair)
            for pair, result in self._pairs.items()
            if result.accepted and pair[1] in self.open and pair not in self._refused
        ]
        return max(scores)[1] if scores else None

    def _transform(self, pair: Tuple[int, int]) -> Pose:
        found = self._pairs[pair].transform
        assert found is not None
        return self.placed[pair[0]].transform.compose(found) if pair[0] else found

    def _fits(self, pair: Tuple[int, int]) -> bool:
        team = landmarks_of(merged(self._maps, self.placed))
        return compare(team, self._landmarks[pair[1]], self._transform(pair)).conflict <= CONTRADICTING_TEAM

    def _accept(self, pair: Tuple[int, int]) -> None:
        target, source = pair
        result = self._pairs[pair]
        through = self.placed[target].confidence if target else 1.0
        self.placed[source] = Placed(
            self._transform(pair), target, through * confidence_in(result), result.evidence.matched
        )
        self.open.remove(source)
