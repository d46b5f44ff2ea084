"""The commands of `python3 -m explorer`. They need no ROS."""
