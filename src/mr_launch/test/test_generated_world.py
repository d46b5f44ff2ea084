"""A world that was drawn for a mission is kept with it."""

import os
from pathlib import Path

import pytest

from mr_launch.arguments import parse_arguments
from mr_launch.begun import asked_settings
from mr_launch.commands import make_plan
from mr_launch.errors import UserError
from mr_launch.world import find_world, keep_generated, robots_of
from mr_sim.world_names import name_of


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


@pytest.fixture
def map_file(tmp_path, monkeypatch):
    """A room of 5 m x 5 m."""
    monkeypatch.chdir(tmp_path)
    rows = [b"\xfe" * 100] * 100
    (tmp_path / "plan.pgm").write_bytes(b"P5 100 100 255\n" + b"".join(rows))
    (tmp_path / "plan.yaml").write_text("image: plan.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n")
    return "plan.yaml"


def test_robots_of_a_team_stand_in_a_map(map_file, tmp_path):
    drawn = find_world(map_file, [1.0, 1.0, 90.0, 3.0, 1.0, 0.0, 3.0, 3.0, 0.0, 1.0, 3.0, 0.0])
    assert [(name, pose[:2]) for name, pose in robots_of(drawn)][:2] == [
        ("robot_0", (1.0, 1.0)),
        ("robot_1", (3.0, 1.0)),
    ]
    kept = keep_generated(drawn, tmp_path / "world")
    assert Path(kept).parent == tmp_path / "world" and robots_of(kept) == robots_of(drawn)


def test_a_start_that_nobody_gave_is_told(map_file, capsys):
    plan = make_plan(parse_arguments(["--world", map_file]))
    assert [robot.name for robot in plan.robots] == ["robot_0"]
    told = capsys.readouterr().err
    assert "plan.yaml: one robot where there is most room, at 2.48 2.48 0;" in told and "--starts X Y DEGREES" in told
    make_plan(parse_arguments(["--world", map_file, "--starts", "1", "1", "0"]))
    assert "most room" not in capsys.readouterr().err
    with pytest.raises(UserError, match="--robots 2: a map says no starts; give --starts X Y DEGREES for each robot"):
        make_plan(parse_arguments(["--world", map_file, "--robots", "2"]))


@pytest.mark.parametrize(
    ("world", "starts", "told"),
    [
        ("plan.yaml", [1.0, 1.0], "--starts takes X Y DEGREES"),
        ("small8x8", [1.0, 1.0, 0.0], "--starts are for a map"),
        ("none.yaml", [1.0, 1.0, 0.0], 'no world "none.yaml"'),
    ],
)
def test_starts_that_do_not_fit_are_told(map_file, world, starts, told):
    with pytest.raises(UserError, match=told):
        find_world(world, starts)


@pytest.mark.parametrize("given", ["flat.world", "./flat.world", "link.world", "{whole}"])
def test_a_world_has_one_path_and_one_name_in_records(tmp_path, monkeypatch, given):
    monkeypatch.chdir(tmp_path)
    whole = tmp_path.resolve() / "flat.world"
    whole.write_text(
        'model ( size [ 0.1 8 1 ] pose [ 4 0 0 0 ] ) position ( name "a" ranger ( sensor ( samples 9 ) ) )'
    )
    Path("link.world").symlink_to(whole)
    plan = make_plan(parse_arguments(["--world", given.format(whole=whole), "--out", "o"]))
    assert plan.world == asked_settings(plan)["world"] == str(whole)


def test_a_link_beside_another_picture_is_the_world_that_it_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for folder, dark in (("one", 3), ("two", 5)):
        Path(folder).mkdir()
        rows = [b"\0" * 9] * dark + [b"\xff" * 9] * (9 - dark)
        Path(folder, "plan.pgm").write_bytes(b"P5 9 9 255\n" + b"".join(rows))
    Path("one/flat.world").write_text('model ( bitmap "plan.pgm" size [ 2 2 1 ] pose [ 9 9 0 0 ] )')
    Path("two/flat.world").symlink_to(tmp_path / "one" / "flat.world")
    assert find_world("two/flat.world") == name_of("two/flat.world") == str(tmp_path.resolve() / "two" / "flat.world")
