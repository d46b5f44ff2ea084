"""`rosrun mr_launch doctor`: what is wrong with one robot, and what to do about it."""
