"""Ctrl-C while a node is still being read, and while the team runner starts."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from mr_launch.team import NODES_PATIENCE
from mr_measures.record.files import read_record

TEAM = Path(__file__).resolve().parents[1] / "nodes" / "team"
PACKAGES = TEAM.parents[2]
PROGRAMS = {
    f"{path.parts[-3]}/{path.name}": path
    for folder in ("nodes", "scripts")
    for path in sorted(PACKAGES.glob(f"*/{folder}/*"))
    if path.is_file() and path.read_text().startswith("#!/usr/bin/env python3")
}
OF_PYTHON_ALONE = {"adhoc_communication/team_key"}  # imports nothing else
NODES = sorted(PROGRAMS.keys() - OF_PYTHON_ALONE)
# Read before any other: the first import that is not of Python's own takes its time, says so, and loses what comes.
LOSING = """
import sys, time


class Losing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {*sys.stdlib_module_names, "usercustomize"}:
            return
        print("importing", flush=True)
        try:
            time.sleep(30.0)
        except BaseException:
            sys.exit("lost")


sys.meta_path.insert(0, Losing())
"""
WIND_UP = {  # commands that end what they have begun when they are interrupted: where they are defined
    "mr_launch/doctor": "mr_launch.doctor.command main",
    "mr_launch/export": "mr_launch.recordings.export_command main",
    "mr_launch/replay": "mr_launch.recordings.replay_command main",
    "mr_launch/soak": "mr_launch.soak.command main",
    "mr_launch/team": "mr_launch.commands team",
    "mr_page/bench_page": "mr_page.bench main",
    **{
        name: re.search(r"from (\S+) import main as command", path.read_text()).expand(r"\1 main")
        for name, path in PROGRAMS.items()
        if name.startswith("mr_experiments/")
    },
}
PLAIN_ROUNDING = {"mr_experiments.common.plain_rounding": "def restart_with_plain_rounding():\n    pass\n"}


def run_node(node, folder):
    environment = {**os.environ, "PYTHONPATH": f"{folder}:{os.environ.get('PYTHONPATH', '')}"}
    command = [sys.executable, str(PROGRAMS[node])]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, env=environment, stdout=pipe, stderr=pipe, text=True)


@pytest.mark.parametrize("isolation", ["namespaces", "hub"])
def test_an_interrupt_before_the_mission_begins_waits_for_no_roslaunch_that_is_starting(tmp_path, isolation):
    """Which hears nothing, or waits 20 s for itself; the team waited 25 s for it."""
    if isolation == "namespaces" and os.geteuid() != 0:
        pytest.skip("needs root; the hub covers the rest")
    command = [sys.executable, str(Path(__file__).with_name("dummy_team.py")), str(tmp_path / "out"), isolation]
    path = os.pathsep.join([str(TEAM.parents[1] / "src"), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "PYTHONPATH": path, "DUMMY_DEAF": "robot_1"}
    log = tmp_path / "out" / "logs" / "robot_1.log"
    with subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as team:
        while team.poll() is None and not (log.exists() and "deaf" in log.read_text()):
            time.sleep(0.02)
        asked = time.monotonic()
        team.send_signal(signal.SIGINT)
        assert team.wait(timeout=60.0) == 130
    assert time.monotonic() - asked < NODES_PATIENCE / 2.0
    assert read_record(tmp_path / "out" / "record.json").outcome.reason == "interrupted"


@pytest.mark.parametrize("node", NODES)
def test_an_interrupt_during_the_imports_ends_a_node(node, tmp_path):
    """An import lost it, as this one does, and the team runner waited for half a minute; or it ended in a traceback."""
    (tmp_path / "sitecustomize.py").write_text(LOSING)
    with run_node(node, tmp_path) as process:
        assert process.stdout.readline() == "importing\n"
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=20.0)
    assert (process.returncode, errors) == (-signal.SIGINT, "")


@pytest.mark.parametrize("node", WIND_UP)
def test_an_interrupt_after_the_imports_lets_a_command_wind_up(node, tmp_path):
    module, function = WIND_UP[node].split()
    handler = "__import__('signal').getsignal(2).__name__"
    for name, text in {**PLAIN_ROUNDING, module: f"def {function}(*_):\n    print({handler})\n"}.items():
        place = tmp_path.joinpath(*name.split("."))
        place.parent.mkdir(parents=True, exist_ok=True)
        for folder in list(place.parents)[: name.count(".")]:
            (folder / "__init__.py").touch()
        place.with_suffix(".py").write_text(text)
    with run_node(node, tmp_path) as process:
        said, errors = process.communicate(timeout=20.0)
    assert (said, errors) == ("default_int_handler\n", "")
