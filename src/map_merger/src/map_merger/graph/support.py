"""What the triangles around a link say of it."""

from typing import Tuple

import numpy as np

from .pose_graph import Links, wrapped

_LARGEST_SQUARE = 4.03**2


def support(links: Links, count: int) -> np.ndarray:
    """Share of the triangles around each link's pair that close, (m,), 0.5 where there are none.

    Of both directions of a pair only the heavier one is looked at.
    """
    chosen = _one_of_each_pair(links)
    low, high, mean, covariance = _upwards(links, chosen)
    number = np.full((count, count), -1)
    number[low, high] = np.arange(len(chosen))
    linked = number >= 0
    corners = np.argwhere(linked[:, :, None] & linked[None, :, :] & linked[:, None, :])
    sides = [number[corners[:, one], corners[:, other]] for one, other in ((0, 1), (1, 2), (0, 2))]
    closed = _closes(mean, covariance, *sides)
    right, all_ = np.full(len(chosen), 0.5), np.ones(len(chosen))
    for side in sides:
        np.add.at(right, side, closed)
        np.add.at(all_, side, 1.0)
    share = np.zeros(int(links.pair.max(initial=-1)) + 1)
    share[links.pair[chosen]] = right / all_
    return share[links.pair]


def _one_of_each_pair(links: Links) -> np.ndarray:
    order = np.lexsort((np.arange(len(links.pair)), -links.weight, links.pair))
    return order[np.unique(links.pair[order], return_index=True)[1]]


def _upwards(links: Links, chosen: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The chosen links, turned to map the higher node's frame to the lower one's: nodes, means, covariances."""
    first, second = links.first[chosen], links.second[chosen]
    mean, covariance = links.mean[chosen].copy(), links.covariance[chosen].copy()
    turned = first > second
    mean[turned], covariance[turned] = _inverse(mean[turned], covariance[turned])
    return np.minimum(first, second), np.maximum(first, second), mean, covariance


def _inverse(mean: np.ndarray, covariance: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    cosine, sine = np.cos(mean[:, 2]), np.sin(mean[:, 2])
    x = -cosine * mean[:, 0] - sine * mean[:, 1]
    y = sine * mean[:, 0] - cosine * mean[:, 1]
    by = np.zeros_like(covariance)
    by[:, 0, 0] = by[:, 1, 1] = -cosine
    by[:, 0, 1], by[:, 1, 0] = -sine, sine
    by[:, 0, 2], by[:, 1, 2], by[:, 2, 2] = y, -x, -1.0
    return np.column_stack([x, y, -mean[:, 2]]), by @ covariance @ np.swapaxes(by, 1, 2)


def _closes(
    mean: np.ndarray, covariance: np.ndarray, first: np.ndarray, second: np.ndarray, whole: np.ndarray
) -> np.ndarray:
    """True where the first link followed by the second is the whole one, bool (t,)."""
    cosine, sine = np.cos(mean[first, 2]), np.sin(mean[first, 2])
    x = cosine * mean[second, 0] - sine * mean[second, 1]
    y = sine * mean[second, 0] + cosine * mean[second, 1]
    gap = mean[first] + np.column_stack([x, y, mean[second, 2]]) - mean[whole]
    gap[:, 2] = wrapped(gap[:, 2])
    by_first = np.tile(np.eye(3), (len(first), 1, 1))
    by_first[:, 0, 2], by_first[:, 1, 2] = -y, x
    by_second = np.tile(np.eye(3), (len(first), 1, 1))
    by_second[:, 0, 0] = by_second[:, 1, 1] = cosine
    by_second[:, 0, 1], by_second[:, 1, 0] = -sine, sine
    spread = covariance[whole] + by_first @ covariance[first] @ np.swapaxes(by_first, 1, 2)
    spread += by_second @ covariance[second] @ np.swapaxes(by_second, 1, 2)
    squares = (gap[:, None, :] @ np.linalg.solve(spread, gap[:, :, None]))[:, 0, 0]
    return squares <= _LARGEST_SQUARE
