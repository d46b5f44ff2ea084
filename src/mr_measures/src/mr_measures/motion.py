"""True motion: what every robot really did, as record arrays and as the truth trace that a simulator writes.

A trace is a text file. Lines with `#` are remarks: the first names world, seed and wanted real-time factor, the last
(`# end simulated S wall W real_time_factor F`) is there only after an orderly end. All others are CSV rows, one per
robot and base update, in the order of `COLUMNS`: simulated and wall seconds since the world began to move, the robot's
name, true pose (m, rad), true forward speed (m/s) and turn rate (rad/s), whether it was blocked in this step, and what
its footprint would have overlapped had it not been (0 nothing, 1 a wall, 2 another robot).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

TRACE_HEAD = "# mr_sim trace 1 "
COLUMNS = ("time", "wall", "robot", "x", "y", "yaw", "v", "w", "stalled", "collision")

RECORD = np.dtype(
    [("time", "f8"), ("wall", "f8"), ("x", "f8"), ("y", "f8"), ("yaw", "f8"), ("v", "f8"), ("w", "f8"),
     ("stalled", "u1"), ("collision", "u1")]
)  # fmt: skip

Row = tuple[float, ...]
"""A row of a trace as the fields of `RECORD`."""


class TraceError(ValueError):
    """A file that is not a truth trace."""


@dataclass(frozen=True)
class Trace:
    """`robots`: per name a record array with the fields of COLUMNS without `robot`, in time order."""

    robots: dict[str, np.ndarray]
    real_time_factor: float | None  # achieved; None when the run did not end in order


def row_of(line: str) -> tuple[str, Row] | None:
    """Robot and row of a line; None for a remark or the line with the columns. ValueError if it is none of these."""
    if line.startswith(("#", "time,")):
        return None
    fields = line.rstrip("\r\n").split(",")
    if len(fields) != len(COLUMNS):
        raise ValueError(f"{len(fields)} fields instead of {len(COLUMNS)}")
    return fields[2], tuple(float(value) for value in (*fields[:2], *fields[3:]))


def records_of(rows: Sequence[Row]) -> np.ndarray:
    """Record array with the fields of COLUMNS without `robot`."""
    return np.array(rows, dtype=RECORD)


def read_trace(path: str | Path) -> Trace:
    """Read a trace; a last line cut short by a crash is left out. Raises TraceError."""
    rows: dict[str, list[Row]] = {}
    factor: float | None = None
    with open(path, encoding="utf-8") as file:
        if not file.readline().startswith(TRACE_HEAD):
            raise TraceError(f"{path} is not a truth trace of mr_sim")
        for number, line in enumerate(file, start=2):
            if line.startswith("# end "):
                factor = float(line.split()[-1])
            if not line.endswith("\n"):
                continue
            try:
                row = row_of(line)
            except ValueError as error:
                raise TraceError(f"{path}:{number}: not a row of a truth trace") from error
            if row is not None:
                rows.setdefault(row[0], []).append(row[1])
    return Trace({name: records_of(values) for name, values in rows.items()}, factor)
