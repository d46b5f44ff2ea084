"""A time axis that shows what happens early in detail and still reaches to what happens much later."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, MaxNLocator

from mr_experiments.report.figure_style import INK

DETAIL = 0.72  # share of the axis before the bend
LONG = 1.4  # the axis is bent when its end lies farther than this multiple of the detailed part


@dataclass(frozen=True)
class TimeAxis:
    """Linear from 0 to `bend`, then linear with a smaller scale to `end`; all in s. Not bent when both are equal."""

    bend: float
    end: float

    @classmethod
    def showing(cls, detail: float, end: float) -> TimeAxis:
        """Everything to `detail` in full, and all to `end`."""
        return cls(detail, end) if end > LONG * detail else cls(max(detail, end), max(detail, end))

    @property
    def bent(self) -> bool:
        return self.end > self.bend

    def position(self, time: np.ndarray) -> np.ndarray:
        """Place on the axis, 0 to 1."""
        if not self.bent:
            return np.asarray(time) / self.end
        return np.interp(time, [0.0, self.bend, self.end], [0.0, DETAIL, 1.0])

    def time(self, position: np.ndarray) -> np.ndarray:
        """Inverse of `position`."""
        if not self.bent:
            return np.asarray(position) * self.end
        return np.interp(position, [0.0, DETAIL, 1.0], [0.0, self.bend, self.end])

    def apply(self, axes: Axes) -> None:
        axes.set_xscale("function", functions=(self.position, self.time))
        axes.set_xlim(0.0, self.end)
        axes.set_xlabel("time in s")
        axes.xaxis.set_major_locator(FixedLocator(self._ticks()))
        axes.xaxis.set_minor_locator(FixedLocator([]))
        if self.bent:
            axes.axvspan(self.bend, self.end, color=INK, alpha=0.05, linewidth=0, zorder=0)
            axes.annotate(
                "time axis compressed",
                (self.end, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(-4, 3),
                textcoords="offset points",
                ha="right",
                fontsize=8,
                alpha=0.75,
            )

    def _ticks(self) -> list[float]:
        ticks = [float(t) for t in MaxNLocator(6, steps=[1, 2, 5, 10]).tick_values(0.0, self.bend) if t <= self.bend]
        if self.bent:
            late = MaxNLocator(3, steps=[1, 2, 5, 10]).tick_values(self.bend, self.end)
            gap = 0.06 * (self.end - self.bend) / (1.0 - DETAIL)
            ticks += [float(t) for t in late if self.bend + gap < t <= self.end]
        return ticks
