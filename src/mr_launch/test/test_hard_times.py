"""A full disk and robots that are started again: the mission goes on, and says once what is lost."""

import contextlib
import os
import signal
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
    "sys.exit(guarded([sys.executable, '-c', sys.argv[1]], Path(sys.argv[2]), int(sys.argv[3]), len(sys.argv) > 4))"
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


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_where_nodes_are_started_again_an_end_for_the_disk_lasts(tmp_path, number):
    """roslaunch would start the recorder every two seconds, to find the disk full."""
    words = [sys.executable, "-c", GUARD, RECORDER, str(tmp_path), str(MORE_THAN_THERE_IS), "stays"]
    with subprocess.Popen(words, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as guard:
        assert guard.stderr.readline().startswith("record: ")
        with pytest.raises(subprocess.TimeoutExpired):
            guard.wait(timeout=2.0)
        guard.send_signal(number)
        assert guard.wait(timeout=20.0) == 0
    done = subprocess.run([*words[:3], "raise SystemExit(5)", str(tmp_path), "1", "stays"], timeout=60, check=False)
    assert done.returncode == 5, "one that died is for roslaunch"


def test_the_recorder_closes_its_bag_when_its_guard_is_killed(tmp_path):
    """It went on for ever, beside the one that was started again."""
    told = "import os; print(os.getpid(), flush=True)\n" + RECORDER.replace(
        "while", "print('ready', flush=True)\nwhile"
    )
    words = [sys.executable, "-c", GUARD, told, str(tmp_path), str(NOTHING)]
    with subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, text=True) as guard:
        recorder = int(guard.stdout.readline())
        assert guard.stdout.readline() == "ready\n"
        guard.kill()
        try:
            assert guard.stdout.read() == "" and (tmp_path / "closed").exists()
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.kill(recorder, signal.SIGKILL)


def test_a_recorder_that_died_is_news_and_no_failure(tmp_path):
    """It ended the whole mission, with --respawn, too."""
    log = tmp_path / "robot_0.log"
    log.write_text("[bag-8] process has died [pid 1, exit code -9, cmd x].\nlog file: /logs/bag-8*.log\n")
    for respawns in (False, True):
        watch = NodeWatch(log, respawns)
        assert watch.failures() == [] and watch.restarts == {}
        (news,) = watch.take_news()
        assert news == "the recorder died (exit code -9); the mission goes on unrecorded; log: /logs/bag-8*.log"
    log.write_text("ERROR: cannot launch node of type [mr_launch/record]: no such file\n")
    assert len(NodeWatch(log).failures()) == 1, "what cannot be started is not installed"


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
