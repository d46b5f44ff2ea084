"""Folders of the package import downwards only."""

import re
from pathlib import Path

# What each may import beside itself; those above are not known to those below.
MAY_IMPORT = {
    "common": (),
    "trial": ("common",),
    "host": ("common", "trial"),
    "sweep": ("common", "host", "trial"),
    "bench": ("common", "host", "sweep", "trial"),
    "report": ("common", "trial"),
    "publish": ("bench", "common", "report"),
    "replay": ("common",),
    "worlds": ("common",),
}
FOLDER = Path(__file__).resolve().parents[1] / "src" / "mr_experiments"


def test_every_folder_is_listed():
    folders = {path.parent.relative_to(FOLDER).parts[0] for path in FOLDER.rglob("*.py") if path.parent != FOLDER}
    assert folders == set(MAY_IMPORT)
    assert [path.name for path in FOLDER.glob("*.py")] == ["__init__.py"]


def test_folders_import_downwards_only():
    wrong = []
    for path in FOLDER.rglob("*.py"):
        if path.parent == FOLDER:
            continue
        folder = path.relative_to(FOLDER).parts[0]
        for other in re.findall(r"(?:from|import) mr_experiments\.(\w+)", path.read_text(encoding="utf-8")):
            if other != folder and other not in MAY_IMPORT[folder]:
                wrong.append(f"{path.relative_to(FOLDER)} imports {other}")
    assert not wrong, "\n".join(wrong)
