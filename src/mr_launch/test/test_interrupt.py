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
# Read before any other: the first import beside the launcher that is not of Python's own takes its time, says so, and
# loses what comes.
LOSING = """
import sys, time

LAUNCHER = {"adhoc_communication", "adhoc_communication.program"}


class Losing:
    def find_spec(self, name, path=None, target=None):
        if name in LAUNCHER or name.partition(".")[0] in {*sys.stdlib_module_names, "usercustomize"}:
            return
        print("importing", flush=True)
        try:
            time.sleep(30.0)
        except BaseException:
            sys.exit("lost")


sys.meta_path.insert(0, Losing())
"""
CALLS = {name: re.search(r'run_(?:program|node)\(\s*"([\w.:]+)"', PROGRAMS[name].read_text())[1] for name in NODES}
WIND_UP = {  # what they have begun, when they are interrupted
    "mr_launch/doctor", "mr_launch/export", "mr_launch/replay", "mr_launch/soak", "mr_launch/team",
    "mr_page/bench_page",
    *(name for name in NODES if name.startswith(("adhoc_communication/", "map_merger/bench_", "mr_experiments/"))),
}  # fmt: skip
# Whatever a program calls says who takes Ctrl-C.
STUBS = """
import itertools, signal, sys
from importlib.util import spec_from_loader

MODULES = ("{0}", "mr_experiments.common.plain_rounding")
STUBBED = {{*itertools.chain(*(itertools.accumulate(name.split("."), "{{}}.{{}}".format) for name in MODULES))}}


class Stubs:
    def find_spec(self, name, path=None, target=None):
        if name in STUBBED - {{"adhoc_communication"}}:
            return spec_from_loader(name, self, is_package=True)

    def create_module(self, spec):
        return None

    def exec_module(self, module):
        module.restart_with_plain_rounding = lambda: None
        if module.__name__ == "{0}":
            module.{1} = lambda *_: print(getattr(signal.getsignal(2), "name", "default_int_handler"))


sys.meta_path.insert(0, Stubs())
"""


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


@pytest.mark.parametrize("node", NODES)
def test_an_interrupt_after_the_imports_lets_a_command_wind_up(node, tmp_path):
    """And ends any other program until it takes signals itself."""
    assert taker_of_interrupts(node, tmp_path) == ("default_int_handler" if node in WIND_UP else "SIG_DFL")


@pytest.mark.parametrize("node", ["mr_launch/team", "mr_launch/monitor"])
def test_an_interrupt_that_is_ignored_behind_an_ampersand_stays_so(node, tmp_path):
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        assert taker_of_interrupts(node, tmp_path) == "SIG_IGN"
    finally:
        signal.signal(signal.SIGINT, before)


def taker_of_interrupts(node, folder):
    """The handler of SIGINT that a program's own function finds."""
    module, _, function = CALLS[node].partition(":")
    (folder / "sitecustomize.py").write_text(STUBS.format(module, function or "main"))
    with run_node(node, folder) as process:
        said, errors = process.communicate(timeout=20.0)
    assert errors == ""
    return said.strip()
