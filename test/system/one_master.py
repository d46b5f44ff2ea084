"""Runs `simulation_2.launch` in the small world and prints as JSON what became of it; started by
test_one_master.py in a network namespace of its own."""

import json
import os
import subprocess
import sys
import time
from typing import Any, Dict

import rosgraph
import rospy
from explorer.msg import ExplorationStatus
from map_merger.msg import MergerStatus

FINISHED = 4
PATIENCE = 120.0  # s
ROBOTS = ("robot_0", "robot_1")


def main() -> int:
    command = ["roslaunch", "mr_launch", "simulation_2.launch", "world:=small8x8", "rtf:=2.0"]
    found: Dict[str, Dict[str, Any]] = {name: {"state": 0} for name in ROBOTS}
    with open(os.path.join(os.environ["ROS_HOME"], "roslaunch.log"), "wb") as log:
        launch = subprocess.Popen(command, stdout=log, stderr=log)
    try:
        end = time.monotonic() + PATIENCE
        while not rosgraph.is_master_online() and time.monotonic() < end:
            time.sleep(0.2)
        rospy.init_node("observer", disable_signals=True, disable_rostime=True)
        for name in ROBOTS:
            rospy.Subscriber(f"/{name}/explorer/status", ExplorationStatus, take_status, callback_args=found[name])
            rospy.Subscriber(f"/{name}/map_merger/status", MergerStatus, take_merging, callback_args=found[name])
        while time.monotonic() < end and any(robot["state"] != FINISHED for robot in found.values()):
            time.sleep(0.2)
    finally:
        launch.terminate()
        launch.wait(30)
    print(json.dumps(found))
    return 0


def take_status(message: ExplorationStatus, robot: Dict[str, Any]) -> None:
    robot.update(state=message.state, text=message.text, area=message.area_known, frame=message.header.frame_id)


def take_merging(message: MergerStatus, robot: Dict[str, Any]) -> None:
    robot.update(placed=[other.robot for other in message.robots if other.placed])


if __name__ == "__main__":
    sys.exit(main())
