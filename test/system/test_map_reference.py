"""The stored one-robot missions, against which the map error is measured, are those of today's engines."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WORLD = "small8x8"


def test_stored_mission_can_be_repeated(tmp_path):
    for source in ("pioneer.inc", f"{WORLD}.world"):
        shutil.copy(ROOT / "worlds" / source, tmp_path)
    command = [sys.executable, str(ROOT / "tools" / "store_map_reference"), str(tmp_path / f"{WORLD}.world")]
    result = subprocess.run([*command, "--missions", "1"], capture_output=True, text=True, timeout=120, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
    stored = json.loads((ROOT / "worlds" / f"{WORLD}.reference.json").read_text())
    repeated = json.loads((tmp_path / f"{WORLD}.reference.json").read_text())
    assert abs(repeated["median"] / stored["median"] - 1.0) < 0.01
    assert repeated["missions"][0]["seed"] == stored["missions"][0]["seed"]
