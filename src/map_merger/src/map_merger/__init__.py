"""Merges the local maps of all robots into one global map and keeps the transforms between them."""
