"""The files of docs/examples work, and the tutorials show them as they are."""

import importlib.util
import os
import subprocess
import sys

import pytest
from pages import REPOSITORY

from mr_robot.platforms.files import parameters_of
from mr_robot.platforms.preset import load_platform
from mr_sim.world import World
from mr_sim.world_model import load_world

EXAMPLES = REPOSITORY / "docs" / "examples"


@pytest.mark.parametrize(
    "page, example, begin",
    [
        ("your_strategy.md", "spread_strategy.py", "@registered\n"),
        ("your_messages.md", "send_battery.py", "def request_of("),
    ],
)
def test_tutorials_show_the_examples_as_they_are(page, example, begin):
    text = (REPOSITORY / "docs" / "tutorials" / page).read_text(encoding="utf-8")
    block = begin + text.split("```python\n" + begin)[1].split("```")[0]
    assert block in (EXAMPLES / example).read_text(encoding="utf-8")


def test_a_world_of_ones_own_holds_two_robots_that_can_move():
    description = load_world(EXAMPLES / "my_flat.world")
    assert [robot.name for robot in description.robots] == ["robot_0", "robot_1"]
    World(description)  # refuses robots that start in a wall


def test_without_a_master_the_message_example_ends_with_one_line():
    example = [sys.executable, str(EXAMPLES / "send_battery.py"), "bob"]
    environment = {**os.environ, "ROS_MASTER_URI": "http://localhost:1"}
    found = subprocess.run(example, env=environment, capture_output=True, text=True, timeout=20.0, check=False)
    assert (found.returncode, found.stderr) == (
        1, "not delivered: no ROS master at http://localhost:1: start adhoc.launch\n",
    )  # fmt: skip


def test_a_preset_of_ones_own_gives_the_parameters_of_all_nodes():
    platform = load_platform(str(EXAMPLES / "my_robot.yaml"))
    parameters = parameters_of(platform, [platform])
    assert set(parameters) == {"slam", "move_base", "explorer", "map_merger", "velocity_override", "bag"}
    assert parameters["slam"]["scan_topic"] == "scan" and parameters["explorer"]["base_link"] == "base_link"


def test_a_message_of_any_type_travels_with_its_definition():
    messages = pytest.importorskip("sensor_msgs.msg")
    spec = importlib.util.spec_from_file_location("send_battery", EXAMPLES / "send_battery.py")
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    sent = messages.BatteryState(voltage=12.5)
    request = example.request_of("bob", "battery", sent)
    assert (request.dst_robot, request.topic, request.type) == ("bob", "battery", "sensor_msgs/BatteryState")
    assert request.md5sum == sent._md5sum and "float32 voltage" in request.definition
    assert messages.BatteryState().deserialize(bytes(request.data)).voltage == 12.5
