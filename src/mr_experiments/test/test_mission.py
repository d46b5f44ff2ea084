"""Whole missions in virtual time on the engines that robots run."""

import json
import os
import subprocess
import sys
from dataclasses import asdict, replace

import numpy as np
import pytest

from mr_experiments.host.mission import Mission
from mr_experiments.sweep.record import record_of, run_trial
from mr_experiments.trial.radio_options import RadioOptions
from mr_experiments.trial.trial import Trial, TrialError
from mr_sim.worlds import find_world

SHORT = Trial("small8x8", 2, 3, limit=20.0)


@pytest.fixture(scope="module")
def finished():
    return run_trial(Trial("small8x8", 2, 1, limit=300.0), snapshot_period=20.0)


def test_two_robots_explore_and_merge(finished):
    assert (finished.outcome.status, finished.outcome.reason) == ("finished", "")
    assert 15.0 < finished.team.exploration_time < 60.0
    assert finished.final_coverage > 0.995
    for robot in finished.robots.values():
        assert robot.map.coverage > 0.995
        assert abs(robot.map.error) < 0.6 and robot.map.wrong_walls < 0.005
        assert robot.merges and all(merge.right for merge in robot.merges)
        assert robot.sent("packets_sent") > 10 and robot.sent("packets_failed") == 0
        assert robot.counters["bids"] > 0
        assert 0.3 < robot.moving <= 1.0


def test_auctions_are_answered_after_they_were_opened_and_then_decided(finished):
    """Nobody's bid counts that has not come."""
    for name, robot in finished.robots.items():
        decided = [auction for auction in robot.auctions if auction.decided is not None]
        assert decided and any(auction.answered for auction in decided)
        for auction in decided:
            assert all(auction.at <= at <= auction.decided for at in auction.answered.values())
            bidders = {bidder for offer in auction.offers for bidder in offer.bids}
            assert bidders - {name} <= auction.answered.keys()


def test_series_are_of_one_length_and_in_order(finished):
    for robot in finished.robots.values():
        assert len(robot.series.time) > 20
        assert all(len(column) == len(robot.series.time) for column in asdict(robot.series).values())
        assert robot.series.distance[-1] >= robot.distance > 5.0  # the way home does not count
    maps = finished.maps["robot_0"]
    assert finished.snapshots and maps.merged is not None and maps.local is not None


def test_same_seed_same_record_in_another_process():
    """Bit for bit, whatever the order in which that process hashes strings."""
    code = (
        "import json; from mr_experiments.trial.trial import Trial;"
        "from mr_experiments.sweep.record import run_trial; from mr_measures.record.files import document_of;"
        f"record = document_of(run_trial(Trial('small8x8', 2, {SHORT.seed}, limit={SHORT.limit})));"
        "del record['measured']; print(json.dumps(record))"
    )
    records = [
        subprocess.run(
            [sys.executable, "-c", code], env={**os.environ, "PYTHONHASHSEED": seed}, check=True, capture_output=True
        ).stdout
        for seed in ("1", "2")
    ]
    assert records[0] == records[1]
    other = run_trial(Trial("small8x8", 2, SHORT.seed + 1, limit=SHORT.limit))
    assert other.team.trace != json.loads(records[0])["team"]["trace"]


def test_unfinished_mission_says_why():
    record = run_trial(SHORT)
    assert record.outcome.status == "unfinished"
    assert "limit of 20 s" in record.outcome.reason and "robot_1" in record.outcome.reason
    assert record.team.exploration_time is None


def test_crash_of_an_engine_is_a_failed_record_with_its_time(monkeypatch):
    mission = Mission(SHORT)

    def crash(now):
        raise ZeroDivisionError("made by the test")

    mission.agenda.at(5.0, crash)
    monkeypatch.setattr("mr_experiments.sweep.record.Mission", lambda *_: mission)
    record = run_trial(SHORT)
    assert record.outcome.status == "failed"
    assert "ZeroDivisionError: made by the test" in record.outcome.reason
    assert "crash" in record.outcome.traceback
    assert record.outcome.time == pytest.approx(5.0 - mission.begun_at, abs=0.1)


