"""The edge of the agent: coordinates that cannot be go no further."""

import math
from typing import Dict, List, Mapping, Optional, Sequence, Set

import numpy as np

from explorer.foreign import Element
from explorer.geometry import Position
from explorer.messages import Emit, Note
from explorer.statement import Statement
from explorer.team import Team
from mr_grid import FARTHEST, Pose, is_place


class Edge:
    """Filters input; one warning for each kind of it, however often it comes."""

    def __init__(self, own_name: str, emit: Emit) -> None:
        self._own_name, self._emit = own_name, emit
        self._complaints: Set[str] = set()

    def accepts(self, pose: Pose) -> bool:
        possible = is_place(pose.x, pose.y, pose.yaw)
        if not possible:
            self._complain("poses", f"({pose.x:g}, {pose.y:g}, {pose.yaw:g}): check tf")
        return possible

    def positions(self, positions: Mapping[str, Position]) -> Dict[str, Position]:
        """Usable ones of other robots."""
        usable = {name: place for name, place in positions.items() if is_place(*place)}
        strange = sorted(set(positions) - set(usable))
        if strange:
            self._complain("positions", f"of {', '.join(strange[:5])}: check map_merger there")
        return {name: place for name, place in usable.items() if name != self._own_name}

    def transform(self, robot: str, transform: Optional[np.ndarray]) -> Optional[np.ndarray]:
        if transform is not None and not is_place(*transform.ravel()):
            self._complain("transforms", f"from the frame of {robot}: check map_merger")
            return None
        return transform

    def elements(self, elements: Sequence[Element], team: Team) -> List[Element]:
        """Those of other robots that are known, at places that can be."""
        usable = []
        for element in elements:
            if not is_place(element.x, element.y):
                self._complain("frontiers", f"of {element.detected_by}: check its explorer")
            elif element.detected_by != self._own_name and team.peer(element.detected_by) is not None:
                usable.append(element)
        return usable

    def accepts_statement(self, statement: Statement) -> bool:
        """False for one with places or areas that cannot be, or of this robot itself."""
        places = [(each.x, each.y, each.known) for each in statement.verdicts]
        places += [(each.x, each.y, each.area) for each in statement.left]
        areas = [statement.area, *(area for _, _, area in places)]
        possible = all(is_place(x, y) for x, y, _ in places) and all(0.0 <= area < math.inf for area in areas)
        if not possible:
            self._complain("verdicts", f"of {statement.robot}: check its explorer")
        return possible and statement.robot != self._own_name

    def _complain(self, what: str, text: str) -> None:
        if what not in self._complaints:
            self._complaints.add(what)
            self._emit(Note(f"{what} that are no numbers or farther than {FARTHEST:g} m are ignored, {text}", True))
