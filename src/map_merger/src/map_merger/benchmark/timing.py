"""What a registration costs on one core: landmarks of both maps and the search."""

import math
import time
from typing import List, NamedTuple

import cv2
import numpy as np

from mr_grid import FREE, OCCUPIED, UNKNOWN, GridInfo, OccupancyGrid, Pose

from ..registration import register
from ..surface import landmarks_of
from ..synthetic import KINDS, Survey, Surveyor


class Times(NamedTuple):
    """CPU seconds of each pair: for the landmarks of both maps, and for the registration."""

    landmarks: List[float]
    registration: List[float]


def times_of(pairs: List[List[OccupancyGrid]]) -> Times:
    """CPU times on one core; the first pair is measured twice, so that nothing is loaded for the first time."""
    landmarks, registration = [], []
    for target, source in [pairs[0], *pairs]:
        began = time.process_time()
        first, second = landmarks_of(target), landmarks_of(source)
        between = time.process_time()
        register(first, second)
        landmarks.append(between - began)
        registration.append(time.process_time() - between)
    return Times(landmarks[1:], registration[1:])


def floor_pairs(seed: int, count: int) -> List[List[OccupancyGrid]]:
    """Pairs of maps of floors of 26 m x 15 m, of robots that have driven 40 m each."""
    pairs = []
    for number in range(seed, seed + count):
        random = np.random.default_rng(number)
        surveyor = Surveyor(KINDS["offices"](random, 26.0))
        pairs.append([surveyor.explore(random, Survey(path_length=40.0)).grid for _ in range(2)])
    return pairs


def large_pair(seed: int) -> List[OccupancyGrid]:
    """Two maps of 2000 x 2000 cells of one building, all of it known, the second one turned by 0.6 rad."""
    random = np.random.default_rng(seed)
    halves = [KINDS["offices"](random, 100.0).walls for _ in range(2)]
    cells = np.where(np.vstack(halves), OCCUPIED, FREE).astype(np.int8)[:2000, :2000]
    info = GridInfo(cells.shape[1], cells.shape[0], 0.05, Pose())
    turn = cv2.getRotationMatrix2D((1000.0, 1000.0), math.degrees(0.6), 1.0)
    turned = cv2.warpAffine(
        cells.view(np.uint8), turn, cells.shape[::-1], flags=cv2.INTER_NEAREST, borderValue=UNKNOWN % 256
    )
    return [OccupancyGrid(info, cells), OccupancyGrid(info, turned.view(np.int8))]
