"""Robots that are heard and seen at the same time."""
