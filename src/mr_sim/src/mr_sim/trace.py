"""Writes the truth trace of a run, in the form that `mr_measures.motion` reads."""

from pathlib import Path

import numpy as np

from mr_measures.motion import COLUMNS, TRACE_HEAD


class TraceWriter:
    """Writes a trace to a file; flushes every simulated second."""

    def __init__(self, path: str | Path, world: str, seed: int, real_time_factor: float) -> None:
        self._file = open(path, "w", encoding="utf-8")  # noqa: SIM115 - open until `close`
        self._flush_at = 0.0
        self._file.write(f"{TRACE_HEAD}seed {seed} real_time_factor {real_time_factor:g} world {world}\n")
        self._file.write(",".join(COLUMNS) + "\n")

    def write(self, time: float, wall: float, robot: str, record: np.void) -> None:
        """`record`: one element of `World.states()`."""
        speed = record["velocity_x"] * np.cos(record["yaw"]) + record["velocity_y"] * np.sin(record["yaw"])
        self._file.write(
            f"{time:.3f},{wall:.3f},{robot},{record['x']:.5f},{record['y']:.5f},{record['yaw']:.5f},"
            f"{speed:.4f},{record['velocity_yaw']:.4f},{record['stalled']},{record['contact']}\n"
        )
        if time >= self._flush_at:
            self._file.flush()
            self._flush_at = time + 1.0

    def close(self, simulated: float, wall: float) -> None:
        factor = simulated / wall if wall > 0.0 else 0.0
        self._file.write(f"# end simulated {simulated:.3f} wall {wall:.3f} real_time_factor {factor:.4f}\n")
        self._file.close()
