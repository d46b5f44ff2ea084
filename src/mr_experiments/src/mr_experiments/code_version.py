"""Which code a record was made with."""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path
from types import ModuleType

import adhoc_engine

import explorer
import map_merger
import mr_experiments
import mr_plans
import mr_sim
from mr_experiments.ros_packages import folder_of


@functools.lru_cache(maxsize=1)
def code_version() -> str:
    """Twelve digits that change with any module or parameter that a mission depends on."""
    digest = hashlib.sha256(Path(str(adhoc_engine.__file__)).read_bytes())
    for package in (explorer, map_merger, mr_plans, mr_sim, mr_experiments):
        for path in _modules(package):
            digest.update(path.name.encode() + path.read_bytes())
    for path in sorted((folder_of("mr_launch") / "config").glob("*.yaml")):
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()[:12]


def _modules(package: ModuleType) -> list[Path]:
    """Those that are imported: of each name the first in the folders of the package, of which a devel space has several
    and an overlay more. `__init__` is left out, because a devel space has one that names its path."""
    found: dict[str, Path] = {}
    for folder in map(Path, package.__path__):
        for path in sorted([*folder.glob("*.so"), *folder.rglob("*.py")]):
            found.setdefault(str(path.relative_to(folder)), path)
    return [found[name] for name in sorted(found) if not name.endswith("__init__.py")]
