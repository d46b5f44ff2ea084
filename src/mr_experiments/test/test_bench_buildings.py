"""The benchmark of other buildings and robots: which missions, and what its table says."""

import json

import pytest
from made_missions import made_mission, made_robot

from mr_experiments.bench import bench_buildings_command as command
from mr_experiments.bench import mission_set
from mr_experiments.bench.bench_buildings import HUGE, KINDS, Group, table, trials_of
from mr_experiments.bench.mishaps import revoked_though_right
from mr_grid import Pose
from mr_measures.record.files import write_record
from mr_measures.record.robot_record import Contacts, MapFigures, Merge
from mr_measures.record.series import RobotSeries


def robot(walls=0.0, collisions=0, last=(1.0, 2.0), merges=(), died_at=None):
    return made_robot(
        map=MapFigures(wrong_walls=walls),
        died_at=died_at,
        collisions=Contacts(collisions),
        series=RobotSeries(time=(0.0, 1.0), x=(1.0, last[0]), y=(2.0, last[1])),
        merges=tuple(merges),
    )


def record(*robots, seed=1, time=100.0, status="finished"):
    reason = "" if status == "finished" else "limit of 9 s reached"
    return made_mission(robots or (robot(),), status, time, reason, {"seed": seed})


def entry(records, what, kind="turtlebot", team=4):
    (found,) = [row for row in table({Group(kind, team): records}) if row["what"].endswith(what)]
    return found


def merge(at, transform, right=True):
    return Merge("robot_1", at, transform, right=right)


def test_each_kind_has_its_worlds_and_robots():
    groups = trials_of(list(KINDS), range(3, 5), range(3, 4))
    assert {key: len(trials) for key, trials in groups.items() if key.kind in HUGE} == {
        Group("large", 4): 1, Group("many", 8): 1, Group("many", 16): 1}  # fmt: skip
    assert all(trial.robots == key.team for key, trials in groups.items() for trial in trials)
    halls, loops = ([trial.world for trial in groups[Group(kind, 4)]] for kind in ("halls", "loops"))
    assert halls == ["generated:hall:3:48x20", "generated:hall:4:48x20"]
    assert loops == ["generated:loop:3:45x40", "generated:loop:4:45x40"]
    assert all(trial.world.startswith("generated:") for trial in groups[Group("generated", 1)])
    assert {trial.world for trial in groups[Group("mixed", 4)]} == {"office26x15_mixed"}


def test_rows_name_odometry_that_walks():
    groups = trials_of(["turtlebot"], [3], [3], "random_walk")
    assert {trial.odometry for trials in groups.values() for trial in trials} == {"random_walk"}
    assert {row["what"].partition(":")[0] for row in table({next(iter(groups)): [record()]})} == {
        "turtlebot, random walk, R = 1"}  # fmt: skip


def test_a_mission_without_an_end_is_named():
    found = entry([record(), record(seed=7, status="unfinished")], "missions that finished")
    assert not found["holds"] and found["detail"] == "T 100 to 100 s, mean 100 s; seed 7: limit of 9 s reached"


@pytest.mark.parametrize(
    "bad, what, detail",
    [
        (robot(last=(4.0, 6.0)), "did not get home", "seed 1: robot_0 is 5.0 m from home"),
        (robot(collisions=2), "touched something", "seed 1: robot_0"),
        (robot(collisions=2), "contacts", ""),
        (robot(walls=0.2), "wrong walls, worst", "seed 1: robot_0 20 %"),
        (
            robot(merges=[merge(3.0, Pose(1.0)), merge(9.0, None)]),
            "revoked",
            "seed 1: robot_0 of robot_1 at 9 s",
        ),
    ],
)
def test_each_fault_misses_its_bar_and_is_named(bad, what, detail):
    assert entry([record(robot())], what)["holds"]
    found = entry([record(bad, robot())], what)
    assert not found["holds"] and found["detail"] == detail


