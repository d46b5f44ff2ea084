"""The units that are shipped for a robot, checked by systemd itself."""

import os
import pathlib
import re
import shlex
import shutil
import stat
import subprocess
from typing import List

import pytest

UNITS = pathlib.Path(__file__).parents[1] / "systemd"
#: A robot has them; the computer of a test need not.
PROGRAMS = ["/sbin/ip", "/sbin/iw", "/usr/bin/nmcli"]


def verify(directory: pathlib.Path, unit: str) -> str:
    """What systemd has to say about a unit of that directory; programs are looked for below it."""
    program = shutil.which("systemd-analyze")
    if program is None:
        pytest.skip("systemd is not installed")
    environment = {**os.environ, "SYSTEMD_UNIT_PATH": f"{directory}:"}
    done = subprocess.run([program, "verify", "--man=no", unit], env=environment, capture_output=True, text=True)
    ours = (unit.split("@")[0], str(directory))
    return "".join(line for line in done.stderr.splitlines(True) if line.startswith(ours))


@pytest.fixture
def units(tmp_path: pathlib.Path) -> pathlib.Path:
    """The units, with programs that are there."""
    for program in PROGRAMS:
        stand_in = tmp_path / pathlib.Path(program).name
        stand_in.write_text("#!/bin/sh\n")
        stand_in.chmod(stand_in.stat().st_mode | stat.S_IXUSR)
    for unit in UNITS.glob("*.service"):
        text = unit.read_text()
        for program in PROGRAMS:
            text = text.replace(program, str(tmp_path / pathlib.Path(program).name))
        (tmp_path / unit.name).write_text(text)
    return tmp_path


@pytest.mark.parametrize("unit", ["adhoc-radio@wlan0.service", "mesh-radio@wlan0.service", "robot@wlan0.service"])
def test_systemd_takes_the_unit_without_a_word(units: pathlib.Path, unit: str) -> None:
    assert verify(units, unit) == ""


def test_a_mistake_would_be_told(units: pathlib.Path) -> None:
    robot = units / "robot@.service"
    robot.write_text(robot.read_text().replace("RestartSec=5", "RestartSeconds=5"))
    assert "RestartSeconds" in verify(units, "robot@wlan0.service")


def test_programs_stand_where_the_test_looks() -> None:
    text = "".join(unit.read_text() for unit in UNITS.glob("*.service"))
    assert all(program in text for program in PROGRAMS)


def started(folder: pathlib.Path, **given: str) -> List[str]:
    """The words with which the unit of a robot starts roslaunch."""
    stand_in = folder / "roslaunch"
    stand_in.write_text("#!/bin/sh\nprintf '%s\\n' \"$@\"\n")
    stand_in.chmod(0o755)
    workspace = folder / "setup.bash"
    workspace.write_text(f"export PATH={folder}:$PATH\n")
    text = (UNITS / "robot@.service").read_text().replace("%I", "wlan0").replace("%H", "anna")
    settings = re.search("^Environment=(.*)$", text, re.MULTILINE)
    command = re.search("^ExecStart=(.*)$", text, re.MULTILINE)
    assert settings and command
    environment = {
        **dict(word.split("=", 1) for word in shlex.split(settings[1])),
        "WORKSPACE": str(workspace),
        **given,
    }
    done = subprocess.run(shlex.split(command[1]), env=environment, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def test_a_robot_is_started_with_what_its_settings_say(tmp_path: pathlib.Path) -> None:
    """There was no place for the topics of a Pioneer's drivers."""
    usual = [
        "mr_launch", "robot.launch", "robot:=pioneer", "robot_name:=anna", "interface:=wlan0",
        "key_file:=/home/robot/team.key",
    ]  # fmt: skip
    assert started(tmp_path) == usual
    more = started(tmp_path, ARGUMENTS="scan_topic:=scan autostart:=false", NAME="bob")
    assert more == [*usual[:3], "robot_name:=bob", *usual[4:], "scan_topic:=scan", "autostart:=false"]


def test_a_robot_whose_master_has_died_is_started_again() -> None:
    """roslaunch ends with exit code 0 then, which is no failure to systemd: the robot stayed away."""
    assert re.search("^Restart=always$", (UNITS / "robot@.service").read_text(), re.MULTILINE)
