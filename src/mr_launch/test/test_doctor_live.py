"""The doctor on a real computer and a real master with real radio nodes: silent while all is well, and then it names
what was broken. Several things are broken at once, because each run has to listen for a while; `bench_doctor` breaks
them one by one."""

import os
import subprocess

import bench_doctor
import pytest
from broken_set_ups import (
    COMPUTERS,
    DOCTOR,
    RADIO_NODE,
    RIGHTS,
    ROBOTS,
    TWO_OF_ONE_NAME,
    LiveRobot,
    examine,
    lines_of,
    own_namespaces,
    told_of,
)
from live_master import LiveMaster


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    found = LiveRobot(tmp_path_factory.mktemp("live"))
    yield found
    found.close()


@pytest.fixture
def live(robot):
    """Each test leaves it as it found it."""
    yield robot
    robot.mend()


def assert_findings(doctor, *beginnings):
    """Each line begins so, and there is no other one but that the computer is busy."""
    lines = lines_of(doctor)
    assert doctor.returncode == (1 if beginnings else 0), doctor.stdout + doctor.stderr
    assert len(lines) == len(beginnings), doctor.stdout
    for line, beginning in zip(lines, beginnings):
        assert line.startswith(beginning), doctor.stdout


def assert_named(live, *faults):
    """In this order."""
    for fault in faults:
        fault.make(live)
    words = [word for fault in faults for word in fault.words]
    assert_findings(live.run(*DOCTOR, *words), *told_of(live, faults))


def test_a_robot_whose_drivers_parameters_and_key_are_broken(live):
    assert_findings(live.run(*DOCTOR))
    assert_named(
        live,
        ROBOTS["a key that others can read"],
        ROBOTS["a parameter out of range"],
        ROBOTS["drivers with old stamps"],
        ROBOTS["a transform that two nodes publish"],
        ROBOTS["a robot that is not there"],
    )


def test_a_laser_without_a_place_a_node_that_has_ended_and_another_teams_key(live):
    assert_named(
        live,
        ROBOTS["two names and a node that has ended"],
        ROBOTS["a laser without a place"],
        ROBOTS["a robot with another team's key"],
    )


def test_no_radio_no_scans_and_slow_odometry(live):
    assert_named(live, ROBOTS["no radio"], ROBOTS["no scans"], ROBOTS["slow odometry"])


def test_simulated_time_that_nobody_uses_and_two_robots_of_one_name(live):
    assert_named(live, ROBOTS["simulated time that nobody uses"], *([TWO_OF_ONE_NAME] if os.geteuid() == 0 else []))


def test_a_node_that_began_before_time_was_simulated(live):
    """Once nothing was said of it: what it published had stamps that nobody else had, and what it waited for lasted."""
    assert_named(live, ROBOTS["a node that began before time was simulated"])


def test_a_node_that_began_when_time_was_simulated(live):
    """Once nothing was said of it, and it hung for ever."""
    assert_named(live, ROBOTS["a node that began when time was simulated"])


def test_a_master_that_has_ended(tmp_path):
    master = LiveMaster(tmp_path)
    master.close()
    assert_findings(master.run(*DOCTOR), "no ROS master answers at http://localhost:")


@pytest.fixture
def namespaces():
    made = subprocess.run([*own_namespaces(), "true"], capture_output=True, text=True, check=False)
    if made.returncode:
        required = os.environ.get("CI") or os.environ.get("REQUIRE_RAW_SOCKETS")
        (pytest.fail if required else pytest.skip)(f"needs root or user namespaces: {made.stderr.strip()}")


@pytest.mark.usefixtures("namespaces")
@pytest.mark.parametrize(
    "names", [("an interface that is down", "a broken key", "a full disk"), ("an interface for short frames",)]
)
def test_an_interface_a_key_and_a_disk_that_cannot_be_used(tmp_path, names):
    done, told = examine(tmp_path, [COMPUTERS[name] for name in names])
    assert_findings(done, *told)


def test_a_wrong_address_no_such_interface_no_rights_and_the_key_of_another_user(tmp_path):
    names = ("an address that is another computer's", "an interface that is not there", "a key of another user")
    done, told = examine(tmp_path, [COMPUTERS[name] for name in names])
    allowed = "security.capability" in os.listxattr(RADIO_NODE)  # as on a robot that was set up
    assert_findings(done, *told[:2], *([] if allowed else [RIGHTS]), *told[2:])


def test_a_radio_node_without_its_right(tmp_path):
    """After each build that was not made as root; once only tried with made-up values."""
    done, told = examine(tmp_path, [COMPUTERS["a radio node without its right"]])
    assert_findings(done, *told)


def test_rows_of_the_benchmark_count_what_was_named_and_what_was_not_broken():
    named = bench_doctor.Examined("a key that others can read", ("key file",), ("key file /k can be read",))
    wordy = bench_doctor.Examined("no scans", ("/scan is silent",), ("/scan is silent, though", "bob is not there"))
    silent = bench_doctor.Examined("no radio", ("no radio",), ())
    well, ill = bench_doctor.Examined("", (), ()), bench_doctor.Examined("", (), ("the disk is full",))
    good = bench_doctor.rows_of([named], [well])
    assert [(row["value"], row["holds"]) for row in good] == [(1, True), (0, True), (0, True)]
    bad = bench_doctor.rows_of([named, wordy, silent], [well, ill])
    assert [(row["bar"], row["value"], row["holds"]) for row in bad] == [
        (">= 3", 2, False), ("<= 0", 1, False), ("<= 0", 1, False),
    ]  # fmt: skip
    assert "no radio: nothing" in bad[0]["detail"] and "bob is not there" in bad[1]["detail"]
