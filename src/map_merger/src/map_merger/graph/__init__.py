"""The team as a graph: robots, and the transforms between their frames that anybody has found."""
