"""Folders of records: what is read, how it is grouped, and what is refused."""

import json
from pathlib import Path

import pytest
from sample_records import failed_record, make_record, write_record

from mr_experiments.report.record_set import Chapter, Group, load_record, load_records
from mr_measures.record.files import RecordError


def test_values_of_a_record(tmp_path):
    record = make_record(2, 17, times=[90.0, 120.5], distances=[20.0, 31.5], errors=[-0.5, None], overlap=0.31)
    loaded = load_record(write_record(tmp_path, record))
    assert Group.of(loaded) == Group("small8x8", "paper", 7, 2)
    assert loaded.asked.seed == 17
    assert loaded.finished and not loaded.failed
    assert loaded.team.exploration_time == 120.5
    assert loaded.distance == pytest.approx(51.5)
    assert loaded.map_errors == (-0.5,)
    assert loaded.team.overlap == 0.31
    assert [robot.finished_at for robot in loaded.robots.values()] == [90.0, 120.5]
    assert loaded.robots["robot_1"].start == (1.0, 1.9, 0.5)
    assert loaded.final_coverage == pytest.approx(0.99)
    assert loaded.robots["robot_0"].sent("bytes_sent") == 200_000


def test_records_are_grouped_and_none_is_dropped(tmp_path):
    write_record(tmp_path, make_record(2, 2))
    write_record(tmp_path, make_record(2, 1))
    write_record(tmp_path, make_record(2, 3, times=[90.0, None], status="unfinished", reason="limit"))
    write_record(tmp_path, failed_record(2, 4, "explorer crashed"))
    write_record(tmp_path, make_record(1, 1))
    write_record(tmp_path, make_record(1, 1, strategy=3))
    records = load_records(tmp_path)
    sizes = {group: len(members) for group, members in records.groups.items()}
    assert sizes == {
        Group("small8x8", "paper", 3, 1): 1,
        Group("small8x8", "paper", 7, 1): 1,
        Group("small8x8", "paper", 7, 2): 4,
    }
    assert [record.asked.seed for record in records.groups[Group("small8x8", "paper", 7, 2)]] == [1, 2, 3, 4]
    assert records.counts == {"finished": 4, "unfinished": 1, "failed": 1}
    chapters = {chapter: list(teams) for chapter, teams in records.chapters.items()}
    assert chapters == {Chapter("small8x8", "paper", 3): [1], Chapter("small8x8", "paper", 7): [1, 2]}


def test_different_settings_in_a_group_are_told(tmp_path):
    write_record(tmp_path, make_record(1, 1))
    write_record(tmp_path, make_record(1, 2))
    assert load_records(tmp_path).mixed_settings() == []
    write_record(tmp_path, make_record(1, 3, limit=999.0))
    (sentence,) = load_records(tmp_path).mixed_settings()
    assert "limit" in sentence and "999.0" in sentence


def test_trials_of_different_odometry_are_not_put_together(tmp_path):
    """A record of the default does not name it, and so they passed for equal."""
    for seed, odometry in ((1, {}), (2, {}), (3, {"odometry": "random_walk"})):
        record = make_record(1, seed)
        record["trial"].update(odometry)
        write_record(tmp_path, record)
    groups = load_records(tmp_path).groups
    assert {group.odometry: len(records) for group, records in groups.items()} == {"bias": 2, "random_walk": 1}
    titles = [group.chapter.title for group in groups]
    assert [title.endswith("odometry random_walk") for title in titles] == [False, True]
    assert len({group.chapter.slug for group in groups}) == 2


def test_worlds_of_one_name_in_two_folders_have_figures_of_their_own():
    one, other = Chapter("a/map.yaml", "paper", 7), Chapter("b/map.yaml", "paper", 7)
    assert one.slug != other.slug and one.title != other.title


def test_one_world_named_in_two_ways_is_one_group(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("flat.world").write_text("model ( )")
    for seed, world in enumerate(("flat.world", "./flat.world", str(tmp_path.resolve() / "flat.world"))):
        record = make_record(1, seed)
        record["trial"]["world"] = world
        write_record(tmp_path, record)
    (group,) = load_records(tmp_path).groups
    assert group.chapter.title.startswith("flat, ") and group.chapter.slug.startswith("flat-")


def test_times_of_death_that_are_drawn_from_the_seed_are_no_difference(tmp_path):
    for seed in (1, 2):
        record = make_record(2, seed)
        record["trial"]["deaths"] = {"1": 30.0 + seed}
        write_record(tmp_path, record)
    assert load_records(tmp_path).mixed_settings() == []


def test_records_of_both_hosts_in_one_folder_are_refused(tmp_path):
    """Those of virtual time were left out without a word."""
    write_record(tmp_path, make_record(1, 1))
    (tmp_path / "team").mkdir()
    (tmp_path / "team" / "record.json").write_text(json.dumps(make_record(1, 2, scenario="ros_stack")))
    with pytest.raises(RecordError, match=r"holds records of trials, as small8x8.*and missions of the ROS stack"):
        load_records(tmp_path)


def test_no_records(tmp_path):
    with pytest.raises(RecordError, match="holds no records"):
        load_records(tmp_path)
    with pytest.raises(RecordError, match=r"nowhere is no folder"):
        load_records(tmp_path / "nowhere")


def test_the_same_trial_twice(tmp_path):
    write_record(tmp_path, make_record(1, 1))
    (tmp_path / "copy.json").write_text(json.dumps(make_record(1, 1)))
    with pytest.raises(RecordError, match=r"copy\.json.*same trial"):
        load_records(tmp_path)


@pytest.mark.parametrize(
    ("keys", "value", "message"),
    [
        (("format",), 3, "the record has format 3; this version reads formats 1 and 2"),
        (("trial", "world"), None, "trial.world is missing"),
        (("trial", "robots"), 0, "trial.robots must be a whole number"),
        (("trial", "robots"), 3, "has 2 robots, but the trial asked for 3"),
        (("outcome", "status"), "fine", "outcome.status is 'fine'"),
        (("outcome", "time"), "late", "outcome.time must be a finite number, not 'late'"),
        (("team", "exploration_time"), None, "team.exploration_time is None"),
        (("team", "series", "coverage"), [0.5], "differ in length"),
        (("robots", "robot_1", "start"), [1.0, 2.0], "robots.robot_1.start must be x, y, yaw"),
        (("robots", "robot_1", "distance"), None, "robots.robot_1.distance is missing"),
        (("robots", "robot_0", "map", "error"), float("nan"), "robots.robot_0.map.error must be a finite number"),
        (("robots", "robot_0", "merges"), [{"with": "robot_1"}], "robots.robot_0.merges"),
        (("robots", "robot_0", "radio", "bytes_sent"), -1, "robots.robot_0.radio.bytes_sent"),
    ],
)
def test_a_broken_record_is_named_with_its_fault(tmp_path, keys, value, message):
    record = make_record(2, 1)
    part = record
    for key in keys[:-1]:
        part = part[key]
    part[keys[-1]] = value
    path = write_record(tmp_path, make_record(2, 1))
    path.write_text(json.dumps(record))
    with pytest.raises(RecordError) as caught:
        load_records(tmp_path)
    assert path.name in str(caught.value)
    assert message in str(caught.value)
    assert str(caught.value).endswith("; take it out of the folder, which is to hold whole records and nothing else")


@pytest.mark.parametrize("text", ["", "{", "[1]", "{}", "\xff"])
def test_other_files_are_refused_by_name(tmp_path, text):
    (tmp_path / "other.json").write_text(text, encoding="latin-1")
    with pytest.raises(RecordError, match=r"other\.json"):
        load_records(tmp_path)
