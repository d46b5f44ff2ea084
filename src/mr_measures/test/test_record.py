"""The mission record as a document: there and back, other versions, faults by their place."""

import json
from dataclasses import replace

import pytest
from hypothesis import given, settings
from sample_missions import mission, missions

from mr_grid import Pose
from mr_measures.record.files import RecordError, document_of, read_record, record_of_document, write_record
from mr_measures.record.mission_record import SCHEMA
from mr_measures.record.robot_record import Merge


@given(missions())
@settings(max_examples=150)
def test_a_record_that_is_written_is_read_as_it_was(record):
    text = json.dumps(document_of(record), allow_nan=False)
    assert record_of_document(json.loads(text)) == record


def test_a_file_is_whole_or_not_there(tmp_path):
    path = tmp_path / "mission.json"
    write_record(mission(), path)
    assert read_record(path) == mission() and list(tmp_path.iterdir()) == [path]


def test_keys_are_those_of_former_records():
    document = document_of(mission())
    assert document["format"] == SCHEMA == 2 and document["trial"]["seed"] == 1
    assert set(document) == {"format", "trial", "outcome", "team", "robots", "versions", "maps", "snapshots", "notes"}
    robot = document["robots"]["robot_0"]
    assert robot["start"] == [1.0, 2.0, 0.0] and robot["collisions"] == {"walls": 0, "robots": 0, "times": []}
    assert "merges" not in robot, "a host that does not see them says nothing"


def test_what_a_robot_gave_up_is_null_and_not_absent():
    (robot, *_) = mission().robots.values()
    entries = [Merge("b", 3.0, Pose(1.0, 0.0, 0.0), 0.1, 0.0, "right", True), Merge("b", 4.0, None)]
    document = document_of(mission(robots={"a": robot, "b": replace(robot, merges=tuple(entries))}))
    first, second = document["robots"]["b"]["merges"]
    judged = {"offset": 0.1, "turn": 0.0, "class": "right", "right": True}
    assert first == {"with": "b", "at": 3.0, "transform": [1.0, 0.0, 0.0], **judged}
    assert second == {"with": "b", "at": 4.0, "transform": None}


def test_unknown_keys_are_passed_over_and_null_reads_as_the_default():
    document = document_of(mission())
    document["robots"]["robot_0"].update(colour="red", collisions=None, map=None)
    assert record_of_document(document) == mission()


@pytest.mark.parametrize("document", [[], 5, {}, {"robots": {}}])
def test_other_documents_are_no_records(document):
    with pytest.raises(RecordError, match="no format number"):
        record_of_document(document)


@pytest.mark.parametrize("version", [3, 0, "1", None])
def test_another_version_is_one_clear_error(tmp_path, version):
    path = tmp_path / "mission.json"
    path.write_text(json.dumps({**document_of(mission()), "format": version}))
    with pytest.raises(RecordError) as caught:
        read_record(path)
    assert str(caught.value) == f"{path}: the record has format {version!r}; this version reads formats 1 and 2"


def test_the_version_before_is_read():
    assert record_of_document({**document_of(mission()), "format": 1}) == mission()


def test_packets_are_told_by_hops_and_partners_by_what_is_believed_last():
    (robot, *_) = mission().robots.values()
    place = Pose(1.0, 0.0, 0.0)
    merges = (Merge("b", 3.0, place), Merge("c", 3.5, place), Merge("b", 4.0, None))
    first = replace(robot, radio={"packets_received_by_hops": [5, 2]}, merges=merges)
    second = replace(robot, radio={"packets_received_by_hops": [1, 0, 4]})
    record = mission(robots={"a": first, "b": second})
    assert record.packets_by_hops == {1: 6, 2: 2, 3: 4} and mission().packets_by_hops == {}
    assert first.partners == ("c",) and second.partners == ()


MISSING = [
    ("trial",), ("outcome",), ("outcome", "status"), ("outcome", "time"), ("robots", "robot_1", "start"),
    ("robots", "robot_1", "distance"), ("robots", "robot_1", "moving"), ("trial", "world"),
]  # fmt: skip


@pytest.mark.parametrize("keys", MISSING, ids=".".join)
def test_a_missing_key_is_named(keys):
    document = document_of(mission())
    part = document
    for key in keys[:-1]:
        part = part[key]
    del part[keys[-1]]
    with pytest.raises(RecordError, match=f"^damaged record: {'.'.join(keys)} is missing"):
        record_of_document(document)


FAULTS = [
    (("outcome", "time"), "late", "outcome.time must be a finite number, not 'late'"),
    (("outcome", "time"), True, "outcome.time must be a finite number, not True"),
    (("outcome", "status"), "fine", "outcome.status is 'fine', not one of finished, unfinished, failed"),
    (("team", "exploration_time"), None, "outcome.status is finished, but team.exploration_time is None"),
    (("team", "series"), {"time": [0.0, 1.0], "coverage": [0.5]}, "team.series.time and coverage differ in length"),
    (("team", "series"), {"time": [2.0, 1.0]}, "team.series.time goes back"),
    (("team", "series"), {"time": [float("nan")]}, "team.series.time[0] must be a finite number, not nan"),
    (("team", "series"), {"time": 5}, "team.series.time must be a list, not 5"),
    (("trial", "robots"), 3, "robots: it has 2 robots, but the trial asked for 3"),
    (("trial", "robots"), 0, "trial.robots must be a whole number from 1 on"),
    (("robots", "robot_1"), 5, "robots.robot_1 must be an object, not 5"),
    (("robots", "robot_1", "start"), [1.0, 2.0], "robots.robot_1.start must be x, y, yaw"),
    (("robots", "robot_1", "radio"), {"bytes_sent": -1}, "robots.robot_1.radio.bytes_sent must be a whole number"),
    (("robots", "robot_1", "merges"), [{"with": "robot_0"}], "robots.robot_1.merges[0].at is missing"),
    (("robots", "robot_1", "merges"), [{"with": "a", "at": 1.0}], "robots.robot_1.merges[0].transform is missing"),
    (("robots", "robot_1", "goals"), [{"set": 1.0, "x": 2.0}], "robots.robot_1.goals[0].y is missing"),
    (("snapshots",), [{"time": 1.0, "robot": "a", "png": "", "resolution": 0.1, "origin": [0.0]}],
     "snapshots[0].origin must have 2 entries, not 1"),
    (("notes",), [{"at": 1.0, "warning": 1}], "notes[0].warning must be true or false, not 1"),
]  # fmt: skip


@pytest.mark.parametrize(("keys", "value", "message"), FAULTS)
def test_a_fault_is_named_by_its_place(keys, value, message):
    document = document_of(mission())
    part = document
    for key in keys[:-1]:
        part = part[key]
    part[keys[-1]] = value
    with pytest.raises(RecordError) as caught:
        record_of_document(document)
    assert message in str(caught.value)


@pytest.mark.parametrize("text", ["", "{", "\xff"])
def test_what_is_no_json_is_refused_by_name(tmp_path, text):
    (tmp_path / "other.json").write_text(text, encoding="latin-1")
    with pytest.raises(RecordError, match=r"other\.json cannot be read as JSON"):
        read_record(tmp_path / "other.json")


def test_a_record_that_is_not_there_is_no_fault_of_json(tmp_path):
    with pytest.raises(RecordError, match=r"none\.json is not there$"):
        read_record(tmp_path / "none.json")
    with pytest.raises(RecordError, match=r"cannot be read: Is a directory$"):
        read_record(tmp_path)
