"""Poses of robots by least squares over transforms between them: a small pose graph.

Grisetti et al., "A tutorial on graph-based SLAM", 2010, in the plane. Errors are those of the transform's own x, y (m)
and yaw (rad), as in its covariance.
"""

from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from mr_grid import Pose, normalized

from .._surfaces import pose_gaps, solve_poses

_MOST_STEPS = 8
_SMALL_STEP = 1e-7


class Links(NamedTuple):
    """Transforms between nodes, which are numbers.

    first, second: int (m,), the transform maps the frame of the second to that of the first. mean: (m, 3). covariance:
    (m, 3, 3). weight: (m,). pair: int (m,), the same for both directions of two nodes.
    """

    first: np.ndarray
    second: np.ndarray
    mean: np.ndarray
    covariance: np.ndarray
    weight: np.ndarray
    pair: np.ndarray


class Poses(NamedTuple):
    """Poses (n, 3: x, y, yaw) of the nodes and their covariances, (n, n, 3, 3), all zero for a node that was held."""

    mean: np.ndarray
    covariance: np.ndarray


def wrapped(angles: np.ndarray) -> np.ndarray:
    """The same angles in [-pi, pi)."""
    return (angles + np.pi) % (2.0 * np.pi) - np.pi


def spanning_tree(links: Links, order: Sequence[int], count: int) -> List[int]:
    """Numbers of the links that join `count` nodes without a cycle, taken in `order` (Kruskal)."""
    leader = list(range(count))

    def leader_of(node: int) -> int:
        while leader[node] != node:
            leader[node] = leader[leader[node]]
            node = leader[node]
        return node

    first, second = links.first.tolist(), links.second.tolist()
    tree = []
    for number in order:
        one, other = leader_of(first[number]), leader_of(second[number])
        if one != other:
            leader[max(one, other)] = min(one, other)
            tree.append(number)
    return tree


def placed_along(links: Links, tree: Sequence[int], count: int) -> Tuple[np.ndarray, np.ndarray]:
    """Poses (count, 3) along the links of a tree, the lowest node of each component at the origin; and which those are,
    bool (count,)."""
    neighbours: List[List[Tuple[int, Pose]]] = [[] for _ in range(count)]
    for number in tree:
        first, second = int(links.first[number]), int(links.second[number])
        transform = Pose(*links.mean[number].tolist())
        neighbours[first].append((second, transform))
        neighbours[second].append((first, transform.inverse()))
    poses: List[Pose] = [Pose()] * count
    held, seen = np.zeros(count, bool), [False] * count
    for root in range(count):
        if seen[root]:
            continue
        held[root] = seen[root] = True
        waiting = [root]
        while waiting:
            node = waiting.pop()
            for neighbour, transform in neighbours[node]:
                if not seen[neighbour]:
                    seen[neighbour] = True
                    poses[neighbour] = poses[node].compose(transform)
                    waiting.append(neighbour)
    return np.array([pose for pose in poses]), held


def relative(poses: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Transforms (m, 3) from the frames of `second` to those of `first`."""
    here, there = poses[first], poses[second]
    cosine, sine = np.cos(here[:, 2]), np.sin(here[:, 2])
    x, y = (there - here)[:, 0], (there - here)[:, 1]
    return np.column_stack([cosine * x + sine * y, cosine * y - sine * x, wrapped(there[:, 2] - here[:, 2])])


def _derivatives(poses: np.ndarray, first: np.ndarray, second: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Of `relative` with respect to the poses of the first and of the second nodes, (m, 3, 3) each."""
    between = relative(poses, first, second)
    cosine, sine = np.cos(poses[first, 2]), np.sin(poses[first, 2])
    by_second = np.zeros((len(first), 3, 3))
    by_second[:, 0, 0] = by_second[:, 1, 1] = cosine
    by_second[:, 0, 1], by_second[:, 1, 0] = sine, -sine
    by_second[:, 2, 2] = 1.0
    by_first = -by_second
    by_first[:, 0, 2], by_first[:, 1, 2] = between[:, 1], -between[:, 0]
    return by_first, by_second


def solved(links: Links, tree: Sequence[int], count: int) -> Poses:
    """The most likely poses. tree: numbers of those of the links that start the search (see `placed_along`)."""
    start, held = placed_along(links, tree, count)
    steps = _MOST_STEPS if len(tree) < len(links.first) else 1
    return Poses(*solve_poses(links.first, links.second, links.mean, links.covariance, start, held, steps, _SMALL_STEP))


def gaps(links: Links, chosen: np.ndarray, poses: Poses) -> np.ndarray:
    """Distance of each link from the poses in standard deviations, (m,); a link that helped to find them, bool (m,),
    leans towards them."""
    return np.array(
        pose_gaps(links.first, links.second, links.mean, links.covariance, chosen, poses.mean, poses.covariance)
    )


def relative_covariance(poses: Poses, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Covariances (m, 3, 3) of `relative`."""
    by_first, by_second = _derivatives(poses.mean, first, second)
    both = np.concatenate([by_first, by_second], axis=2)
    covariance = np.empty((len(first), 6, 6))
    covariance[:, :3, :3], covariance[:, :3, 3:] = poses.covariance[first, first], poses.covariance[first, second]
    covariance[:, 3:, :3], covariance[:, 3:, 3:] = poses.covariance[second, first], poses.covariance[second, second]
    return both @ covariance @ np.swapaxes(both, 1, 2)


def transform_between(poses: Poses, first: int, second: int) -> Pose:
    """The transform from the second node's frame to the first one's."""
    x, y, yaw = relative(poses.mean, np.array([first]), np.array([second]))[0].tolist()
    return Pose(x, y, normalized(yaw))