def test_contacts_are_counted_beside_the_robots_that_had_them():
    records = [record(robot(collisions=2), robot()), record(robot(collisions=3))]
    assert entry(records, "touched something")["value"] == 2 and entry(records, "contacts")["value"] == 5


def test_mixed_teams_keep_transforms_that_are_right():
    """They had no such row."""
    taken_back = robot(merges=[merge(3.0, Pose(1.0)), merge(9.0, None)])
    assert not entry([record(taken_back, robot())], "right transforms revoked", "mixed")["holds"]


def test_robots_that_died_need_no_way_home_and_no_map():
    records = [record(robot(), robot(last=(9.0, 9.0), walls=0.5, died_at=30.0))]
    assert entry(records, "did not get home")["holds"] and entry(records, "wrong walls, worst")["value"] == 0.0


def test_only_transforms_that_were_right_count_when_they_are_taken_back():
    wrong = robot(
        merges=[merge(1.0, Pose(), right=False), merge(2.0, None), merge(3.0, Pose(1.0)), merge(4.0, Pose(2.0))]
    )
    assert revoked_though_right(record(wrong)) == []


def test_a_run_goes_on(tmp_path, monkeypatch, capsys):
    """No mission is run: the pool is one that runs none."""
    ran = []

    def follow(pool, trials, folder, console, line):
        for trial in trials:
            ran.append(trial.seed)
            write_record(record(seed=trial.seed), folder / f"{trial.key}.json")

    monkeypatch.setattr(mission_set, "follow", follow)
    monkeypatch.setattr(
        mission_set, "left_for_this_code", lambda trials, folder: [t for t in trials if t.seed not in ran]
    )
    arguments = ["--out", str(tmp_path / "buildings.json"), "--only", "mixed", "--first-seed", "3"]
    assert command.main([*arguments, "--trials", "1"]) == 0
    assert command.main([*arguments, "--trials", "2"]) == 0 and ran == [3, 4]
    assert json.loads((tmp_path / "buildings.json").read_text())[0]["value"] == 2
    assert "1 of 2 missions to run" in capsys.readouterr().out


def test_missions_of_either_odometry_have_records_of_their_own(tmp_path, monkeypatch):
    def records_of_all(trials, folder, jobs, console):
        asked.update({(folder.name, trial.odometry) for trial in trials})
        return [record(seed=trial.seed) for trial in trials]

    asked = set()
    monkeypatch.setattr(command, "records_of_all", records_of_all)
    arguments = ["--out", str(tmp_path / "b.json"), "--only", "turtlebot", "--odometry", "bias", "random_walk"]
    command.main([*arguments, "--trials", "1"])
    assert asked == {("b", "bias"), ("random_walk", "random_walk")}
    names = {row["what"].partition(":")[0] for row in json.loads((tmp_path / "b.json").read_text())}
    assert {"turtlebot, R = 1", "turtlebot, random walk, R = 1"} <= names


def test_missions_of_some_team_sizes(tmp_path, monkeypatch):
    def records_of_all(trials, folder, jobs, console):
        return [record(robot(), seed=trial.seed) for trial in trials]

    monkeypatch.setattr(command, "records_of_all", records_of_all)
    command.main(["--out", str(tmp_path / "b.json"), "--only", "many", "narrow", "--robots", "4", "8", "--trials", "1"])
    names = {row["what"].partition(":")[0] for row in json.loads((tmp_path / "b.json").read_text())}
    assert names == {"many, R = 8", "narrow, R = 4"}


def test_bad_calls(capsys):
    assert command.main(["--huge-trials", "0"]) == 2 and "--huge-trials" in capsys.readouterr().err
    assert command.main(["--only", "large", "--robots", "3", "5"]) == 2
    assert "no team of large has 3 or 5 robots" in capsys.readouterr().err
    assert command.main(["--only", "moon"]) == 2
