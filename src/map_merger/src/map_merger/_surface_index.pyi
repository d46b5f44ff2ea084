"""Search for the nearest like-facing point of a surface (src/cpp). Lengths in metres."""

import numpy as np

class SurfaceIndex:
    def __init__(self, points: np.ndarray, normals: np.ndarray, normal_weight: float) -> None: ...
    def nearest(self, points: np.ndarray, normals: np.ndarray, bound: float) -> np.ndarray: ...
