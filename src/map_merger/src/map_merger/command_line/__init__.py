"""The commands of `python3 -m map_merger`. They need no ROS."""
