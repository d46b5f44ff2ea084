"""What can be known of generated worlds, computed when it is first asked for and kept beside the world's files."""

import contextlib
import hashlib
import os
import tempfile
import zipfile
from pathlib import Path

import numpy as np

from mr_measures import truth as definition
from mr_measures.true_world import TrueWorld
from mr_measures.truth import KnowableArea, Truth


def stored_path(world: Path) -> Path:
    """Where the known area of a world file is kept."""
    return world.with_suffix(".knowable.npz")


def truth_of_generated(world: TrueWorld, path: Path) -> Truth:
    """As `Truth.of_world`, for a world whose free space is connected, so that it is the same from all starts. `path`:
    of its world file. What is stored counts only for the same walls, robots and definition."""
    key, file = _key(world), stored_path(path)
    known = _load(file, key)
    truth = Truth.of_world(world, known)
    if known is None:
        with contextlib.suppress(OSError):  # the next one computes it again
            _store(file, key, truth)
    return truth


def _key(world: TrueWorld) -> str:
    robot, walls = world.robots[0], world.visible
    digest = hashlib.sha256(Path(str(definition.__file__)).read_bytes() + walls.cells.tobytes())
    digest.update(repr((walls.info, robot.footprint, robot.range_max)).encode())
    return digest.hexdigest()


def _load(file: Path, key: str) -> KnowableArea | None:
    try:
        with np.load(file, allow_pickle=False) as stored:
            if str(stored["key"]) != key:
                return None
            shape = tuple(stored["shape"].tolist())
            cells = np.unpackbits(stored["cells"], count=int(np.prod(shape))).reshape(shape).astype(bool)
            return KnowableArea(stored["viewpoints"], cells)
    except (OSError, ValueError, KeyError, zipfile.BadZipFile):
        return None


def _store(file: Path, key: str, truth: Truth) -> None:
    with tempfile.NamedTemporaryFile(dir=file.parent, prefix=file.name, delete=False) as partial:
        np.savez(
            partial, key=np.array(key), shape=np.array(truth.knowable.shape), cells=np.packbits(truth.knowable),
            viewpoints=truth.viewpoints,
        )  # fmt: skip
    os.chmod(partial.name, 0o644)
    os.replace(partial.name, file)
