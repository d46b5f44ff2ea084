"""Local SLAM of one robot: the engine, and its edge to ROS in ros_io."""
