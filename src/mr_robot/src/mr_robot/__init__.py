"""Local SLAM and navigation of one robot, simulated or real, and what is known of it."""
