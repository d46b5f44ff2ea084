"""Where this stack's ROS packages are."""

from __future__ import annotations

import functools
from pathlib import Path

import rospkg


@functools.lru_cache(maxsize=1)
def _packages() -> rospkg.RosPack:
    """Looks through all folders of packages, which takes long."""
    return rospkg.RosPack()


def folder_of(package: str) -> Path:
    return Path(_packages().get_path(package))


def version_of(package: str) -> str:
    return str(_packages().get_manifest(package).version)