def test_time_never_goes_back_and_is_known_to_those_who_hear(monkeypatch):
    mission = Mission(Trial("small8x8", 3, 1, limit=15.0, radio=RadioOptions(loss=0.3)))
    late, times = [], [0.0]
    for robot in mission.robots:
        on_packet = robot.on_packet

        def hear(topic, message, now, on_packet=on_packet):
            late.append(mission.now - now)
            on_packet(topic, message, now)

        monkeypatch.setattr(robot, "on_packet", hear)
    mission.run(progress=lambda _: times.append(mission.now))
    assert len(late) > 50 and set(late) == {0.0}
    assert times == sorted(times)


def test_crashed_mission_can_be_replayed_to_its_last_moment():
    first, again = Mission(SHORT), Mission(SHORT)
    first.run(until=8.0)
    again.run(until=4.0)
    again.run(until=8.0)
    assert record_of(first, None).robots == record_of(again, None).robots


def test_robot_that_dies_does_not_hold_up_the_others():
    record = run_trial(Trial("small8x8", 2, 1, limit=300.0, deaths={1: 10.0}))
    assert record.outcome.status == "finished"
    assert record.robots["robot_1"].died_at == pytest.approx(10.0, abs=0.1)
    dead = record.robots["robot_1"]
    assert dead.finished_at is None and dead.moving > 0.9
    assert dead.sent("bytes_sent") == dead.series.bytes[-1] > 0
    assert list(dead.series.bytes) == sorted(dead.series.bytes)
    assert record.robots["robot_0"].map.coverage > 0.995


def test_robots_that_finish_before_they_would_die_do_not_spoil_the_record():
    alone = Trial("small8x8", 2, 1, limit=300.0, radio=RadioOptions(range=0.1), deaths={0: 250.0})
    record = run_trial(alone)
    assert record.outcome.status == "finished"
    finished = [robot.finished_at for robot in record.robots.values() if robot.finished_at is not None]
    assert record.team.exploration_time == max(finished)


def test_robot_that_joins_late_takes_part():
    record = run_trial(Trial("small8x8", 2, 1, limit=300.0, joins={1: 15.0}))
    assert record.outcome.status == "finished"
    late = record.robots["robot_1"]
    assert late.goals[0].set >= 15.0
    assert late.map.coverage > 0.995
    assert late.merges and all(merge.right for merge in late.merges)


def test_a_trial_without_a_partition_is_recorded_as_before_there_were_any():
    assert "partition" not in Trial("office26x15", 2, 1).to_json()
    assert Trial("office26x15", 2, 1, partition=(5.0, 9.0)).to_json()["partition"] == [5.0, 9.0]


def test_odometry_model_is_recorded_where_it_is_not_that_of_older_records():
    assert "odometry" not in Trial("office26x15", 2, 1).to_json()
    assert Trial("office26x15", 2, 1, odometry="random_walk").to_json()["odometry"] == "random_walk"


def test_odometry_model_reaches_the_world():
    trial = Trial("small8x8", 1, 1, limit=40.0, odometry="random_walk")
    mission = Mission(trial)
    assert mission.world.odometry == "random_walk"
    assert run_trial(trial).team.series != run_trial(replace(trial, odometry="bias")).team.series


def test_halves_of_a_team_do_not_hear_each_other_in_a_partition():
    """Frames are exchanged within the halves; after it all hear all again."""
    mission = Mission(Trial("office26x15", 3, 1, limit=300.0, partition=(3.0, 14.0)))
    heard = {}
    for until in (2.0, 13.0, 22.0):
        while mission.begun_at is None or mission.since_start < until:
            mission.run(until=mission.now + 1.0)
        heard[until] = [sorted(mission.radio.neighbors(robot.own_radio.index)) for robot in mission.robots]
    everybody = [["robot_1", "robot_2"], ["robot_0", "robot_2"], ["robot_0", "robot_1"]]
    assert heard == {2.0: everybody, 13.0: [["robot_1"], ["robot_0"], []], 22.0: everybody}


