"""Stage worlds without Stage: the simulator."""
