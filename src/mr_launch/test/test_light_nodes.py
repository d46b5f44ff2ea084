"""What the nodes of a robot load when they start: a robot's computer is small, and each has its own copy of it."""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

NODES = {
    "explorer": "import explorer.ros_node",
    "map_merger": "import map_merger.ros_node",
    "move_base": "import mr_robot.navigation.node",
    "slam": "import mr_robot.slam.node",
}
PACKAGES = Path(__file__).resolve().parents[2]
HELPED = [path for path in sorted(PACKAGES.glob("*/nodes/*")) if "run_node" in path.read_text()]
FOREIGN = {"cv2", "matplotlib", "mr_measures", "mr_plans"}
RUNNER = ("mr_launch.commands", "mr_launch.outside", "mr_launch.inside", "mr_sim.world_process")
SLOW = {"cv2", "matplotlib", "scipy", "tornado"}


@pytest.mark.parametrize("node", NODES)
def test_node_loads_only_what_it_needs(node):
    foreign = FOREIGN | ({"mr_robot._slam"} if node != "slam" else set())
    assert loaded_of(foreign, NODES[node]) == "[]"


@pytest.mark.parametrize("program", HELPED, ids=lambda path: path.name)
def test_a_node_explains_itself_without_a_master(program):
    """It waited for one, for ever."""
    environment = {**os.environ, "ROS_MASTER_URI": "http://localhost:1"}
    command = [sys.executable, str(program), "--help"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    package = program.parts[-3]
    assert done.stdout.startswith(f"usage: rosrun {package} {program.name} [_PARAMETER:=VALUE ...]")
    assert "\nStarted by: " in done.stdout and "\nParameters: " in done.stdout


@pytest.mark.parametrize("program", HELPED, ids=lambda path: path.name)
def test_a_node_that_finds_no_master_says_so_and_can_be_ended(program):
    """rosbag's recorder ended with a traceback."""
    environment = {**os.environ, "ROS_MASTER_URI": "http://localhost:1"}
    with subprocess.Popen([sys.executable, str(program)], env=environment, stderr=subprocess.PIPE, text=True) as node:
        first = node.stderr.readline()
        node.terminate()
        rest = node.communicate(timeout=60)[1]
    assert ": waits for a ROS master, none answers at http://localhost:1: " in first
    assert (node.returncode, rest) == (-signal.SIGTERM, "")


def test_every_node_is_among_them():
    modules = [path for package in PACKAGES.iterdir() for path in (package / "src" / package.name).rglob("*.py")]
    nodes = {path for path in modules if re.search(r"^ +init_node\(", path.read_text(), re.MULTILINE)}
    named = {".".join(path.with_suffix("").parts[path.parts.index("src", len(PACKAGES.parts)) + 1 :]) for path in nodes}
    explained = {re.search(r'run_node\("([\w.]+)"', path.read_text())[1] for path in HELPED}
    assert named - explained == {"mr_sim.stageros"}, "which has options, and so a help of its own"


@pytest.mark.parametrize("module", RUNNER)
def test_the_team_runner_begins_without_what_is_slow_to_import(module):
    """Half of its start went into pictures and a page that nobody had asked for."""
    assert loaded_of(SLOW, f"import {module}") == "[]"


def test_arguments_of_launch_files_are_looked_at_without_what_is_slow_to_import():
    """A third of it was SciPy, for each robot that was started."""
    assert loaded_of(SLOW, "import mr_launch.argument_checks") == "[]"


def test_a_mission_in_virtual_time_begins_without_the_statistics_of_benchmarks():
    """A tenth of its start: many programs and tests start one."""
    assert loaded_of({"matplotlib", "scipy.stats"}, "import mr_experiments.host.mission") == "[]"


def loaded_of(modules, script):
    """Those of them that are there after the script."""
    script = f"{script}\nimport sys; print(sorted({modules!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120, check=True)
    return done.stdout.splitlines()[-1]