@pytest.mark.parametrize(
    "bad, text",
    [
        ({"partition": (5.0, 5.0)}, "partition lasts"),
        ({"odometry": "gauss"}, "odometry 'gauss' is unknown; there are bias, random_walk"),
        ({"partition": (5.0, 9.0), "fast": True}, "partition needs a radio"),
        ({"world": "nowhere"}, "nowhere"),
        ({"robots": 99}, "asked for 99"),
        ({"robots": 0}, "at least one robot"),
        ({"strategy": 12}, "strategy 12"),
        ({"limit": -1.0}, "limit"),
        ({"deaths": {5: 1.0}}, "no robot 5"),
    ],
)
def test_bad_trial_names_the_culprit(bad, text):
    with pytest.raises(TrialError, match=text):
        Mission(Trial(**{"world": "small8x8", "robots": 1, "seed": 1, **bad}))


def test_team_of_which_nobody_lives_does_not_count_as_finished():
    record = run_trial(Trial("small8x8", 1, 1, limit=60.0, deaths={0: 3.0}))
    assert record.outcome.status == "unfinished" and record.outcome.reason == "no robot lives to the end"
    assert record.team.exploration_time is None


@pytest.fixture
def plan_map(tmp_path, monkeypatch):
    """A map of map_server of two rooms of 4 m x 4 m with a door between, in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    pixels = np.full((90, 170), 205, dtype=np.uint8)
    pixels[2:88, 2:168] = 0
    pixels[4:86, 4:84] = pixels[4:86, 86:166] = pixels[35:55, 84:86] = 254
    (tmp_path / "plan.pgm").write_bytes(b"P5 170 90 255\n" + pixels.tobytes())
    (tmp_path / "plan.yaml").write_text("image: plan.pgm\nresolution: 0.05\norigin: [-4, -2, 0]\n")
    return "plan.yaml"


def test_a_map_of_map_server_is_explored(plan_map):
    starts = ((-3.0, 0.0, 0.0), (-2.0, 0.0, 0.0))
    record = run_trial(Trial(plan_map, 2, 1, limit=200.0, starts=starts))
    assert record.outcome.status == "finished"
    assert record.asked.settings["world"] == "plan.yaml" and record.asked.settings["starts"][0] == [-3.0, 0.0, 0.0]
    assert min(robot.map.coverage for robot in record.robots.values()) > 0.995


def test_missions_use_the_laser_among_the_rangers(tmp_path):
    """Sonars before the laser in the world file, as Stage's Pioneers have them."""
    ring = "ranger ( sensor ( pose [ 0 0 0 90 ] range [ 0 5 ] ) sensor ( pose [ 0 0 0 -90 ] range [ 0 5 ] ) )"
    laser = "ranger ( sensor ( range [ 0 8 ] fov 270 samples 541 ) )"
    (tmp_path / "w.world").write_text(
        "resolution 0.02 interval_sim 50 model ( size [ 6 6 1 ] noblocks 1 boundary 1 )\n"
        f'position ( name "r0" size [ 0.44 0.38 1 ] update_interval 50 localization "odom" {ring} {laser} )\n'
    )
    mission = Mission(Trial(str(tmp_path / "w.world"), 1, 1, limit=60.0))
    mission.run()
    assert mission.finished
    assert record_of(mission, None).robots["r0"].map.coverage > 0.995


@pytest.mark.parametrize("odometry", ["bias", "random_walk"])
def test_a_team_of_omni_drives_explores(tmp_path, odometry):
    """Their odometry errs aside, too."""
    folder = find_world("small8x8").parent
    pioneer = (folder / "pioneer.inc").read_text()
    assert 'drive "diff"' in pioneer and "odom_error [ 0.03 0.03 0.0 0.05 ]" in pioneer
    pioneer = pioneer.replace('drive "diff"', 'drive "omni"').replace("-0.5 0.5 0 0 0 0", "-0.5 0.5 -0.5 0.5 0 0")
    (tmp_path / "pioneer.inc").write_text(pioneer)
    (tmp_path / "w.world").write_text((folder / "small8x8.world").read_text())
    record = run_trial(Trial(str(tmp_path / "w.world"), 2, 1, limit=300.0, odometry=odometry))
    assert (record.outcome.status, record.outcome.reason) == ("finished", "")
    for robot in record.robots.values():
        assert robot.map.coverage > 0.995 and robot.map.wrong_walls < 0.005
        assert all(merge.right for merge in robot.merges)
