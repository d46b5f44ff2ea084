"""A full disk and robots that are started again: the mission goes on, and says once what is lost."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from mr_launch.mission_clock import SILENCE, MissionClock
from mr_launch.nodes import NodeWatch
from mr_measures.record.files import read_record

HERE = Path(__file__).resolve().parent
GUARD = (
    "import sys; from pathlib import Path; from mr_launch.disk_guard import guarded\n"
    "sys.exit(guarded([sys.executable, '-c', sys.argv[1]], Path(sys.argv[2]), int(sys.argv[3])))"
)
RECORDER = (  # writes until it is interrupted, then closes its bag
    "import pathlib, signal, sys, time\n"
    "signal.signal(signal.SIGINT, lambda *_: (pathlib.Path('closed').touch(), sys.exit(0)))\n"
    "while True: time.sleep(0.01)"
)
MORE_THAN_THERE_IS, NOTHING = 10**18, 1  # octets


def run_guarded(program, folder, least):
    words = [sys.executable, "-c", GUARD, program, str(folder), str(least)]
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=60, check=False)


def test_the_recording_ends_in_order_before_the_disk_is_full(tmp_path):
    done = run_guarded(RECORDER, tmp_path, MORE_THAN_THERE_IS)
    assert done.returncode == 0 and (tmp_path / "closed").exists()
    (line,) = done.stderr.splitlines()
    assert line.startswith("record: less than 1000000000000 MB are free in") and "the mission goes on" in line


def test_a_recorder_that_the_full_disk_ended_is_no_failure(tmp_path):
    done = run_guarded("raise SystemExit(5)", tmp_path, MORE_THAN_THERE_IS)
    assert done.returncode == 0 and done.stderr.startswith("record: ")


def test_a_folder_that_is_not_there_is_no_full_disk(tmp_path):
    words = [sys.executable, "-c", GUARD, "raise SystemExit(5)", str(tmp_path / "none"), "1"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0 and done.stderr.startswith(f"record: there is no folder {tmp_path / 'none'}; ")


def test_a_recorder_with_room_ends_as_it_ends(tmp_path):
    done = run_guarded("raise SystemExit(5)", tmp_path, NOTHING)
    assert (done.returncode, done.stderr) == (5, "")


def test_the_runner_reads_what_is_said_of_the_recording_and_of_this_start_only(tmp_path):
    log = tmp_path / "robot_0.log"
    log.write_text("[explorer-4] process has died [pid 1, exit code 1, cmd x].\n")
    watch = NodeWatch(log, begin=log.stat().st_size)
    assert watch.failures() == [] and watch.take_news() == []
    with log.open("a") as file:
        file.write("record: less than 200 MB are free\n[bag-8] process has finished cleanly\n")
    assert watch.failures() == [] and watch.take_news() == ["less than 200 MB are free"]
    assert watch.take_news() == [], "each once, whatever other robots say in between"


def test_time_goes_on_by_the_robots_clocks_when_the_trace_has_ended():
    clock = MissionClock()
    clock.update(10.0, [10.1, 10.2, 99.0], 0.0)
    assert clock.time == 10.0
    clock.update(11.0, [11.1, 11.2, 99.0], 1.0)
    clock.update(11.0, [14.0, 14.1, 99.0], 1.0 + SILENCE)
    assert clock.time == 11.0
    clock.update(11.0, [17.0, 17.1, 99.0], 1.5 + SILENCE)
    assert clock.time == 17.1, "one clock that has jumped does not count"
    clock.update(12.0, [17.5, 17.6, 99.0], 2.0 + SILENCE)
    assert clock.time == 17.1, "it never goes back"


@pytest.mark.parametrize("isolation", ["namespaces", "hub"])
def test_a_robot_whose_roslaunch_ended_is_started_again_and_explores(tmp_path, isolation):
    if isolation == "namespaces" and os.geteuid() != 0:
        pytest.skip("needs root; the hub covers the rest")
    path = os.pathsep.join([str(HERE.parent / "src"), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, str(HERE / "dummy_team.py"), str(tmp_path / "out"), isolation],
        env={**os.environ, "PYTHONPATH": path, "DUMMY_ENDS": "robot_1"},
        capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    record = read_record(tmp_path / "out" / "record.json")
    assert record.restarts == {"robot_1": {"roslaunch": 1}}
    assert record.robots["robot_1"].state == "finished"
