"""The folder in which a node of a robot writes its log files."""

import errno
import os


def log_folder(log_path: str, node: str, robot: str) -> str:
    """`<log_path>/<node>/<robot>`, which is made; empty without a path. A "~" is the home folder.

    OSError if it cannot be made or written to; its text says why. A disk that is full is no such error, as it keeps no
    robot from its mission: the folder may then be missing.
    """
    if not log_path:
        return ""
    folder = os.path.join(os.path.expanduser(log_path), node, robot)
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as error:
        if is_full(error):
            return folder
        raise
    if not os.access(folder, os.W_OK | os.X_OK):
        raise PermissionError(f"{folder} cannot be written to")
    return folder


def is_full(error: OSError) -> bool:
    """The disk is full, or what the user may have of it."""
    return error.errno in (errno.ENOSPC, errno.EDQUOT)
