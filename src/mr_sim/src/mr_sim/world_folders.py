"""Where the project's worlds are, in a source tree or an install space."""

from pathlib import Path


def world_folders() -> list[Path]:
    """Folders with worlds, nearest first: `worlds/` of the source tree, `share/mr_sim/worlds` when installed."""
    parents = Path(__file__).resolve().parents
    candidates = [parent / place for parent in parents for place in ("worlds", "share/mr_sim/worlds")]
    return [folder for folder in candidates if folder.is_dir() and any(folder.glob("*.world"))]
