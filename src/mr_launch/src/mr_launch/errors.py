"""Errors that people see: one message, no traceback."""


class UserError(Exception):
    """The call cannot be carried out; the text names the culprit and the remedy. Nothing has been started."""


class TeamFailure(Exception):
    """A running team cannot go on; the text names the part that failed and its log file."""
