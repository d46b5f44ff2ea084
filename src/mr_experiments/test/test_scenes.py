"""`rosrun mr_experiments scenes`: the decisions of a mission come out as they were made."""

import pytest

from explorer import scene_file
from explorer.decision import replayed
from explorer.strategies import strategy_of
from mr_experiments.sweep.scenes_command import main


@pytest.mark.parametrize("strategy", [7, 4])
def test_every_decision_of_a_mission_is_replayed_as_it_was_made(tmp_path, capsys, strategy):
    arguments = ["--scenario", "fast", "--robots", "2", "--strategy", str(strategy), "--until", "40"]
    assert main([*arguments, "--out", str(tmp_path)]) == 0
    files = sorted(tmp_path.glob("*/decision_*.json"))
    assert {file.parent.name for file in files} == {"robot_0", "robot_1"} and len(files) >= 6
    assert f"{len(files)} decisions" in capsys.readouterr().out
    read = [scene_file.read(str(file)) for file in files]
    assert any(decision.choice is not None for decision in read)
    for decision in read:
        assert replayed(decision, strategy_of(decision.strategy)) == decision.choice


@pytest.mark.parametrize("arguments", [["--scenario", "none"], ["--strategy", "99"], ["--out", "/dev/null/x"]])
def test_a_bad_call_is_one_line(arguments, capsys):
    assert main(["--scenario", "fast", "--until", "1", *arguments]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_a_world_with_fewer_robots_has_all_of_them(tmp_path):
    world = tmp_path / "one.world"
    world.write_text("""
        define rover position ( size [ 0.44 0.38 0.25 ] ranger ( sensor ( range [ 0 8 ] fov 270 samples 91 ) ) )
        model ( size [ 0.1 4 1 ] pose [ 3 0 0 0 ] )
        rover ( pose [ 0 0 0 0 ] )
    """)
    call = ["--scenario", "fast", "--world", str(world), "--until", "1", "--out", str(tmp_path)]
    assert main(call) == 0
    assert main([*call, "--robots", "3"]) == 2
