"""Writes the truth trace of a run, in the form that `mr_measures.motion` reads."""

import contextlib
from pathlib import Path
from typing import Callable, TextIO

import numpy as np

from mr_measures.motion import COLUMNS, TRACE_HEAD


class TraceWriter:
    """Writes a trace to a file; flushes every simulated second. On a full disk the trace ends and the world goes on;
    `say` is told once."""

    def __init__(
        self,
        path: str | Path,
        world: str,
        seed: int,
        real_time_factor: float,
        say: Callable[[str], None] = lambda text: None,
    ) -> None:
        self._file: TextIO | None = open(path, "w", encoding="utf-8")  # noqa: SIM115 - open until `close`
        self._path = path
        self._say = say
        self._flush_at = 0.0
        self._add(f"{TRACE_HEAD}seed {seed} real_time_factor {real_time_factor:g} world {world}\n")
        self._add(",".join(COLUMNS) + "\n")

    def write(self, time: float, wall: float, robot: str, record: np.void) -> None:
        """`record`: one element of `World.states()`."""
        speed = record["velocity_x"] * np.cos(record["yaw"]) + record["velocity_y"] * np.sin(record["yaw"])
        self._add(
            f"{time:.3f},{wall:.3f},{robot},{record['x']:.5f},{record['y']:.5f},{record['yaw']:.5f},"
            f"{speed:.4f},{record['velocity_yaw']:.4f},{record['stalled']},{record['contact']}\n"
        )
        if time >= self._flush_at:
            self._add("", flush=True)
            self._flush_at = time + 1.0

    def close(self, simulated: float, wall: float) -> None:
        factor = simulated / wall if wall > 0.0 else 0.0
        self._add(f"# end simulated {simulated:.3f} wall {wall:.3f} real_time_factor {factor:.4f}\n", flush=True)
        self._end()

    def _add(self, text: str, flush: bool = False) -> None:
        if self._file is None:
            return
        try:
            self._file.write(text)
            if flush:
                self._file.flush()
        except OSError as error:
            self._say(f"{self._path}: {error.strerror}; the trace ends here")
            self._end()

    def _end(self) -> None:
        """Closing writes what is left, which a full disk refuses once more."""
        if self._file is not None:
            with contextlib.suppress(OSError):
                self._file.close()
        self._file = None
