"""Finds frontiers in the global map and shares them out among the robots by auction and the Hungarian method."""
