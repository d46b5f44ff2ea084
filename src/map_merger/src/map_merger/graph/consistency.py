"""The largest set of transforms that agree with one another.

Wrong transforms contradict right ones around cycles. The set of greatest weight without a contradiction is searched
for from a spanning tree: what agrees with the tree joins it; then each part of the tree that more weight wants
elsewhere is joined by that instead (local search, deterministic, with a bound on its effort).
"""

from typing import Iterator, List, NamedTuple, Sequence

import numpy as np

from .pose_graph import Links, Poses, gaps, solved, spanning_tree
from .support import support

LARGEST_GAP = 4.03
"""Standard deviations: 0.999 of the errors in three dimensions are smaller."""
MOST_TRIALS = 40
_ROUNDS = 6


class Choice(NamedTuple):
    """A set of links without a contradiction, bool (m,), the poses that it gives, a spanning tree of it and its
    weight."""

    chosen: np.ndarray
    poses: Poses
    tree: List[int]
    weight: float


def largest_consistent(links: Links, count: int) -> Choice:
    """The set of the greatest weight that was found; the order of the links decides between equals."""
    best, trials = _settled(links, np.argsort(-links.weight, kind="stable").tolist(), count), 0
    if best.chosen.all():
        return best
    by_support = np.lexsort((-links.weight, -support(links, count))).tolist()
    best = max(best, _settled(links, by_support, count), key=lambda choice: choice.weight)
    improved = True
    while improved:
        improved = False
        for order in _other_orders(links, best, count):
            trials += 1
            if trials > MOST_TRIALS:
                return best
            other = _settled(links, order, count)
            if other.weight > best.weight + 1e-9:
                best, improved = other, True
                break
    return best


def _settled(links: Links, order: Sequence[int], count: int) -> Choice:
    """What agrees with the tree that the order gives, and with what else agrees."""
    agreeing = np.zeros(len(links.first), bool)
    for round_ in range(_ROUNDS):
        chosen, tree = agreeing.copy(), _tree_of(links, agreeing, order, count)
        chosen[tree] = True
        numbers = np.flatnonzero(chosen)
        poses = solved(_part(links, numbers), np.searchsorted(numbers, tree).tolist(), count)
        agreeing = (gaps(links, chosen, poses) <= LARGEST_GAP) & (chosen | (round_ < _ROUNDS // 2))
        if (agreeing == chosen).all():
            break
    return Choice(chosen, poses, tree, weight_of(links, chosen))


def _tree_of(links: Links, agreeing: np.ndarray, order: Sequence[int], count: int) -> List[int]:
    """A spanning tree that leaves what agrees only where it has to."""
    return sorted(
        spanning_tree(links, [n for n in order if agreeing[n]] + [n for n in order if not agreeing[n]], count)
    )


def _part(links: Links, numbers: np.ndarray) -> Links:
    return Links(*(column[numbers] for column in links))


def weight_of(links: Links, chosen: np.ndarray) -> float:
    """Weight of a set. Both directions of a pair come from the same two maps and count once."""
    return float(_weights_by_pair(links, chosen).sum())


def _weights_by_pair(links: Links, chosen: np.ndarray) -> np.ndarray:
    weights = np.zeros(int(links.pair.max(initial=-1)) + 1)
    np.maximum.at(weights, links.pair[chosen], links.weight[chosen])
    return weights


def _other_orders(links: Links, best: Choice, count: int) -> Iterator[List[int]]:
    """Orders that join the two sides of a branch of the tree by a link left out, most promising branch first."""
    cuts = [cut for cut in (_cut(links, best, branch, count) for branch in best.tree) if cut.gain > 0.0]
    for cut in sorted(cuts, key=lambda cut: -cut.gain):
        inner = [number for number in best.tree if not cut.crossing[number]]
        left_out = np.flatnonzero(cut.crossing & ~best.chosen)
        for link in left_out[np.argsort(-links.weight[left_out], kind="stable")].tolist():
            yield [*inner, link, *range(len(links.first))]


class _Cut(NamedTuple):
    """The links, bool (m,), between both sides of a branch, and how much weight could be gained there at most."""

    crossing: np.ndarray
    gain: float


def _cut(links: Links, best: Choice, branch: int, count: int) -> _Cut:
    side = _side(links, [number for number in best.tree if number != branch], int(links.first[branch]), count)
    crossing = side[links.first] != side[links.second]
    gain = weight_of(links, crossing & ~best.chosen) - weight_of(links, crossing & best.chosen)
    return _Cut(crossing, gain)


def _side(links: Links, tree: Sequence[int], start: int, count: int) -> np.ndarray:
    """The nodes, bool (count,), that the links of the tree join to the start."""
    side = np.zeros(count, bool)
    side[start] = True
    grown = True
    while grown:
        grown = False
        for number in tree:
            first, second = links.first[number], links.second[number]
            if side[first] != side[second]:
                side[first] = side[second] = grown = True
    return side
