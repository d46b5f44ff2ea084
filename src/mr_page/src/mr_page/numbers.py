"""Numbers that JSON has. One that it has not would keep a page from telling anything at all."""

from __future__ import annotations

import math


def is_finite(*values: float) -> bool:
    """Whether all of them are."""
    return all(map(math.isfinite, values))


def number(value: float, digits: int) -> float | None:
    """Rounded; None for what is no number."""
    if not math.isfinite(value):
        return None
    return round(value, digits) if digits else round(value)
