"""Texts of the log files of contract 3.8."""

from typing import Dict, List, Mapping, Sequence

PERIODICAL_HEADER = (
    "#time\ttravel_path_overall\taverage_path\tglobal_costmap_explored_cells\tlocal_costmap_explored_cells\t"
    "fallback_iterations\tcompleted_auctions\tuncompleted_auctions\tfrontier_selection_strategy\t"
    "local_costmap_width\tunreachable_frontiers\n"
)

EXPLORATION_KEYS: Sequence[str] = (
    "time_file_written",
    "start_time",
    "end_time",
    "exploration_time",
    "required_goals",
    "unreachable_goals",
    "travel_path_overall",
    "number_of_completed_auctions",
    "number_of_uncompleted_auctions",
    "frontier_selection_strategy",
    "costmap_size",
    "global costmap iterations",
    "explorer_local_costmap_height",
    "explorer_local_costmap_width",
    "move_base_local_costmap_height",
    "move_base_local_costmap_width",
    "move_base_raytrace_range",
    "move_base_obstacle_range",
    "explorer_raytrace_range",
    "explorer_obstacle_range",
    "complete",
)


def exploration_log(values: Mapping[str, object]) -> str:
    """INI text with the keys of the contract in its order; -1 for what this implementation does not have."""
    lines: List[str] = ["[Exploration]"]
    lines += [f"{key}={values.get(key, -1)}" for key in EXPLORATION_KEYS]
    return "\n".join(lines) + "\n"


def periodical_line(values: Dict[str, float]) -> str:
    """One line of periodical.log: as many values as the header has names."""
    names = PERIODICAL_HEADER[1:].split()
    return "\t".join(f"{values.get(name, -1):g}" for name in names) + "\n"
