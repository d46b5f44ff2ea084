"""Stage worlds without Stage: the simulator, and measures of what robots did in them."""
