"""Which code a record was made with."""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path
from types import ModuleType
from typing import Iterable

import adhoc_engine

import explorer
import map_merger
import mr_experiments
import mr_grid
import mr_measures
import mr_plans
import mr_robot
import mr_sim
from mr_experiments.common.ros_packages import folder_of
from mr_sim.worlds import world_folders

IMPORTED = {
    "adhoc_communication": adhoc_engine, "explorer": explorer, "map_merger": map_merger, "mr_grid": mr_grid,
    "mr_measures": mr_measures, "mr_plans": mr_plans, "mr_robot": mr_robot, "mr_sim": mr_sim,
    "mr_experiments": mr_experiments,
}  # fmt: skip
# What a package is built from: a compiler's output differs between computers that run the same code.
SOURCES = (
    "src/**/*.py", "src/**/*.cpp", "src/**/*.hpp", "include/**/*.hpp", "msg/*.msg", "srv/*.srv", "*.cmake",
    "CMakeLists.txt",
)  # fmt: skip
# Not the references of maps beside them, which name the code that made them.
WORLDS = ("*.world", "*.inc", "*.png", "*.pgm", "*.yaml")


@functools.lru_cache(maxsize=1)
def code_version() -> str:
    """Twelve digits that change with any source, parameter or world of this project that a mission depends on."""
    digest = hashlib.sha256()
    for package, module in IMPORTED.items():
        folder = folder_of(package)
        is_source_tree = (folder / "src").is_dir()
        _add(digest, package, named(folder, SOURCES) if is_source_tree else _installed(module))
    _add(digest, "parameters", named(folder_of("mr_launch") / "config", ["*.yaml"]))
    for worlds in world_folders():
        _add(digest, "worlds", named(worlds, WORLDS))
    return digest.hexdigest()[:12]


def named(folder: Path, patterns: Iterable[str]) -> dict[str, Path]:
    """Files by their path below the folder, in its order."""
    paths = {path.relative_to(folder).as_posix(): path for pattern in patterns for path in folder.glob(pattern)}
    return dict(sorted(paths.items()))


def _add(digest: hashlib._Hash, what: str, files: dict[str, Path]) -> None:
    for name, path in files.items():
        digest.update(f"{what}/{name}\0".encode() + hashlib.sha256(path.read_bytes()).digest())


def _installed(module: ModuleType) -> dict[str, Path]:
    """An install space holds no sources of what is compiled; there the compiled modules stand for them."""
    if not hasattr(module, "__path__"):
        return {"module": Path(str(module.__file__))}
    return {str(number): path for number, path in enumerate(_modules(module))}


def _modules(package: ModuleType) -> list[Path]:
    """Those that are imported: of each name the first in the folders of the package, of which an overlay has several.
    `__init__` is left out, because a devel space has one that names its path."""
    found: dict[str, Path] = {}
    for folder in map(Path, package.__path__):
        for path in sorted([*folder.glob("*.so"), *folder.rglob("*.py")]):
            found.setdefault(str(path.relative_to(folder)), path)
    return [found[name] for name in sorted(found) if not name.endswith("__init__.py")]
