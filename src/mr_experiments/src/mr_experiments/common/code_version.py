"""Which code a record of this package is made with."""

from __future__ import annotations

from mr_measures.record import versions
from mr_sim.world_folders import world_folders


def code_version() -> str:
    """As in `mr_measures.record.versions`."""
    return versions.code_version(tuple(world_folders()))
