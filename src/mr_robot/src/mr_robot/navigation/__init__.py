"""Navigation of one robot: planner, controller and behaviour as an engine, and its edge to ROS in ros_io."""
