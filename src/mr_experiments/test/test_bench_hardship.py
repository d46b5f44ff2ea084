"""The benchmark of hardship: which missions, and what its table says."""

import json

import pytest
from made_missions import made_mission, made_robot

from mr_experiments.bench import bench_hardship_command as command
from mr_experiments.bench import mission_set
from mr_experiments.bench.bench_hardship import HARDSHIPS, LARGE, table, trials_of
from mr_measures.record.files import write_record
from mr_measures.record.robot_record import Contacts, MapFigures
from mr_measures.record.series import RobotSeries


def record(scenario="paper", robots=4, seed=1, time=100.0, status="finished", coverage=1.0, died_at=None):
    members = [made_robot(map=MapFigures(coverage=coverage)) for _ in range(robots)]
    members[1] = made_robot(map=MapFigures(coverage=0.2 if died_at else coverage), died_at=died_at)
    reason = "" if status == "finished" else "limit of 9 s reached"
    return made_mission(members, status, time, reason, {"scenario": scenario, "seed": seed})


def entry(records, what):
    (found,) = [row for row in table(records) if row["what"].startswith(what)]
    return found


def test_each_hardship_gets_the_same_seeds_and_the_large_floor_its_own():
    trials = trials_of([*HARDSHIPS, LARGE], [5, 6], [5])
    assert len(trials) == 2 * len(HARDSHIPS) + 2
    assert [trial.robots for trial in trials if trial.scenario == LARGE] == [4, 8]
    assert {trial.partition for trial in trials if trial.scenario == "partition"} == {(40.0, 100.0)}
    assert {trial.radio.loss for trial in trials if trial.scenario == "loss30"} == {0.3}
    deaths = [trial.deaths[1] for trial in trials if trial.scenario == "killed"]
    assert len(set(deaths)) == 2 and all(10.0 <= time <= 100.0 for time in deaths)


def test_a_mission_that_does_not_finish_misses_the_bar_and_is_named():
    found = entry([record(), record(seed=2, status="unfinished")], "paper, R = 4: missions")
    assert (found["value"], found["holds"]) == (1, False) and found["detail"] == "seed 2: limit of 9 s reached"


def test_one_mission_has_no_interval():
    assert entry([record()], "paper, R = 4: mean T")["detail"] == "100 to 100 s"
    assert entry([record(), record(time=120.0)], "paper, R = 4: mean T")["detail"] == "+- 19.6 s (95 %), 100 to 120 s"


def test_the_map_of_a_robot_that_died_does_not_count():
    assert entry([record("killed", died_at=50.0)], "killed, R = 4: coverage, worst")["value"] == 1.0


def test_contacts_and_robots_that_are_not_home_are_counted():
    lost = made_robot(series=RobotSeries(time=(0.0, 1.0), x=(1.0, 9.0), y=(2.0, 2.0)), collisions=Contacts(1, 2))
    records = [made_mission([made_robot(), lost], settings={"scenario": "paper"})]
    for what, count in (("paper, R = 2: robots that did not", 1), ("paper, R = 2: contacts", 3)):
        found = entry(records, what)
        assert (found["value"], found["holds"]) == (count, False)


def test_the_short_radio_is_compared_seed_by_seed():
    records = [record(), record(seed=2, time=300.0), record("range8", time=130.0), record("range8", seed=3)]
    found = entry(records, "mean T with a radio of 8 m")
    assert found["value"] == pytest.approx(1.3) and not found["holds"] and found["detail"] == "1 seeds"
    assert all("radio of 8 m" not in row["what"] for row in table([record()]))


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
    arguments = ["--out", str(tmp_path / "hardship.json"), "--only", "paper", "--first-seed", "3"]
    assert command.main([*arguments, "--trials", "1"]) == 0
    assert command.main([*arguments, "--trials", "2"]) == 0 and ran == [3, 4]
    assert json.loads((tmp_path / "hardship.json").read_text())[0]["value"] == 2
    assert "1 of 2 missions to run" in capsys.readouterr().out


def test_bad_calls(capsys):
    assert command.main(["--trials", "0"]) == 2 and "--trials" in capsys.readouterr().err
    assert command.main(["--only", "storm"]) == 2
