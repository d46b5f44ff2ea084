"""A world that was drawn for a mission is kept with it."""

import os
from pathlib import Path

from mr_launch.world import find_world, keep_generated, robots_of


def test_the_world_files_are_copied_to_the_mission(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    drawn = find_world("generated:office:3:20x15")
    assert Path(drawn).parent == tmp_path / "out" / "worlds"
    (tmp_path / "mission").mkdir()
    kept = keep_generated(drawn, tmp_path / "mission" / "world")
    assert kept == str(tmp_path / "mission" / "world" / "generated-office-3-20x15.world")
    assert sorted(os.listdir(Path(kept).parent)) == [
        "generated-office-3-20x15.png", "generated-office-3-20x15.world", "pioneer.inc",
    ]  # fmt: skip
    assert len(robots_of(kept)) == 16


def test_other_worlds_stay_where_they_are(tmp_path):
    world = find_world("office26x15")
    assert keep_generated(world, tmp_path / "world") == world and not (tmp_path / "world").exists()
