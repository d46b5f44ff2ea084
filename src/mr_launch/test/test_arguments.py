"""Bad input gives one message that names the culprit; nothing is started."""

import pytest

from mr_grid import Pose
from mr_launch.arguments import choose_robots, parse_arguments
from mr_launch.commands import make_output_folder
from mr_launch.errors import UserError
from mr_launch.plan import Plan, RobotPlan


def test_defaults():
    options = parse_arguments([], now=0.0)
    assert (options.world, options.range, options.loss, options.rtf, options.duration) == (
        "office26x15",
        10,
        0.05,
        1,
        900,
    )
    assert options.wall_attenuation == 0.0
    assert options.robots is None and options.bag and not options.initial_poses
    assert options.out.startswith("out/1970-01-01_") or options.out.startswith("out/1969-12-31_")


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        (["--range", "0"], "--range 0 is out of range"),
        (["--range", "nan"], "--range nan is out of range"),
        (["--loss", "1"], "--loss 1 is out of range"),
        (["--loss", "-0.1"], "--loss -0.1 is out of range"),
        (["--wall-attenuation", "-1"], "--wall-attenuation -1 is out of range"),
        (["--rtf", "-1"], "--rtf -1 is out of range"),
        (["--rtf", "inf"], "--rtf inf is out of range"),
        (["--duration", "0"], "--duration 0 is out of range"),
        (["--seed", "-5"], "--seed -5 is out of range"),
        (["--time-limit", "-1"], "--time-limit -1: parameter ~time_limit is -1.0, out of range"),
        (["--distance-limit", "nan"], "--distance-limit nan: parameter ~distance_limit is nan, out of range"),
        (["--robots", "0"], "--robots 0: a team has at least one robot"),
        (["--robots", "two"], "argument --robots: invalid int value: 'two'"),
        (["--strategy", "8"], "--strategy: strategy 8 is unknown; there are 0 nearest_path, 1 auction"),
        (["--strategy", "best"], "and those that EXPLORER_STRATEGIES=FILE.py:Class names"),
        (["--strategy", "x.py:Mine"], "'x.py:Mine': set EXPLORER_STRATEGIES=x.py:Mine, then give its number or name"),
        (
            ["--slam", "karto"],
            "argument --slam: 'karto' is unknown; there are ours, gmapping, slam_toolbox, hector, and FILE",
        ),
        (["--navigation", "/no.launch"], "argument --navigation: there is no file '/no.launch'"),
        (["--out", "out/o'neil"], "o'neil has a ' in it, which launch files do not take"),
        (["--out", "out/x,y"], "out/x,y has a , in it"),
        (["--out", 'out/"x"'], 'has a " in it'),
        (["--wrold", "x"], "unrecognized arguments: --wrold x"),
    ],
)
def test_bad_values(arguments, culprit):
    with pytest.raises(UserError) as error:
        parse_arguments(arguments)
    assert culprit in str(error.value)
    assert "\n" not in str(error.value)


def test_robots_come_in_the_order_of_the_world():
    assert choose_robots(2, ["b", "a", "c"], "w") == ["b", "a"]
    assert choose_robots(None, ["b", "a"], "w") == ["b", "a"]
    assert choose_robots(None, list("abcd"), "w") == list("abc")
    assert choose_robots(1, ["a_-.Z9", "what is not chosen"], "w") == ["a_-.Z9"]


@pytest.mark.parametrize(
    ("asked", "names", "culprit"),
    [
        (3, ["a", "b"], "--robots 3, but my.world has 2: a, b"),
        (1, ["a", "b", "a"], "my.world uses the robot name a more than once"),
        (None, [], "my.world holds no robot"),
        (None, ["a", "Robot 1"], "my.world has a robot named 'Robot 1'; a name has 1 to 64 letters"),
        (None, ["mc_a"], "my.world has a robot named 'mc_a'; a name .* does not begin with mc_"),
        (None, ["../../escaped"], "robot named '../../escaped'"),
        (None, [".."], "robot named '..'"),
        (None, ["logs"], "robot named 'logs'"),
        (None, ["r/0"], "robot named 'r/0'"),
        (None, ["a\n"], "robot named"),
        (None, ["ü"], "robot named"),
        (None, ["x" * 65], "robot named 'x"),
    ],
)
def test_robots_that_the_world_cannot_give(asked, names, culprit):
    with pytest.raises(UserError, match=culprit):
        choose_robots(asked, names, "my.world")


def plan_with(out):
    options = parse_arguments(["--out", str(out)])
    return Plan(options, "w", [RobotPlan("a", 0, 11311, Pose(0.0, 0.0, 0.0))], str(out), "hub")


def test_output_folder_must_be_empty(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(UserError, match="exists and is not an empty folder"):
        make_output_folder(plan_with(tmp_path))
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_output_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="cannot write to the output folder"):
        make_output_folder(plan_with(tmp_path / "file" / "out"))


def test_output_folder_that_nobody_may_look_into(tmp_path, monkeypatch):
    """Once that was a traceback."""

    def refuse(path):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr("pathlib.Path.exists", refuse)
    with pytest.raises(UserError, match=r"cannot write to the output folder .*: Permission denied"):
        make_output_folder(plan_with(tmp_path / "out"))


def test_a_launch_file_of_ones_own_is_found_from_anywhere(tmp_path, monkeypatch):
    (tmp_path / "own.launch").touch()
    monkeypatch.chdir(tmp_path)
    assert parse_arguments(["--slam", "own.launch"]).slam == str(tmp_path / "own.launch")


def test_strategies_have_names_and_numbers():
    assert [parse_arguments(["--strategy", key]).strategy for key in ("0", "nearest_path", "coordinated")] == [0, 0, 7]
