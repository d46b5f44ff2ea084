"""Scenes in which robots get stuck, drawn from a seed, and how often they do."""
