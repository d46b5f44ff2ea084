"""Log files of a mission (contract 3.8)."""

from typing import Optional

import numpy as np

from explorer import logs
from explorer.grid import OccupancyMap
from explorer.messages import Emit, LogOutput, WriteLog
from explorer.options import Options
from explorer.status import Counters

LOG_PERIOD = 10.0  # s, contract 3.8
LOG_MAPS, LOG_MAPS_AT_END = 12, 3  # masks of map_merger's logOutput, contract 3.2


class Journal:
    """Of one mission, from `start` on."""

    def __init__(self, options: Options, emit: Emit) -> None:
        self._options, self._emit = options, emit
        self._started_at = 0.0
        self._time = 0.0

    def start(self, now: float) -> None:
        self._started_at = self._time = now

    def due(self, now: float) -> bool:
        return now - self._time >= LOG_PERIOD

    def write(self, counters: Counters, unreachable: int, occupancy: Optional[OccupancyMap], now: float) -> None:
        """Now and then. `unreachable`: number of such frontiers."""
        self._time = now
        values = {
            "time": now - self._started_at,
            "travel_path_overall": counters.distance,
            "average_path": counters.distance / max(1, counters.goals),
            "global_costmap_explored_cells": 0 if occupancy is None else int(np.count_nonzero(occupancy.cells == 0)),
            "local_costmap_explored_cells": -1,
            "fallback_iterations": 0,
            "completed_auctions": counters.auctions_completed,
            "uncompleted_auctions": counters.auctions_uncompleted,
            "frontier_selection_strategy": self._options.frontier_selection,
            "local_costmap_width": self._options.local_costmap_width,
            "unreachable_frontiers": unreachable,
        }
        self._emit(WriteLog("periodical.log", logs.periodical_line(values), append=True))
        self._write_summary("exploration.log.tmp", False, counters, occupancy, now)
        self._log_maps(LOG_MAPS)

    def finish(self, complete: bool, counters: Counters, occupancy: Optional[OccupancyMap], now: float) -> None:
        """At the end of the exploration. `complete`: nothing was left."""
        self._write_summary("exploration.log", complete, counters, occupancy, now)
        self._log_maps(LOG_MAPS_AT_END)

    def _log_maps(self, mask: int) -> None:
        """Without log files here there are none of map_merger either: it refuses the call, which is no failure."""
        if self._options.log_path:
            self._emit(LogOutput(mask))

    def _write_summary(
        self, name: str, complete: bool, counters: Counters, occupancy: Optional[OccupancyMap], now: float
    ) -> None:
        values = {
            "time_file_written": f"{now:.3f}",
            "start_time": f"{self._started_at:.3f}",
            "end_time": f"{now:.3f}",
            "exploration_time": f"{now - self._started_at:.3f}",
            "required_goals": counters.goals,
            "unreachable_goals": counters.goals_failed,
            "travel_path_overall": f"{counters.distance:.3f}",
            "number_of_completed_auctions": counters.auctions_completed,
            "number_of_uncompleted_auctions": counters.auctions_uncompleted,
            "frontier_selection_strategy": self._options.frontier_selection,
            "costmap_size": 0 if occupancy is None else occupancy.cells.size,
            "global costmap iterations": counters.maps,
            "explorer_local_costmap_height": self._options.local_costmap_height,
            "explorer_local_costmap_width": self._options.local_costmap_width,
            "complete": int(complete),
        }
        self._emit(WriteLog(name, logs.exploration_log(values)))
