"""Where the project's worlds are, in a source tree and in an install space."""

from pathlib import Path


class WorldNotFoundError(ValueError):
    """No world of that name."""


def world_folders() -> list[Path]:
    """Folders with worlds, nearest first: `worlds/` of the source tree, `share/mr_sim/worlds` when installed."""
    parents = Path(__file__).resolve().parents
    candidates = [parent / place for parent in parents for place in ("worlds", "share/mr_sim/worlds")]
    return [folder for folder in candidates if folder.is_dir() and any(folder.glob("*.world"))]


def find_world(name: str) -> Path:
    """Path of a world: `name` is a path, or the name of one of the project's worlds with or without `.world`."""
    path = Path(name)
    if path.is_file():
        return path
    names = [name] if name.endswith(".world") else [name, f"{name}.world"]
    for folder in world_folders():
        for candidate in names:
            if "/" not in name and (folder / candidate).is_file():
                return folder / candidate
    known = sorted({world.stem for folder in world_folders() for world in folder.glob("*.world")})
    raise WorldNotFoundError(f'no world "{name}": give the path of a .world file or one of: {", ".join(known)}')
