"""What made a record: the code of this project and the libraries that its figures depend on."""

from __future__ import annotations

import functools
import hashlib
import importlib
import platform
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from types import ModuleType

import numpy as np
import scipy
from rospkg import ResourceNotFound

from mr_grid.imaging import OPENCV_VERSION
from mr_measures.record.ros_packages import folder_of, version_of

PACKAGES = {
    "adhoc_communication": "adhoc_engine", "explorer": "explorer", "map_merger": "map_merger", "mr_grid": "mr_grid",
    "mr_measures": "mr_measures", "mr_plans": "mr_plans", "mr_robot": "mr_robot", "mr_sim": "mr_sim",
    "mr_launch": "mr_launch", "mr_experiments": "mr_experiments",
}  # fmt: skip
"""On which missions of either host depend, with the module of each."""
# What a package is built from: a compiler's output differs between computers that run the same code.
SOURCES = (
    "src/**/*.py", "src/**/*.cpp", "src/**/*.hpp", "include/**/*.hpp", "msg/*.msg", "srv/*.srv", "*.cmake",
    "CMakeLists.txt", "nodes/*", "launch/*.launch", "config/*.yaml", "robots/*.yaml",
)  # fmt: skip
# Not the references of maps beside them, which name the code that made them.
WORLDS = ("*.world", "*.inc", "*.png", "*.pgm", "*.yaml")


def versions(host: str, worlds: Sequence[Path]) -> dict[str, str]:
    """`host`: the package that ran the mission; `worlds`: folders of the project's worlds."""
    return {
        host: version_of(host),
        "code": code_version(tuple(worlds)),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "opencv": OPENCV_VERSION,
        "byteorder": sys.byteorder,
    }


@functools.lru_cache(maxsize=1)
def code_version(worlds: tuple[Path, ...]) -> str:
    """Twelve digits that change with any source, parameter or world of this project that a mission depends on."""
    digest = hashlib.sha256()
    for package, module in PACKAGES.items():
        try:
            folder = folder_of(package)
        except ResourceNotFound:  # not every installation has all of them
            continue
        _add(digest, package, named(folder, SOURCES))
        if not (folder / "src").is_dir():
            _add(digest, package, _installed(importlib.import_module(module)))
    for folder in worlds:
        _add(digest, "worlds", named(folder, WORLDS))
    return digest.hexdigest()[:12]


def named(folder: Path, patterns: Iterable[str]) -> dict[str, Path]:
    """Files by their path below the folder, in its order."""
    paths = {path.relative_to(folder).as_posix(): path for pattern in patterns for path in folder.glob(pattern)}
    return {name: path for name, path in sorted(paths.items()) if path.is_file()}


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
