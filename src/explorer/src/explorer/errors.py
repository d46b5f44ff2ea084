"""Errors of this package: each message names the culprit and the remedy, so that a node can print it and end."""


class ExplorerError(Exception):
    """Base of all errors raised on purpose by this package."""


class ParameterError(ExplorerError):
    """A parameter is missing, of the wrong type or out of range."""


class MapError(ExplorerError):
    """An occupancy grid cannot be used (size and data disagree, rotated origin, resolution not positive)."""


class SceneError(ExplorerError):
    """A file does not hold a recorded decision."""
