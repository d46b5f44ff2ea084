"""What kind of radio the robots of a trial share."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class RadioOptions:
    """What kind of radio the robots share. An infinite range reaches everybody."""

    range: float = math.inf  # m
    loss: float = 0.0  # per frame and receiver
    bit_rate: float = 50e6  # bit/s
    wall_attenuation: float = 0.0  # dB per wall; 0: walls do not matter
    contention: bool = False  # one channel for all with carrier sense and collisions
    sealed: bool = True  # frames are encrypted, as a team's are by default
