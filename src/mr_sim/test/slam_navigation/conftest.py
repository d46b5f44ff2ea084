"""Repeatable examples, and worlds drawn as text."""

import sys
from pathlib import Path
from typing import Callable, Sequence, Tuple

import cv2
import numpy as np
import pytest
from hypothesis import settings

sys.path.insert(0, str(Path(__file__).parent))
sys.path.append(str(Path(__file__).resolve().parents[3] / "mr_robot" / "test"))  # usual_robot
settings.register_profile("repeatable", derandomize=True, deadline=None, max_examples=40)
settings.load_profile("repeatable")

ROBOT = """
define rover position
(
  drive "diff" size [ 0.44 0.38 0.25 ] update_interval 50
  velocity_bounds [ -0.5 0.5 0 0 0 0 -90 90 ]
  localization "odom" odom_error [ 0.03 0.03 0 0.05 ]
  ranger ( update_interval 100 pose [ 0.1 0 0 0 ] sensor ( range [ 0 8 ] fov 270 samples 541 noise [ 0.0001 0 0 ] ) )
)
"""


@pytest.fixture
def draw_world(tmp_path: Path) -> Callable[..., str]:
    """Writes a world from walls (x, y, width, height in metres, lower left corner) and start poses; its path."""

    def draw(size: Tuple[float, float], walls: Sequence[Tuple[float, ...]], poses: Sequence[Tuple[float, ...]]) -> str:
        scale = 20
        image = np.full((round(size[1] * scale), round(size[0] * scale)), 255, np.uint8)
        frame = [
            (0, 0, size[0], 0.1),
            (0, size[1] - 0.1, size[0], 0.1),
            (0, 0, 0.1, size[1]),
            (size[0] - 0.1, 0, 0.1, size[1]),
        ]
        for x, y, width, height in [*frame, *walls]:
            rows = slice(round(y * scale), round((y + height) * scale))
            image[rows, round(x * scale) : round((x + width) * scale)] = 0
        cv2.imwrite(str(tmp_path / "plan.png"), np.flipud(image))
        text = f"resolution 0.02 interval_sim 50\n{ROBOT}"
        extent = f"size [ {size[0]} {size[1]} 1 ] pose [ {size[0] / 2} {size[1] / 2} 0 0 ]"
        text += f'model ( name "plan" {extent} bitmap "plan.png" )\n'
        for index, (x, y, degrees) in enumerate(poses):
            text += f'rover ( name "robot_{index}" pose [ {x} {y} 0 {degrees} ] )\n'
        path = tmp_path / "drawn.world"
        path.write_text(text)
        return str(path)

    return draw
